"""Finds segmentations by name: `gt`, `noisy`, `rednet`, servers by address, and users' own as `package.module:NAME`.

`rednet` imports PyTorch only on use: a process without a network stays small and starts fast.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from safetensors import SafetensorError, safe_open

from sim.app.composition.own_segmentation import load_specification, make_own
from sim.app.services.client import is_address
from sim.app.services.remote import HttpConfig, HttpSegmenter
from sim.core.configuration import as_json
from sim.core.errors import AgentError, ConfigError, did_you_mean
from sim.core.interface import CameraModel, Observation, Scores, SegmentationSpec, Segmenter, SegmenterSpec
from sim.core.invocation import command
from sim.core.reading import open_plain, reason_of, sha256_of
from sim.detectors.noisy import NoisyConfig, NoisySegmenter
from stubborn.segmentation.ground_truth import GroundTruthSegmenter
from stubborn.segmentation.processor import computes_bf16
from stubborn.segmentation.shipped import SHIPPED_REDNET

if TYPE_CHECKING:
    from sim.env.objectnav import ObjectNavEnv


@dataclass(frozen=True, kw_only=True)
class NetworkConfig:
    """Selects the weights of the network that segments, and how it runs."""

    weights: Path = SHIPPED_REDNET
    """File of the weights (safetensors)."""
    threads: int = 1
    """Threads of PyTorch in each process. The last digits of the scores depend on it, and so may the results."""
    temperature: float | None = None
    """Softmax temperature in place of the calibration stored with the weights."""
    mirrored: bool = False
    """Average the logits of the image and of its mirror image, computed in bf16 where the processor has instructions
    for it. `detector_config` sets it there: both together take less time than one image in fp32."""


@dataclass(frozen=True, kw_only=True)
class SegmentationKind:
    """One choice of `--semantics`."""

    description: str
    spec: SegmenterSpec
    config: object
    """Default configuration; None: there is nothing to configure."""
    make: Callable[[ObjectNavEnv, Any], Segmenter]
    """Builds the segmenter for an environment that provides the images which `spec` names."""
    own: SegmentationSpec | None = None
    """The user's specification; None: the kind ships with the package."""


class TrueSegmentation:
    """Ground-truth segmentation read from the environment, so that no true image is in the agent's observation."""

    spec = SegmenterSpec(sensors=(), truth=("semantic",), exact_outlines=True, needs_verification=False)

    def __init__(self, env: ObjectNavEnv) -> None:
        self._env = env
        self._scores_of = GroundTruthSegmenter()
        self._names_of: object = None
        self._names: tuple[str, ...] = ()

    def scores(self, observation: Observation, goal: str) -> Scores:
        """Returns scores 1 and 0, float32 (h, w), of the frame that the environment rendered last."""
        return self._scores_of.scores({"semantic": self._env.truth_images["semantic"]}, goal)

    def posteriors(self, observation: Observation) -> NDArray[np.float32]:
        """Returns posteriors 1 and 0, float32 (40, h / 4, w / 4), of the frame that the environment rendered last."""
        return self._scores_of.posteriors({"semantic": self._env.truth_images["semantic"]})

    def categories(self, observation: Observation) -> NDArray[np.uint8]:
        """Returns the true category of each pixel, uint8 (h, w)."""
        del observation
        return self._env.truth_images["semantic"]

    def picture_categories(self) -> NDArray[np.uint8] | None:
        """Returns the true category of each pixel of the goal's picture, uint8 (h, w); None: the goal is no picture."""
        return self._env.picture_categories()

    def objects(self, observation: Observation) -> tuple[NDArray[np.int32], Sequence[str]] | None:
        """Returns the true object of each pixel, int32 (h, w), and the everyday name of each object.

        None: the task renders no objects, because the goal is a category.
        """
        del observation
        world, geoms = self._env.scene.world, self._env.truth_images.get("geom")
        if geoms is None:
            return None
        if self._names_of is not world:
            self._names_of, meaning = world, self._env.scene.task.truth.meaning
            self._names = tuple(item.name for item in meaning.objects)
        return np.append(world.labels.geom_instance, np.int32(-1))[geoms], self._names


