"""Rendering profiles: named sets of quality settings, which are recorded with every result and dataset."""

from __future__ import annotations

from dataclasses import dataclass

from sim.core.errors import ConfigError

_RANGES: dict[str, tuple[int, int]] = {
    "samples": (0, 64), "slices": (3, 256), "stacks": (2, 256), "quads": (1, 64), "occlusion": (0, 1),
    "shadows": (0, 1), "taps": (1, 256),
}  # fmt: skip
"""Smallest and largest value of each setting."""


@dataclass(frozen=True, kw_only=True)
class RenderProfile:
    """Quality settings of the offscreen renderer. Segmentation and depth depend only on `slices` and `stacks`."""

    name: str
    reflections: bool
    skybox: bool
    samples: int
    """Samples per pixel of the colour pass; 0 is off."""
    slices: int
    """Tessellation of round geoms about their axis (`quality/numslices`)."""
    stacks: int
    """Tessellation of round geoms along their axis (`quality/numstacks`)."""
    quads: int
    """Squares along each edge of a box's face in the colour pass; light is computed at their corners."""
    occlusion: float = 1.0
    """Strength of ambient occlusion, which darkens corners and the places under and behind furniture; 0 is off."""
    shadows: float = 0.0
    """Strength of the soft shadows of the nearest lamp, 0 (off) to 1."""
    taps: int = 6
    """Samples of each point for occlusion, and for shadows (`sim.renderer.shading`)."""

    def __post_init__(self) -> None:
        for name, (low, high) in _RANGES.items():
            if not low <= getattr(self, name) <= high:  # NaN is not
                raise ConfigError(f"RenderProfile.{name} must be in [{low}, {high}], got {getattr(self, name)}.")


PROFILES: dict[str, RenderProfile] = {
    profile.name: profile
    for profile in (
        RenderProfile(
            name="fast", reflections=False, skybox=False, samples=0, slices=12, stacks=8, quads=2, shadows=0.9, taps=6
        ),
        RenderProfile(
            name="good", reflections=True, skybox=True, samples=4, slices=20, stacks=10, quads=3, shadows=0.9, taps=24
        ),
    )
}
"""`fast` is for agents, `good` for pictures and training data."""


def get_profile(name: str) -> RenderProfile:
    """Returns the profile of a name.

    Raises:
        ConfigError: an unknown name.
    """
    if name not in PROFILES:
        raise ConfigError(f"Unknown rendering profile '{name}'. The profiles are: {', '.join(PROFILES)}.")
    return PROFILES[name]
