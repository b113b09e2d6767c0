"""What the frames of an episode say about the goal: a probability for each track.

A goal is a category, words or a picture. Its category comes from the fusion of views (`stubborn.detection.fusion`), its
name and conditions from `stubborn.detection.attributes`, its likeness to a picture from `stubborn.detection.pictured`.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np
from jaxtyping import Float32, Int32

from sim.core.geometry.grid import GridFrame
from sim.core.geometry.pose import Pose
from sim.core.interface import Observation
from sim.core.wishes import Wish
from stubborn.detection.attributes import AT_LAST, Attributes
from stubborn.detection.context import SHIPPED, read_context
from stubborn.detection.fusion import fusion_for
from stubborn.detection.pictured import PictureEvidence
from stubborn.detection.seeker import SeekerParts
from stubborn.detection.tracks import TrackConfig, Tracks

GOAL_TEXT, GOAL_PICTURE = "goal", "goal_picture"
"""The sensors whose presence says that goals may be in words or pictures: what these ask for is then learned from the
start."""


class GoalEvidence:
    """The tracks of an episode, and the evidence on what they are.

    Args:
        config: parameters of the tracks.
        parts: parts of the agent.
        least: names, conditions and pictures are compared only for tracks with at least this probability.
        context: file of `stubborn train context`; None: the shipped one.
        context_share: share of the context's log ratios that counts; 0: none.
    """

    def __init__(
        self, config: TrackConfig, parts: SeekerParts, *, least: float, context: Path | None, context_share: float
    ) -> None:
        self.config = config
        self.camera = parts.camera
        self.robot = parts.robot
        self.segmenter = parts.segmenter
        self.wished = parts.wished
        self.least = least
        self.exact = not parts.segmenter.spec.needs_verification
        self.fusion = fusion_for(parts.segmenter.spec, config.evidence.fusion)
        self.context_share = context_share
        self.context = None if self.exact or context_share == 0.0 else read_context(context or SHIPPED)
        self.reset()

    def reset(self) -> None:
        """Forgets the last episode."""
        self.tracks: Tracks | None = None
        self.attributes: Attributes | None = None
        """The names and attributes of the tracks; None: no goal was in words yet, or the first frame was not seen."""
        self.pictured: PictureEvidence | None = None
        """The colours of the tracks; None: no goal was a picture yet, or the first frame was not seen."""
        self.next_goal()

    def next_goal(self) -> None:
        """Starts with another goal in the same episode: tracks and their attributes stay."""
        self._refused = set[int]()  # tracks that another judge took for something else

    def of_episode(self) -> Tracks:
        """Returns the tracks of the episode; `add` comes first."""
        assert self.tracks is not None, "add comes first"
        return self.tracks

    def refuse(self, tracks: Iterable[int]) -> None:
        """Sets the probability of some tracks to 0 until the goal changes."""
        self._refused.update(tracks)

    def add(self, observation: Observation, pose: Pose, goal: str, frame: GridFrame) -> None:
        """Enters a frame. `goal` is the category that the frame is searched for, `frame` the map's."""
        if self.tracks is None:
            self.tracks = Tracks(self.config, self.camera, self.robot.camera_forward_m, frame, self.fusion)
        if self.attributes is None and (self._wish is not None or GOAL_TEXT in observation):
            self.attributes = Attributes(self.tracks.plan, self.tracks.config.most_tracks)
        if self.pictured is None and GOAL_PICTURE in observation:
            self.pictured = PictureEvidence(self.tracks.config.most_tracks)
        posteriors, depth = self.segmenter.posteriors(observation), observation["depth"]
        objects = None
        learns = self.attributes is not None or self.pictured is not None
        if learns and self.wished is not None and "rgb" in observation:  # a level camera
            objects = self.wished.objects(observation, posteriors.shape[1:])
        self.tracks.add(posteriors, depth, pose, goal, None if objects is None else objects[0])
        if learns:
            self._learn(self.tracks, posteriors, observation, objects, pose)

    def probabilities(self, goal: str, *, late: bool) -> Float32[np.ndarray, " numbers"]:
        """Returns the probability of the goal for each track, by its number; entry 0 belongs to no track.

        Args:
            goal: the category; where the goal is in words, their categories count.
            late: whether an object must be chosen although the conditions of the goal are not certain.
        """
        tracks = self.of_episode()
        probability = self._asked_for(tracks, goal, late)
        if self._refused:
            self._refused = set(tracks.now()[list(self._refused)].tolist())
            probability[list(self._refused)] = 0.0
        return probability

    def _learn(
        self,
        tracks: Tracks,
        posteriors: Float32[np.ndarray, "classes h w"],
        observation: Observation,
        objects: tuple[Int32[np.ndarray, "h w"], Sequence[str]] | None,
        pose: Pose,
    ) -> None:
        """Enters a frame into the evidence on names, attributes and colours."""
        rgb, columns = observation.get("rgb"), posteriors.shape[2]
        if rgb is not None:
            block = rgb.shape[1] // columns
            rgb = rgb[block // 2 :: block, block // 2 :: block]
        pixels = tracks.pixels(observation["depth"], pose, columns)
        if self.attributes is not None:
            named = None
            if objects is None and self.wished is not None and rgb is not None:
                named = self.wished.named(observation, posteriors.shape[1:])
            self.attributes.add(pixels, posteriors, rgb, objects, named)
        if self.pictured is not None and rgb is not None:
            self.pictured.add(pixels, rgb)

    def _asked_for(self, tracks: Tracks, goal: str, late: bool) -> Float32[np.ndarray, " numbers"]:
        """Returns the probability of the goal's categories for each track, times that of its name and conditions."""
        wish, least_voxels = self._wish, 1 if self.exact else self.config.least_voxels
        categories = (goal,) if wish is None else wish.categories
        probability = np.sum(
            [tracks.probabilities(category, least_voxels, self.context, self.context_share) for category in categories],
            axis=0,
        )
        attributes, picture = self.attributes, None if self.wished is None else self.wished.picture
        if picture is not None and self.pictured is not None:
            candidates = np.flatnonzero(probability >= self.least)
            factors = self.pictured.factors(picture, tracks, candidates, late)
            probability[candidates] = self._weighed(probability[candidates], factors, late)
        if wish is None or attributes is None:
            return probability
        probability = np.minimum(probability, np.float32(1.0))
        candidates = np.flatnonzero(probability >= self.least)
        probability[candidates] *= attributes.name_shares(tracks, candidates, wish.names)
        candidates = candidates[probability[candidates] >= self.least]
        if candidates.size:
            well_seen = np.array([bool(tracks.evidence.near_sectors(track).any()) for track in candidates.tolist()])
            factors = attributes.factors(wish, tracks, candidates, late, well_seen)
            probability[candidates] = self._weighed(probability[candidates], factors, late)
        return probability

    def _weighed(
        self, probability: Float32[np.ndarray, " n"], factors: Float32[np.ndarray, " n"], late: bool
    ) -> Float32[np.ndarray, " n"]:
        """Returns probabilities times the factors of conditions; late, those of the best object count as `AT_LAST`.

        The house has the goal, and no better object was found. If names are certain, so is then the whole probability.
        """
        if not late:
            return probability * factors
        return _raised(probability * factors) if self.exact else probability * _raised(factors)

    @property
    def _wish(self) -> Wish | None:
        return None if self.wished is None else self.wished.wish


def _raised(values: Float32[np.ndarray, " n"]) -> Float32[np.ndarray, " n"]:
    """Returns values in the same ratios, of which the largest is at least `AT_LAST` unless all are 0."""
    best = float(values.max(initial=0.0))
    return values * np.float32(AT_LAST / best) if 0.0 < best < AT_LAST else values