class NoSegmentation:
    """The segmenter of agents that declare `uses_segmentation=False`."""

    spec = SegmenterSpec(sensors=())

    def scores(self, observation: Observation, goal: str) -> Scores:
        """Raises ConfigError: the agent asked for scores although it declared that it does not use them."""
        raise ConfigError("This agent reads scores but declares uses_segmentation=False in its AgentSpec.")

    def posteriors(self, observation: Observation) -> NDArray[np.float32]:
        """Raises ConfigError, as `scores` does."""
        raise ConfigError("This agent reads posteriors but declares uses_segmentation=False in its AgentSpec.")


def _make_true(env: ObjectNavEnv, config: None) -> Segmenter:
    del config
    return TrueSegmentation(env)


def _make_noisy(env: ObjectNavEnv, config: NoisyConfig) -> Segmenter:
    camera = env.camera_model
    if camera.width_px % config.stride_px or camera.height_px % config.stride_px:
        size = f"{camera.width_px} x {camera.height_px}"
        raise ConfigError(f"detector.stride_px={config.stride_px} must divide the {size} pixels of the camera.")
    return NoisySegmenter(env, config)


def _make_network(env: ObjectNavEnv, config: NetworkConfig) -> Segmenter:
    from stubborn.segmentation.network import NetworkSegmenter

    camera = env.camera_model
    segmenter = NetworkSegmenter.from_file(
        weights_file(config.weights),
        camera=camera,
        threads=config.threads,
        temperature=config.temperature,
        mirrored=config.mirrored,
    )
    require_size(segmenter, camera)
    return segmenter


def _make_remote(env: ObjectNavEnv, config: HttpConfig) -> Segmenter:
    """Returns the segmenter of a server, which is asked for one black image first, so that a run fails at its start."""
    segmenter, camera = HttpSegmenter(env.camera_model, config), env.camera_model
    try:
        segmenter.posteriors(black_images(camera))
    except AgentError as error:
        raise ConfigError(str(error)) from None
    return segmenter


def require_size(segmenter: Segmenter, camera: CameraModel) -> None:
    """Raises ConfigError if a network cannot process the images of a camera; it is tried on one black image."""
    height, width = camera.height_px, camera.width_px
    try:
        segmenter.posteriors(black_images(camera))
    except (ConfigError, RuntimeError, ValueError, IndexError) as error:
        raise ConfigError(
            f"The network cannot take the camera's images, {width} pixels wide and {height} high "
            f"(camera.width_px, camera.height_px): {reason_of(error)}."
        ) from None


def black_images(camera: CameraModel) -> Observation:
    """Returns black images of a camera."""
    height, width = camera.height_px, camera.width_px
    return {"rgb": np.zeros((height, width, 3), np.uint8), "depth": np.zeros((height, width), np.float32)}


KINDS: Mapping[str, SegmentationKind] = MappingProxyType(
    {
        "gt": SegmentationKind(
            description="ground truth",
            spec=TrueSegmentation.spec,
            config=None,
            make=_make_true,
        ),
        "noisy": SegmentationKind(
            description="ground truth with the errors of a segmentation network",
            spec=NoisySegmenter.spec,
            config=NoisyConfig(),
            make=_make_noisy,
        ),
        "rednet": SegmentationKind(
            description="the shipped RedNet, or your own with --weights",
            spec=SegmenterSpec(sensors=("rgb",)),
            config=NetworkConfig(),
            make=_make_network,
        ),
    }
)
"""The kinds of segmentation by the name that `--semantics` takes."""


