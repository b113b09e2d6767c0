"""Segmentation from the observation's own `semantic` image: what an ideal network would say."""

from __future__ import annotations

import numpy as np

from sim.interface import MPCAT40_ID, ConfigError, Observation, Scores, SegmenterSpec


class GroundTruthSegmenter:
    """Score 1 where the pixel's category is the goal's, else 0."""

    spec = SegmenterSpec(sensors=("semantic",), exact_outlines=True)

    def scores(self, observation: Observation, goal: str) -> Scores:
        """Scores at the image's own resolution; void pixels score 0 for everything."""
        if goal not in MPCAT40_ID:
            raise ConfigError(f"No category {goal!r} in mpcat40. There is: {', '.join(MPCAT40_ID)}.")
        semantic = observation["semantic"]
        target = semantic == MPCAT40_ID[goal]
        other = (semantic != 0) & ~target
        return Scores(target.astype(np.float32), other.astype(np.float32))
