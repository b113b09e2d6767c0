"""Tests the conditions of a goal in words on tracked objects: colour, size, room, and what is next to them.

Each condition gives a track a factor in [0, 1] on its probability of the goal. A condition that cannot be judged yet
gives `UNDECIDED`, below the limit for a STOP and above the one for a look, so that the robot goes nearer.

Colours and rooms are judged by `attributes.json`, fitted in houses of `train` by `tools.training.fit_attributes`: which
colours the pixels of an object of each colour have, and which categories rooms of each kind hold. Materials are not
judged.
"""

from __future__ import annotations

import functools
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import msgspec
import numpy as np
from jaxtyping import Bool, Float32, Int, UInt8

from sim.core.colours import COLOUR_NAMES, colour_numbers
from sim.core.geometry.grid import GridFrame
from sim.core.interface import MPCAT40, MPCAT40_ID
from sim.core.reading import Number, read_json
from sim.core.vocabulary import NO_OBJECTS, vocabulary
from sim.core.wishes import Beside, Wish
from stubborn.detection.classifiers import logistic
from stubborn.detection.tracks import Pixels, Tracks

FILE = Path(__file__).with_name("attributes.json")
UNDECIDED, AT_LAST = 0.45, 0.7
"""Factor of a condition that is not decided, and the same when an object must be chosen."""
_NO_COLOUR = 0.3
"""Weight of the case that no one colour describes an object: people name the one that it looks like most."""
_SEEN_ALONE = 0.85
"""The factor of an object that was seen well but not beside what the wish names is this share of `UNDECIDED`: what is
beside it may be out of the picture."""
_MIN_PIXELS = 60
"""Pixels of a track, at the resolution of the posteriors, from which its colour is judged."""
_NEXT_TO_M, _SAME_ROOM_M = 0.75, 4.5
"""Largest gap in plan of objects next to each other, and largest distance of those that tell the kind of a room."""
_TOUCHING_M, _TOP_M = 0.15, 0.25
"""An object lies on another one if their boxes are at most this far apart in plan, and its bottom is at most this far
below the other one's top: boxes consist of voxels of 10 cm."""
_MIN_SHARE = 0.02
"""Names that are less probable than this, on average over the pixels of a track in a frame, are not counted."""
_CERTAIN = 0.5
"""Probability of a category from which a track counts as an object of it."""
_STRUCTURES = ("wall", "window", "door")
_WALL_LOW_M, _WALL_HIGH_M = 0.9, 2.0
"""Heights between which a pixel of a wall, a window or a door marks its cell."""

Share = Annotated[float, msgspec.Meta(ge=0.0, le=1.0)]


class _Colours(msgspec.Struct):
    """A logistic regression from the square roots of the shares of the pixels' colours to the colour of an object."""

    names: list[str]
    """The colours; "": an object that no one colour describes."""
    weights: list[list[Number]]
    """For each of them, weights of `COLOUR_NAMES`."""
    offsets: list[Number]


class Logistic(msgspec.Struct):
    """A logistic regression from some numbers to a probability."""

    weights: list[Number]
    offset: Number

    def probability(self, values: Sequence[float]) -> float:
        """Returns the probability, in (0, 1)."""
        return logistic(self.offset + sum(w * v for w, v in zip(self.weights, values, strict=True)))


class _File(msgspec.Struct):
    """The fitted numbers."""

    picture: Logistic
    """From the two similarities of `stubborn.detection.pictured` to the probability of the same object."""
    colours: _Colours
    rooms: dict[str, dict[str, Share]]
    """For each kind of room, the share of the rooms that hold an object of each category."""


@functools.cache
def fitted() -> _File:
    """Returns the numbers of `attributes.json`."""
    return read_json(FILE, _File, what="Fitted attributes")


