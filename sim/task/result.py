"""The result of an episode: the one declaration of its fields and metrics.

`GoalMetrics` is what the task measures of one goal and `EpisodeMetrics` of an episode, `RolloutResult` adds what the
run of the episode gives, and `EpisodeResult` adds the episode and the agent: it is a line of `results.jsonl`. A metric
is a field with a `Metric` in its type; summaries, comparisons, reports and tables read `METRICS`. To add one, declare
its field here with `| None = None`, so that earlier runs, recordings and submissions are still read, compute it in
`sim.task.objectnav`, and name it in docs/task.md. Three places choose among the metrics: the table of episodes
(`sim.app.analysis.display`), the comparison of replays (`sim.app.submissions.verdicts`) and the leaderboard.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType, NoneType
from typing import Annotated, Any, Literal, Self, get_args, get_type_hints

import msgspec
from msgspec import UNSET, Meta, UnsetType
from msgspec.structs import replace as replace_fields

from sim.core.goals import GoalKind
from sim.core.interface import MAX_STEPS
from sim.core.reading import Count, Metres, Name, Number, Seed
from sim.robot.config import MotionKind

Limit = Literal["max_steps", "time_limit"]
"""The limit that ends an episode: a number of actions, or a time in which the robot is driven by velocities."""
EndReason = Literal["stop", "max_steps", "time_limit", "fallen", "error"]
Share = Annotated[float, Meta(ge=0.0, le=1.0)]
GOAT_DISTANCE_M = 0.25
READ_BY = "0.2.0"
"""The last version that reads results without all of these fields."""


@dataclass(frozen=True)
class Metric:
    """A number of a result: its name, unit and format, and the episodes in which it counts."""

    name: str
    """The name in tables, without the unit."""
    unit: str = ""
    """For example "m"; "%": the value is a share, shown times 100."""
    digits: int = 1
    most: float = math.inf
    """The largest possible value, 1 or infinite. Intervals depend on it."""
    in_summary: bool = True
    """Whether `summary.json` has its mean and interval; comparisons and reports have those of all metrics."""
    counts_errors: bool = False
    """Whether an episode that ended with an error counts. It did not run to its end, so that it has too few steps,
    collisions and metres; only success and SPL are 0 then."""
    complement: bool = False
    """Whether the value is 1 minus that of the field."""
    chains: bool = False
    """Whether only chains have the value; summaries and comparisons without chains leave it out."""
    key: str = ""
    """The key in `summary.json`; "": that of the field."""
    field: str = ""
    """The field of `EpisodeResult`; set by `METRICS`."""

    @property
    def title(self) -> str:
        """The name with its unit: "distance to goal, m"."""
        return self.name + (f" {self.unit}" if self.percent else f", {self.unit}" if self.unit else "")

    @property
    def percent(self) -> bool:
        """True: the value is shown times 100."""
        return self.unit == "%"

    def value(self, result: EpisodeResult) -> float | None:
        """Returns the value in an episode; None: the episode does not count."""
        value = getattr(result, self.field)
        if value is None or (result.is_error and not self.counts_errors):
            return None
        return 1.0 - float(value) if self.complement else float(value)


class StopTarget(msgspec.Struct, frozen=True, kw_only=True):
    """The place for which the agent stopped, as it stated; all None: no STOP, or it stated none."""

    stop_target_xy_m: tuple[Metres, Metres] | None
    """x and y in the world."""
    stop_target_to_goal_m: Number | None
    """Metres in plan from there to the nearest instance of the goal, walls ignored; None also: the storey has none."""
    stop_target_category: str | None
    """Category of the object there; None also where the place has no object."""


NO_STOP_TARGET = StopTarget(stop_target_xy_m=None, stop_target_to_goal_m=None, stop_target_category=None)


class GoalMetrics(StopTarget, frozen=True, kw_only=True):
    """The measurements of the task (docs/task.md). A field that may be None is None if the episode did not begin."""

    success: Annotated[Share, Metric("success", "%", most=1.0, counts_errors=True)]
    spl: Annotated[Share, Metric("SPL", digits=3, most=1.0, counts_errors=True)]
    soft_spl: Annotated[Share, Metric("soft SPL", digits=3, most=1.0, counts_errors=True)]
    distance_to_goal: Annotated[Number | None, Metric("distance to goal", "m", digits=2)]
    """None also: there is no path."""
    num_steps: Annotated[Count, Metric("steps", digits=0, in_summary=False)]
    path_length: Annotated[Number, Metric("path", "m", digits=2, in_summary=False)]
    shortest_path: Number | None
    """None: there is no path."""
    collisions: Annotated[Count, Metric("collisions", digits=2)]
    touches: Count
    gt_explored: Annotated[
        bool | None,
        Metric("GT exploration", "%", most=1.0),
        Metric("never seen", "%", most=1.0, complement=True, key="never_seen"),
    ]
    first_seen_step: Count | None
    """None: no frame showed the goal."""
    steps_to_first_sight: Annotated[Count | None, Metric("steps to first sight", digits=0, most=float(MAX_STEPS))]
    """The step limit where no frame showed the goal: the mean is the restricted mean time to first sight."""
    area_seen_m2: Annotated[Number | None, Metric("area seen", "m2")]
    area_per_metre: Annotated[Number | None, Metric("area per metre", "m2/m", digits=2)]
    trapped: Annotated[bool | None, Metric("trapped", "%", most=1.0)]
    simulated_s: Number
    failure: Name | None
    """Cause of the failure (`sim.task.failures`); None: a success, or the episode still runs."""
    end_reason: EndReason | None
    """None: the episode still runs."""

    def as_info(self) -> dict[str, Any]:
        """Returns the entries of Gymnasium's `info`: vector environments take no None for the first sight."""
        entries = {name: getattr(self, name) for name in GoalMetrics.__annotations__}
        if self.first_seen_step is None:
            del entries["first_seen_step"]
        return entries


