"""The policy that `examples/train_ppo.py` trains, as an agent of `stubborn run` (needs `pip install '.[train]'`).

stubborn run --agent examples.ppo_agent:AGENT --config-file runs/ppo/run.toml --house examples/my_house.xml --goal sofa

It observes the direction of the sofa in one room, which is ground truth, the depth in sixteen directions, and whether
the last action was stopped by a contact.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from sim import Action, AgentSpec, CameraModel, ConfigError, Observation, SensorContext

GOAL, GOAL_XY_M = "sofa", (5.4, 2.5)
CAMERA = CameraModel(width_px=64, height_px=48, min_depth_m=0.0)
RAYS = 16


class GoalVector:
    """Distance to the goal in units of 5 m, and the sine and cosine of its direction, from the robot."""

    name, images, reads, noise = "goal_vector", (), ("pose",), None

    def space(self, camera: CameraModel) -> spaces.Box:
        """Returns the space of float32 vectors (3,)."""
        return spaces.Box(-10.0, 10.0, (3,), np.float32)

    def read(self, context: SensorContext) -> NDArray:
        """Returns the vector to the middle of the sofa."""
        x_m, y_m = GOAL_XY_M[0] - context.pose.x_m, GOAL_XY_M[1] - context.pose.y_m
        direction_rad = np.arctan2(y_m, x_m) - context.pose.yaw_rad
        return np.array([np.hypot(x_m, y_m) / 5.0, np.sin(direction_rad), np.cos(direction_rad)], np.float32)


class Rays:
    """Smallest depth in each of `RAYS` groups of columns of the image's middle rows, relative to the largest depth."""

    name, images, noise = "rays", ("depth",), None

    def space(self, camera: CameraModel) -> spaces.Box:
        """Returns the space of float32 distances (RAYS,)."""
        return spaces.Box(0.0, 1.0, (RAYS,), np.float32)

    def read(self, context: SensorContext) -> NDArray:
        """Returns the distances from left to right; a larger image is sampled at the resolution of the training."""
        depth_m = context.images["depth"]
        block = max(1, depth_m.shape[1] // CAMERA.width_px)
        depth_m = depth_m[block // 2 :: block, block // 2 :: block]
        middle = depth_m[len(depth_m) // 4 : 3 * len(depth_m) // 4]
        return np.stack([part.min() for part in np.array_split(middle, RAYS, axis=1)]) / np.float32(CAMERA.max_depth_m)


class Bumper:
    """1 after an action that a contact stopped, else 0."""

    name, images, reads, noise = "blocked", (), ("collided",), None

    def space(self, camera: CameraModel) -> spaces.Box:
        """Returns the space of one float32."""
        return spaces.Box(0.0, 1.0, (1,), np.float32)

    def read(self, context: SensorContext) -> NDArray:
        """Returns whether the last action was stopped, float32 (1,)."""
        return np.array([context.collided], np.float32)


SENSORS = (GoalVector(), Rays(), Bumper())
SPACE = spaces.Dict({sensor.name: sensor.space(CAMERA) for sensor in SENSORS})
"""Space of the policy's observations, which are flattened in this order."""


@dataclass(frozen=True)
class PolicyConfig:
    """The agent's options."""

    policy: Path = Path("runs/ppo/policy.zip")
    """The file that `examples/train_ppo.py` writes."""


class PolicyAgent:
    """An agent that takes the most probable action of the policy."""

    def __init__(self, config: PolicyConfig) -> None:
        try:
            from stable_baselines3 import PPO
        except ImportError as error:
            raise ConfigError(f"{error}: the agent needs Stable-Baselines3 (pip install '.[train]').") from None
        if not config.policy.is_file():
            raise ConfigError(f"No policy at '{config.policy}': python -m examples.train_ppo trains one.")
        self.policy = PPO.load(config.policy, device="cpu")

    def reset(self, goal: str, seed: int) -> None:
        """Starts an episode; the policy has no memory."""
        if goal != GOAL:
            raise ConfigError(f"This policy was trained to find a {GOAL}, got '{goal}'; give --goal {GOAL}.")

    def act(self, observation: Observation) -> Action:
        """Returns the most probable action."""
        seen = spaces.flatten(SPACE, {sensor.name: observation[sensor.name] for sensor in SENSORS})
        action, _ = self.policy.predict(np.asarray(seen), deterministic=True)
        return Action(int(action))


def make(*, config: PolicyConfig | None = None, **others: Any) -> PolicyAgent:
    """Returns the agent."""
    return PolicyAgent(config or PolicyConfig())


AGENT = AgentSpec(
    make=make,
    description="the PPO policy of examples/train_ppo.py",
    config=PolicyConfig(),
    sensors=SENSORS,
    uses_segmentation=False,
    uses_ground_truth=True,
)
