"""The paper's comparison for verification: one frame decides (Table "ObjIDResults", Single-Frame)."""

from __future__ import annotations

from sim.interface import CameraModel, RobotModel, Segmenter
from stubborn.agent import AgentConfig, StubbornAgent
from stubborn.mapping.object_layers import LatestFrame


def single_frame_agent(
    *, camera: CameraModel, robot: RobotModel, segmenter: Segmenter, config: AgentConfig
) -> StubbornAgent:
    """The Stubborn agent without verification, one frame's score in place of the layers.

    It heads for what looked like the target when it was last in view, and stops within reach of a point that looks so
    in this very frame.
    """
    layers = LatestFrame(config.mapping.candidate_score)
    return StubbornAgent(camera=camera, robot=robot, segmenter=segmenter, layers=layers, config=config)