class GoalResult(GoalMetrics, frozen=True, kw_only=True, omit_defaults=True):
    """The result of one goal of a chain; a failure without steps if the chain ended before it began."""

    goal: Name
    kind: GoalKind
    repeats: Count | None = None
    """Number of the earlier goal with the same objects: this is its second visit; None: the first visit."""
    goat_success: Share
    """1: STOP less than `GOAT_DISTANCE_M` from a place where it succeeds, which is GOAT-Bench's rule."""
    goat_spl: Share


def goals_found(goals: Sequence[GoalResult]) -> str:
    """Returns the number of goals of a chain that were found: "5 of 7 goals found"."""
    return f"{sum(goal.success == 1.0 for goal in goals)} of {len(goals)} goals found"


class EpisodeMetrics(GoalMetrics, frozen=True, kw_only=True, omit_defaults=True):
    """The measurements of an episode; those of a chain are composed of its goals' (`sim.task.chain`)."""

    composite_success: Annotated[Share | None, Metric("all goals", "%", most=1.0, counts_errors=True, chains=True)] = (
        None
    )
    """1: all goals of the chain succeeded; this and the next fields are None where the episode is not a chain."""
    second_visit_success: Annotated[Share | None, Metric("second visits", "%", most=1.0, chains=True)] = None
    """Mean over the second visits of the chain."""
    second_visit_spl: Annotated[Share | None, Metric("second visits SPL", digits=3, most=1.0, chains=True)] = None
    goat_success: Annotated[Share | None, Metric("success by GOAT", "%", most=1.0, chains=True)] = None
    """Mean over the goals by GOAT-Bench's rule."""
    goat_spl: Annotated[Share | None, Metric("SPL by GOAT", digits=3, most=1.0, chains=True)] = None
    goals: tuple[GoalResult, ...] | None = None
    """The results of the goals in their order."""

    def as_info(self) -> dict[str, Any]:
        """Returns the entries of Gymnasium's `info`; those of a chain have its own metrics and those of its goals."""
        if self.goals is None:
            return super().as_info()
        own = {name: getattr(self, name) for name in EpisodeMetrics.__annotations__ if name != "goals"}
        return super().as_info() | own | {"goals": [goal.as_info() for goal in self.goals]}


class ModelUse(msgspec.Struct, frozen=True, kw_only=True):
    """What an agent asked of a model over HTTP in an episode."""

    model: Name
    questions: Count
    """Questions with a valid reply."""
    failed_questions: Count
    """Questions without one; the agent decided itself."""
    prompt_tokens: Count
    completion_tokens: Count
    cost: Number | None
    """In the currency of the prices that the run states; None: it states none."""
    wait_s: Number | None
    """Time of the questions; None in the scores of a recorded trajectory."""
    fell_back_step: Count | None
    """Step from which the agent decided alone after too many failures; None: it asked until the end."""