class Attributes:
    """The evidence on names and attributes of all tracks of an episode, whatever its goals are.

    Args:
        frame: the grid of the voxels from above.
        most_tracks: limit of the number of tracks.
    """

    def __init__(self, frame: GridFrame, most_tracks: int) -> None:
        self._frame = frame
        self._colours = np.zeros((most_tracks, len(COLOUR_NAMES)), np.float64)
        self._names: dict[int, dict[str, float]] = {}
        """How many pixels of each track were seen with each name: a whole number, or a sum of probabilities."""
        self._guessed: frozenset[str] | None = None
        """The names that the segmentation has probabilities of; None: it has none."""
        self._marks = {name: np.zeros(frame.shape, np.bool_) for name in _STRUCTURES}

    def add(
        self,
        pixels: Pixels,
        posteriors: Float32[np.ndarray, "classes h w"],
        rgb: UInt8[np.ndarray, "h w 3"] | None,
        objects: tuple[Int[np.ndarray, "h w"], Sequence[str]] | None,
        named: tuple[Float32[np.ndarray, "names rows cols"], Sequence[str]] | None = None,
    ) -> None:
        """Enters one frame.

        Args:
            pixels: tracks and places of its pixels.
            posteriors: at the same resolution.
            rgb: the image at the same resolution; None: it is not known.
            objects: the object of each pixel and the names of all, if the segmentation tells objects apart.
            named: the probability of each name at a whole fraction of the resolution, and the names, if it does not
                tell objects apart but guesses names.
        """
        high = (pixels.row >= 0) & (pixels.height_m > _WALL_LOW_M) & (pixels.height_m < _WALL_HIGH_M)
        for name, marks in self._marks.items():
            shown = high & (posteriors[MPCAT40_ID[name] - 1] > _CERTAIN)
            marks[pixels.row[shown], pixels.col[shown]] = True
        seen = pixels.track > 0
        tracks = pixels.track[seen]
        if rgb is not None and tracks.size:
            np.add.at(self._colours, (tracks, colour_numbers(rgb[seen].astype(np.float32) / 255.0)), 1.0)
        if objects is not None:
            image, every_name = objects
            pairs, counts = np.unique(np.stack([tracks, image[seen]]), axis=1, return_counts=True)
            for (track, number), count in zip(pairs.T.tolist(), counts.tolist(), strict=True):
                if number >= 0:
                    self._count(track, str(every_name[int(number)]), count)
        elif named is not None:
            self._guess(pixels.track, *named)

    def _count(self, track: int, name: str, count: float) -> None:
        of_track = self._names.setdefault(track, {})
        of_track[name] = of_track.get(name, 0) + count

    def _guess(
        self,
        track: Int[np.ndarray, "h w"],
        image: Float32[np.ndarray, "names rows cols"],
        names: Sequence[str],
    ) -> None:
        """Counts the pixels of each track by the probability of each name."""
        self._guessed = frozenset(names)
        every = track.shape[0] // image.shape[1]
        cells = np.arange(image[0].size).reshape(image[0].shape).repeat(every, axis=0).repeat(every, axis=1)
        for number in np.unique(track[track > 0]).tolist():
            pixels = np.bincount(cells[track == number], minlength=image[0].size)
            counts = image.reshape(len(names), -1) @ pixels.astype(np.float32)
            for index in np.flatnonzero(counts > _MIN_SHARE * pixels.sum()).tolist():
                self._count(number, names[index], float(counts[index]))

    def name_shares(
        self, tracks: Tracks, candidates: Int[np.ndarray, " n"], names: frozenset[str]
    ) -> Float32[np.ndarray, " n"]:
        """Returns how many pixels of each candidate have one of some names, as a share.

        If the segmentation tells objects apart, it is a share of the most frequent name's pixels: a track has pixels of
        its neighbours, of the counter around a sink, and of the surface behind a thin object, which do not count. If it
        guesses names, it is a share of all pixels. It is 1 if the segmentation knows no names, or guesses names and has
        not learned all of these, and 0 for a track that was not seen with its name yet.
        """
        self._follow_merges(tracks.now())
        if not self._names or (self._guessed is not None and not names <= self._guessed):
            return np.ones(len(candidates), np.float32)
        counts = [self._names.get(track, {}) for track in candidates.tolist()]
        if self._guessed is not None:  # among the names of their categories: those have a probability of their own
            categories = set(vocabulary().categories_of(names))
            alike = [name for name in self._guessed if not categories.isdisjoint(vocabulary().categories.get(name, ()))]
            counts = [{name: of_track.get(name, 0.0) for name in alike} for of_track in counts]
            whole = [sum(of_track.values()) for of_track in counts]
        else:
            whole = [max((of_track[name] for name in of_track.keys() - NO_OBJECTS), default=0.0) for of_track in counts]
        right = np.array([sum(of_track.get(name, 0.0) for name in names) for of_track in counts])
        return np.minimum(right / np.maximum(whole, 1e-6), 1.0).astype(np.float32)

    def factors(
        self,
        wish: Wish,
        tracks: Tracks,
        candidates: Int[np.ndarray, " n"],
        late: bool,
        well_seen: Bool[np.ndarray, " n"],
    ) -> Float32[np.ndarray, " n"]:
        """Returns the factor of the conditions for each candidate.

        Args:
            wish: the goal.
            tracks: all objects.
            candidates: numbers of the tracks that are probably of the goal's category.
            late: whether an object must be chosen: there is nothing new to see, or few actions are left.
            well_seen: candidates that were seen from near, so that what is next to them was, too.
        """
        self._follow_merges(tracks.now())
        undecided = AT_LAST if late else UNDECIDED
        result = np.ones(len(candidates))
        if wish.colour is not None:
            result *= [self._colour_factor(track, wish.colour, undecided) for track in candidates.tolist()]
        if wish.rooms:
            result *= [self._room_factor(tracks, track, wish.rooms, undecided) for track in candidates.tolist()]
        for beside in wish.beside:
            near = [self._is_at(tracks, track, beside) for track in candidates.tolist()]
            result *= np.where(near, 1.0, np.where(well_seen, _SEEN_ALONE * undecided, undecided))
        if wish.size is not None:
            result *= self._size_factors(wish, tracks, candidates, result, undecided)
        return result.astype(np.float32)

    def _follow_merges(self, now: Int[np.ndarray, " numbers"]) -> None:
        """Moves the evidence on tracks that were merged to the track that they are a part of."""
        follow_merges(now, self._colours)
        for track in [track for track in self._names if now[track] != track]:
            for name, count in self._names.pop(track).items():
                self._count(int(now[track]), name, count)

    def _colour_factor(self, track: int, colour: str, undecided: float) -> float:
        counts = self._colours[track]
        if counts.sum() < _MIN_PIXELS:
            return undecided
        colours = fitted().colours
        logits = np.array(colours.weights) @ np.sqrt(counts / counts.sum()) + np.array(colours.offsets)
        odds = np.exp(logits - logits.max())
        odds[colours.names.index("")] *= _NO_COLOUR
        return float(odds[colours.names.index(colour)] / odds.sum())

    def _room_factor(self, tracks: Tracks, track: int, rooms: Sequence[str], undecided: float) -> float:
        """Returns the probability that a track is in a room of the wish, by the categories of the tracks around it."""
        if not fitted().rooms.keys() & set(rooms):
            return undecided  # a studio holds what several kinds of rooms hold, and has no numbers of its own
        x_m, y_m = tracks.middle_xy_m(track)
        held = {name for name in self._categories_around(tracks, track, x_m, y_m) if name in _room_categories()}
        if not held:
            return undecided
        logs = {}
        for kind, shares in fitted().rooms.items():
            present = sum(np.log(max(shares.get(name, 0.0), 0.02)) for name in held)
            absent = sum(np.log(max(1.0 - share, 0.3)) for name, share in shares.items() if name not in held)
            logs[kind] = present + absent
        best = max(logs.values())
        odds = {kind: np.exp(value - best) for kind, value in logs.items()}
        probability = sum(odds.get(kind, 0.0) for kind in rooms) / sum(odds.values())
        return float(probability if abs(probability - 0.5) > 0.2 or len(held) > 3 else undecided)

    def _categories_around(self, tracks: Tracks, track: int, x_m: float, y_m: float) -> set[str]:
        """Returns the categories of the tracks near a place that no wall seen so far separates from it."""
        numbers = np.flatnonzero(tracks.sizes(np.arange(tracks.count + 1)) > 0)
        numbers = numbers[numbers != track]
        x, y = tracks.middles(numbers)
        near = numbers[np.hypot(x - x_m, y - y_m) <= _SAME_ROOM_M]
        probability = tracks.evidence.probability
        result = set()
        for other in near.tolist():
            category = int(np.argmax(probability[other]))
            if probability[other, category] >= _CERTAIN and not self._wall_between(
                (x_m, y_m), tracks.middle_xy_m(other)
            ):
                result.add(MPCAT40[1 + category])
        category = int(np.argmax(probability[track]))
        return result | {MPCAT40[1 + category]}

    def _wall_between(self, a: tuple[float, float], b: tuple[float, float]) -> bool:
        count = max(2, round(float(np.hypot(a[0] - b[0], a[1] - b[1])) / (0.5 * self._frame.cell_m)))
        t = np.linspace(0.0, 1.0, count)
        rows, cols = self._frame.cells(a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]))
        inside = self._frame.contains(rows, cols)
        return bool(self._marks["wall"][rows[inside], cols[inside]].sum() >= 2)

    def _is_at(self, tracks: Tracks, track: int, beside: Beside) -> bool:
        """Returns whether a track is at a place relative to another one, or to a window, a door or a wall."""
        structures = [name for name in _STRUCTURES if name in beside.names]
        if structures:
            return any(self._is_near_mark(tracks, track, name) for name in structures)
        categories = [MPCAT40_ID[name] - 1 for name in vocabulary().categories_of(beside.names)]
        probability = tracks.evidence.probability[: tracks.count + 1, categories].sum(axis=1)
        for other in np.flatnonzero(tracks.sizes(np.arange(tracks.count + 1)) > 0).tolist():
            name = self.name_of(other)
            is_it = name in beside.names if name else probability[other] >= _CERTAIN
            if other == track or not is_it:
                continue
            gap_m, above_m = tracks.gap_m(track, other), tracks.above_m(track, other)
            if beside.place == "next to":
                at = gap_m <= _NEXT_TO_M
            else:
                at = gap_m <= _TOUCHING_M and (above_m > -_TOP_M) == (beside.place == "on")
            if at and not self._wall_between(*tracks.nearest_points_m(track, other)):
                return True
        return False

    def name_of(self, track: int) -> str:
        """Returns the everyday name that most pixels of a track have; "": it is not known."""
        names = self._names.get(track)
        return max(names, key=names.__getitem__) if names else ""

    def _is_near_mark(self, tracks: Tracks, track: int, name: str) -> bool:
        (row, col), (last_row, last_col) = tracks.box(track)
        reach = round(_NEXT_TO_M / self._frame.cell_m)
        around = self._marks[name][
            max(row - reach, 0) : last_row + reach + 1, max(col - reach, 0) : last_col + reach + 1
        ]
        return bool(around.sum() >= 2)

    def _size_factors(
        self, wish: Wish, tracks: Tracks, candidates: Int[np.ndarray, " n"], others: np.ndarray, undecided: float
    ) -> np.ndarray:
        """Returns 1 for the extreme of the candidates that satisfy the other conditions, if enough are known."""
        fits = others >= _CERTAIN
        if not fits.any():
            return np.full(len(candidates), undecided)
        sizes = np.where(fits, tracks.extents_m(candidates), np.nan)
        best = np.nanargmax(sizes) if wish.size == "largest" else np.nanargmin(sizes)
        factors = np.where(fits, 0.1, undecided)
        enough = wish.count is not None and int(fits.sum()) >= wish.count
        factors[best] = 1.0 if enough or undecided == AT_LAST else undecided
        return factors


def follow_merges(now: Int[np.ndarray, " numbers"], *counts: np.ndarray) -> None:
    """Moves counts by track, (numbers, ...), to the tracks that others are a part of now (`Tracks.now`)."""
    for track in np.flatnonzero(now != np.arange(len(now))).tolist():
        for count in counts:
            count[now[track]] += count[track]
            count[track] = 0.0


@functools.cache
def _room_categories() -> frozenset[str]:
    return frozenset(name for shares in fitted().rooms.values() for name in shares)
