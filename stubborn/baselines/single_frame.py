"""Baselines for verification: none at all (the paper's Single-Frame, Table "ObjIDResults"), and no memory either."""

from __future__ import annotations

from typing import Any

from sim.interface import MAX_STEPS
from stubborn.agent import AgentConfig, StubbornAgent
from stubborn.detection.verification import AcceptAll, Verifier
from stubborn.mapping.object_layers import LatestFrame


def single_frame_agent(
    *, config: AgentConfig, verifier: Verifier | None = None, max_steps: int = MAX_STEPS, **parts: Any
) -> StubbornAgent:
    """Returns the Stubborn agent with the same map and without verification; the verifier is not used.

    One frame with a high score makes a candidate, and the agent stops there: "only the first stage" of the paper.
    """
    return StubbornAgent(**parts, verifier=AcceptAll(), config=config, max_steps=max_steps)


def latest_frame_agent(
    *, config: AgentConfig, verifier: Verifier | None = None, max_steps: int = MAX_STEPS, **parts: Any
) -> StubbornAgent:
    """Returns the Stubborn agent without verification, with the score of one frame in place of the layers.

    It goes to candidates in the frame that last showed a cell, and stops in reach of a candidate in the current frame.
    The verifier is not used.
    """
    layers = LatestFrame(config.mapping.candidate_score)
    return StubbornAgent(**parts, layers=layers, verifier=AcceptAll(), config=config, max_steps=max_steps)