class RolloutResult(EpisodeMetrics, frozen=True, kw_only=True, omit_defaults=True):
    """The metrics at the end of an episode, and what its run adds."""

    end_reason: EndReason
    stop_confidence: Share | None
    """The agent's confidence in its STOP; None: no STOP, or it stated none."""
    wall_time_s: Number | None = None
    """None in the scores of a recorded trajectory, which are equal in two runs of the same episode."""
    steps_per_s: Number | None = None
    error: str | None = None
    """Reason why the episode ended with an error."""
    model_use: ModelUse | UnsetType = UNSET
    """Set if the agent asks a model."""

    @property
    def is_error(self) -> bool:
        """True: the episode ended with an error, which counts as a failure."""
        return self.end_reason == "error"

    def without_times(self) -> Self:
        """Returns the part that is equal in two runs of the same episode."""
        use = self.model_use
        use = use if use is UNSET else msgspec.structs.replace(use, wait_s=None)
        return msgspec.structs.replace(self, wall_time_s=None, steps_per_s=None, model_use=use)


Isolation = bool | Literal["namespace"]


def outcome_of(result: RolloutResult) -> str:
    """Returns the end of an episode in a few words: "found", "not found (loop)", "5 of 7 goals found"."""
    if result.goals is not None:
        return goals_found(result.goals)
    return "found" if result.success else f"not found ({result.failure or result.end_reason})"


class EpisodeResult(RolloutResult, frozen=True, kw_only=True):
    """A line of `results.jsonl`."""

    episode_id: Name
    house: Name
    goal: Name
    agent: str
    uses_ground_truth: bool
    isolated: Isolation
    """True: the agent ran in a process of its own, as the same user; `namespace`: also without network, and without
    access to the houses, the results and other processes."""
    semantics: str
    seed: Seed
    """Seed of the run."""
    motion: MotionKind = "contacts"
    """How the robot moved, see `sim.robot.config.RobotConfig`; runs of older versions had physics."""
    person_steps: Count | UnsetType = UNSET
    """Actions that a person chose; this and the next two are set where a person drove."""
    hint_steps: Count | UnsetType = UNSET
    """Those of them for which a hint was shown."""
    other_driver: str | UnsetType | None = UNSET
    """The agent that chose the other actions; None: there were none."""

    def as_json(self) -> dict[str, object]:
        """Returns the JSON values of the line, the episode and the agent first."""
        # msgspec omits a default by identity, and a result from a worker holds another string of the same characters.
        values = msgspec.to_builtins(self) | {"motion": self.motion}
        return {name: values[name] for name in _KEYS if name in values}


_KEYS = tuple(
    dict.fromkeys(
        name
        for part in (EpisodeResult, GoalMetrics, StopTarget, RolloutResult, EpisodeMetrics)
        for name in part.__annotations__
    )
)


def _declared() -> Iterator[Metric]:
    for name, hint in get_type_hints(EpisodeMetrics, include_extras=True).items():
        for metric in getattr(hint, "__metadata__", ()):
            if isinstance(metric, Metric):
                yield replace(metric, field=name, key=metric.key or name)


METRICS: Mapping[str, Metric] = MappingProxyType({metric.key: metric for metric in _declared()})
"""The metrics by key, in the order of their fields."""


def metrics_without_episode(shortest_path_m: float | None) -> EpisodeMetrics:
    """Returns the metrics of an episode that could not be run: None where the field allows it, else 0."""
    hints = get_type_hints(GoalMetrics)
    values = {name: None if NoneType in get_args(hint) else 0 for name, hint in hints.items()}
    return msgspec.convert(values | {"shortest_path": shortest_path_m}, EpisodeMetrics)


def failed_metrics(metrics: EpisodeMetrics) -> EpisodeMetrics:
    """Returns the metrics of an episode that ended with an error: a failure, whatever it had achieved."""
    failed = {"success": 0.0, "spl": 0.0, "soft_spl": 0.0, "failure": "misc", "end_reason": "error"}
    if metrics.goals is not None:
        goals = (replace_fields(goal, **failed, goat_success=0.0, goat_spl=0.0) for goal in metrics.goals)
        scores = ("composite_success", "second_visit_success", "second_visit_spl", "goat_success", "goat_spl")
        failed |= {name: 0.0 for name in scores if getattr(metrics, name) is not None} | {"goals": tuple(goals)}
    return replace_fields(metrics, **failed)


def metrics_for(results: Iterable[EpisodeResult], *, summary: bool = False) -> list[Metric]:
    """Returns the metrics that describe some results: those of chains only where there is one.

    Args:
        results: of a run.
        summary: only those of `summary.json`.
    """
    has_chains = any(result.goals is not None for result in results)
    return [
        metric
        for metric in METRICS.values()
        if (has_chains or not metric.chains) and (metric.in_summary or not summary)
    ]