def find_segmentation(semantics: str, weights: Path | None) -> SegmentationKind:
    """Returns a kind of segmentation.

    Args:
        semantics: one of `KINDS`, the address of a server, or `package.module:NAME`, where NAME is a
            `SegmentationSpec` or a factory.
        weights: the user's weights, whose file must exist; None: those that ship, where the kind needs some.

    Raises:
        ConfigError: there is no such kind, or no weights for it.
    """
    if semantics in KINDS:
        kind = KINDS[semantics]
    elif is_address(semantics):
        kind = SegmentationKind(
            description=f"the server of detectors at {semantics}",
            spec=HttpSegmenter.spec,
            config=HttpConfig(url=semantics),
            make=_make_remote,
        )
    elif all(semantics.partition(":")):
        own = load_specification(semantics)
        make = functools.partial(make_own, semantics, own)
        kind = SegmentationKind(
            description=own.description or semantics, spec=own.spec, config=own.config, make=make, own=own
        )
    else:
        known = ", ".join(f"{name} ({kind.description})" for name, kind in KINDS.items())
        raise ConfigError(
            f"Unknown --semantics '{semantics}'.{did_you_mean(semantics, KINDS)}"
            f" Available: {known}, the address of a server (http://HOST:PORT), or your own as package.module:NAME."
        )
    if weights is not None and not isinstance(kind.config, NetworkConfig):
        fields = "; options of your own are --config detector.FIELD=VALUE" if kind.own else ""
        raise ConfigError(f"--weights go with --semantics rednet, not with '{semantics}'{fields}.")
    if isinstance(kind.config, NetworkConfig):
        weights_file(weights)
    return kind


def is_calibrated(weights: Path) -> bool:
    """Returns whether weights have a calibration or a temperature; those of other formats than ours have none."""
    try:
        open_plain(weights, what="Weights").close()  # safetensors would wait for the writer of a named pipe
        with safe_open(weights, framework="np") as stream:
            return not {"calibration", "temperature"}.isdisjoint(stream.metadata() or {})
    except (SafetensorError, OSError, ConfigError):
        return False


def detector_config(kind: SegmentationKind, weights: Path | None) -> object:
    """Returns the default configuration of a kind of segmentation on this machine, with the user's weights if any."""
    if isinstance(kind.config, NetworkConfig):
        return replace(kind.config, weights=weights or kind.config.weights, mirrored=computes_bf16())
    return kind.config


def precision_of(config: object) -> str | None:
    """Returns the precision in which a network computes on this machine, bf16 or fp32; None: it is not a network."""
    if not isinstance(config, NetworkConfig):
        return None
    return "bf16" if config.mirrored and computes_bf16() else "fp32"


def make_segmenter(semantics: str, env: ObjectNavEnv, weights: Path | None = None) -> Segmenter:
    """Returns the segmenter of a kind, with its default configuration, for tools that have no run.

    Args:
        semantics: one of `KINDS`, or `package.module:NAME`.
        env: an environment with the sensors and the true images that the kind's specification names.
        weights: the user's weights; None: those that ship.

    Raises:
        ConfigError: there is no such kind, or its weights are missing, broken or of another network.
    """
    kind = find_segmentation(semantics, weights)
    return kind.make(env, detector_config(kind, weights))


def weights_file(weights: Path | None) -> Path:
    """Returns the file of a network's weights: the given one, else the shipped one.

    Raises:
        ConfigError: the file does not exist.
    """
    file = weights or SHIPPED_REDNET
    if not file.is_file():
        hint = (
            f" It ships with the package; `{command('train', 'segmentation')}` makes one of your own."
            if file == SHIPPED_REDNET
            else ""
        )
        raise ConfigError(f"No weights at '{file}'.{hint}")
    return file


def detector_record(config: object) -> Any:
    """Returns a detector's configuration as JSON types, with the checksum of its weights if it has any."""
    content = as_json(config)
    if isinstance(config, NetworkConfig):
        return content | {
            "precision": precision_of(config),
            "weights_sha256": file_sha256(weights_file(config.weights)),
        }
    return content


@functools.cache
def file_sha256(file: Path) -> str:
    """Returns the SHA-256 of a file, hexadecimal."""
    return sha256_of(file, what="File")
