"""Registers `--env.type=stubborn` with LeRobot and the environment with Gymnasium, on import."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import gymnasium
from lerobot.configs.types import FeatureType, PolicyFeature
from lerobot.envs.configs import EnvConfig

from sim.app.bridges.lerobot.features import ACTION, FPS, GOAL, IMAGE, STATE, VECTORS

ENV_ID = "lerobot_env_stubborn/ObjectNav-v0"

if ENV_ID not in gymnasium.registry:
    gymnasium.register(  # a wrapper would hide the task from lerobot
        ENV_ID, entry_point="sim.app.bridges.lerobot.environment:LeRobotEnv", order_enforce=False
    )


@EnvConfig.register_subclass("stubborn")
@dataclass
class StubbornEnv(EnvConfig):
    """The options `--env....`; see `sim.app.bridges.lerobot.environment.LeRobotEnv`."""

    task: str | None = "ObjectNav-v0"
    fps: int = FPS
    split: str = "val"
    """A shipped split, or a folder laid out like one."""
    goal: str = ""
    """Only episodes with this goal, a category or words."""
    width_px: int = 320
    """Width of the pictures: that of the dataset on which the policy was trained."""
    max_steps: int = 500
    profile: str = "fast"
    noise: str = "none"
    features: dict[str, PolicyFeature] = field(default_factory=dict)
    features_map: dict[str, str] = field(
        default_factory=lambda: {
            ACTION: ACTION, "pixels": IMAGE, "agent_pos": STATE, "environment_state": GOAL,
        }
    )  # fmt: skip

    def __post_init__(self) -> None:
        height_px = 2 * round(0.375 * self.width_px)  # of a camera of 640 x 480
        self.features |= {
            ACTION: PolicyFeature(FeatureType.ACTION, (len(VECTORS[ACTION]),)),
            "pixels": PolicyFeature(FeatureType.VISUAL, (height_px, self.width_px, 3)),
            "agent_pos": PolicyFeature(FeatureType.STATE, (len(VECTORS[STATE]),)),
            "environment_state": PolicyFeature(FeatureType.ENV, (len(VECTORS[GOAL]),)),
        }

    @property
    def package_name(self) -> str:
        """The package that registers the environment."""
        return "lerobot_env_stubborn"

    @property
    def gym_kwargs(self) -> dict[str, Any]:
        """Arguments of the environment."""
        names = ("split", "goal", "width_px", "max_steps", "profile", "noise")
        return {name: getattr(self, name) for name in names}
