"""Ends what leads nowhere: it notices missing progress, and remembers which tracks to try again, and when."""

from __future__ import annotations

from collections.abc import Iterable

from sim.core.geometry.pose import Pose
from stubborn.mapping.collision_marks import STAYED_M, pushed_without_moving


class Progress:
    """Counts the steps in which pursuit did not get anywhere, and those in which the robot did not move at all.

    Args:
        least_m: the robot makes progress when it is this far from where the count began.
        most_steps: number of steps of pursuit without progress that are too many.
        most_pushes: number of steps in which the robot drove but did not move that show that something stops it.
    """

    def __init__(self, least_m: float, most_steps: int, most_pushes: int) -> None:
        self.least_m = least_m
        self.most_steps = most_steps
        self.most_pushes = most_pushes
        self._begin: tuple[Pose, int] | None = None  # the pose at the start of the count, and the steps since then
        self._times_felt = 0  # collisions that had changed the map then
        self._before: Pose | None = None
        self._pushes = 0

    @property
    def pushes_on(self) -> bool:
        """Whether something stops the robot here."""
        return self._pushes >= self.most_pushes

    def count_pushes(self, pose: Pose, *, drove: bool) -> None:
        """Counts a step in which the robot `drove` but did not move; a move restarts the count."""
        before, self._before = self._before, pose
        if before is None or pose.distance_to(before) >= STAYED_M:
            self._pushes = 0
        elif drove and pushed_without_moving(before, pose):
            self._pushes += 1

    def is_stuck(self, pose: Pose, *, pursuing: bool, times_felt: int) -> bool:
        """Counts a step, and returns True if there were too many without progress; then it restarts the count.

        Steps without pursuit neither count nor restart the count: otherwise a track that is visible at only one of two
        headings would turn the robot back and forth. A collision that changed the map (`times_felt`) restarts the
        count, because it takes time to follow a surface to its end.
        """
        if times_felt != self._times_felt:
            self._times_felt, self._begin = times_felt, None
        if self._begin is None or pose.distance_to(self._begin[0]) > self.least_m:
            self._begin = pose, 0
        begin, steps = self._begin
        stuck = pursuing and steps >= self.most_steps
        self._begin = (pose, 0) if stuck else (begin, steps + pursuing)
        return stuck


class SetAside:
    """The tracks that wait until they are tried again, and the places around which doubtful tracks wait.

    Args:
        first_steps: how long a track waits the first time; each time it waits twice as long as before.
        last_resort_step: at this step, all tracks that were set aside before are tried again.
    """

    def __init__(self, first_steps: int, last_resort_step: int) -> None:
        self.first_steps = first_steps
        self.last_resort_step = last_resort_step
        self._due_step: dict[int, int] = {}
        self._wait_steps: dict[int, int] = {}
        self._spots: list[tuple[Pose, int]] = []

    def add(self, tracks: Iterable[int], step: int) -> None:
        """Lets some tracks wait."""
        for track in tracks:
            wait = self._wait_steps.get(track, self.first_steps)
            again = step + wait
            if step < self.last_resort_step:
                again = min(again, self.last_resort_step)
            self._due_step[track], self._wait_steps[track] = again, 2 * wait

    def add_spot(self, x_m: float, y_m: float, step: int) -> None:
        """Lets the doubtful tracks around a place wait once: an object may reappear there as another track."""
        self._spots.append((Pose(x_m, y_m, 0.0), step + self.first_steps))

    def is_due(self, track: int, step: int) -> bool:
        """Returns whether a track does not wait."""
        return step >= self._due_step.get(track, 0)

    def is_near_spot(self, x_m: float, y_m: float, within_m: float, step: int) -> bool:
        """Returns whether doubtful tracks wait within this distance of a place."""
        return any(step < until and spot.distance_to(Pose(x_m, y_m, 0.0)) <= within_m for spot, until in self._spots)

    def end(self) -> None:
        """Ends the waiting times of tracks, not those of places."""
        self._due_step.clear()
        self._wait_steps.clear()
