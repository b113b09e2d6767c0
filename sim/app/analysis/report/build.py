"""Builds the page of one run, or of several runs of the same episodes, from their files; no episode is run again."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from importlib.metadata import version
from importlib.resources import files
from pathlib import Path

from jinja2 import Environment, StrictUndefined, Template
from markupsafe import Markup

from sim.app.analysis.comparison import LETTERS, Run, differences_table, require_same_episodes
from sim.app.analysis.metrics import replicate_note
from sim.app.analysis.report import distributions
from sim.app.analysis.report.drawings import Drawings, Trajectories, draw_episodes, read_trajectories
from sim.app.analysis.report.episodes import Row, by_number, columns_of, facts_of_line, outcome_choices, row_of
from sim.app.analysis.report.facts import facts_of
from sim.app.analysis.report.figures import Group, Runs, causes, grouped, groups, interval_note, means
from sim.app.analysis.report.media import link_to, picture_of, thumbnail, video_of
from sim.app.analysis.report.trend import trend
from sim.app.evaluation.intervals import MIN_PAIRS
from sim.core.errors import ConfigError
from sim.core.vocabulary import plain
from sim.task.explanations import explain

MAX_RUNS = len(LETTERS)


def build_page(runs: Sequence[Run], *, out_folder: Path, command: str) -> str:
    """Returns the HTML of the report.

    Args:
        runs: one run, or up to `MAX_RUNS` runs of the same episodes; differences are from the first one.
        out_folder: folder of the page; links to pictures and videos are relative to it.
        command: the command that made the page, for its footer.

    Raises:
        ConfigError: no episode has ended yet, the runs are not of the same episodes, or there are too many.
    """
    if not 1 <= len(runs) <= MAX_RUNS:
        raise ConfigError(f"A report shows 1 to {MAX_RUNS} runs, got {len(runs)}.")
    for run in runs:
        if not run.results:
            raise ConfigError(f"'{run.path}' has no result yet: its first episode has not ended.")
    episode_ids = sorted(require_same_episodes(*runs), key=by_number)
    lines = [[run.results[i] for i in episode_ids] for run in runs]
    labels = list(LETTERS[: len(runs)]) if len(runs) > 1 else [""]
    trajectories, unreadable = read_trajectories(runs, episode_ids)
    drawings, undrawn = draw_episodes(runs, trajectories)
    rows = [row_of(i, of) for i, of in zip(episode_ids, zip(*lines, strict=True), strict=True)]
    episodes, broken = _episodes(runs, rows, trajectories, drawings, out_folder)
    return _template().render(
        title=_title(runs),
        several=len(runs) > 1,
        runs=[facts_of(run, label, trajectories, i) for i, (run, label) in enumerate(zip(runs, labels, strict=True))],
        notes=[*_replicate_notes(lines, labels), *unreadable, *undrawn, *broken],
        count=len(episode_ids),
        interval_note=interval_note(lines),
        fields=differences_table(*runs) if len(runs) > 1 else None,
        errors=list(_errors(lines, labels)),
        columns=columns_of(len(runs)),
        outcomes=outcome_choices(rows),
        rows=rows,
        data=_data(labels, drawings, episodes),
        min_pairs=MIN_PAIRS,
        made_by=command,
        version=version("stubborn-objectnav"),
        **_figures(lines, labels, drawings.house_m2),
    )


def _figures(lines: Runs, labels: Sequence[str], house_m2: Mapping[str, float | None]) -> dict[str, object]:
    """Returns the tables and charts of a page."""
    return {
        "means": means(lines),
        "trend": trend(lines, labels),
        "by_goal": groups(lines, "goal"),
        "by_house": groups(lines, "house"),
        "by_distance": _by_distance(lines),
        "by_size": _by_size(lines, house_m2),
        "causes": causes(lines),
        "spl": distributions.spl_histogram(lines),
        "first_sight": distributions.first_sight_histogram(lines),
        "calibrations": [distributions.calibration(of_run) for of_run in lines],
    }


def _by_distance(lines: Runs) -> list[Group]:
    bins = distributions.DISTANCES
    return grouped(lines, [bins.name(result.shortest_path) for result in lines[0]], bins.names)


def _by_size(lines: Runs, house_m2: Mapping[str, float | None]) -> list[Group]:
    bins = distributions.HOUSE_SIZES
    return grouped(lines, [bins.name(house_m2.get(result.house)) for result in lines[0]], bins.names)


def _template() -> Template:
    """Returns the template; it escapes all values and writes JSON without spaces."""
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True)
    environment.filters["plain"] = plain
    environment.globals |= {"css": Markup(_part("report.css")), "js": Markup(_part("report.js"))}
    environment.policies["json.dumps_kwargs"] = {
        "separators": (",", ":"),
        "ensure_ascii": False,
        "allow_nan": False,
    }
    return environment.from_string(_part("report.html.j2"))


def _part(name: str) -> str:
    return (files("sim.app.analysis.report") / "page" / name).read_text(encoding="utf-8")


def _title(runs: Sequence[Run]) -> str:
    names = list(dict.fromkeys(str(run.config.get("agent", "an agent")) for run in runs))
    split = (runs[0].config.get("split_identity") or {}).get("name", "unknown houses")
    if len(runs) == 2:
        return f"{' against '.join(str(run.config.get('agent', 'an agent')) for run in runs)} on {split}"
    return f"{', '.join(names)} on {split}" + (f", {len(runs)} runs" if len(runs) > 1 else "")


def _replicate_notes(lines: Runs, labels: Sequence[str]) -> list[str]:
    notes = [(label, replicate_note(of_run)) for label, of_run in zip(labels, lines, strict=True)]
    return [f"{label}: {note}".removeprefix(": ") for label, note in notes if note]


def _errors(lines: Runs, labels: Sequence[str]) -> Iterable[tuple[str, str, str]]:
    for label, of_run in zip(labels, lines, strict=True):
        for result in of_run:
            if result.is_error:
                yield label, result.episode_id, result.error or "no reason was recorded"


def _data(labels: Sequence[str], drawings: Drawings, episodes: Sequence[Mapping[str, object]]) -> dict[str, object]:
    """Returns what the script of the page reads."""
    return {
        "runs": labels,
        "plans": drawings.plans,
        "areas": drawings.areas,
        "episodes": episodes,
        "why_no_picture": "There is no trajectory of this episode, so there is no plan with its path.",
    }


def _episodes(
    runs: Sequence[Run], rows: Sequence[Row], trajectories: Trajectories, drawings: Drawings, out_folder: Path
) -> tuple[list[dict[str, object]], list[str]]:
    """Returns the data of each episode, and sentences about pictures that cannot be read."""
    problems: list[str] = []
    episodes = []
    for row in rows:
        lines = [run.results[row.episode_id] for run in runs]
        paths = trajectories[row.episode_id]
        thumbs = [_thumbnail(run, row.episode_id, problems) for run in runs]
        episode = {
            "id": row.episode_id,
            "outcomes": row.outcomes,
            "words": [explain(line, path) for line, path in zip(lines, paths, strict=True)],
            "facts": [facts_of_line(line) for line in lines],
            "thumbs": thumbs,
            "pictures": [link_to(picture_of(run, row.episode_id), out_folder) for run in runs],
            "videos": [link_to(video_of(run, row.episode_id), out_folder) for run in runs],
        }
        episodes.append(episode | drawings.episodes.get(row.episode_id, {"goal": row.goal}))
    return episodes, problems


def _thumbnail(run: Run, episode_id: str, problems: list[str]) -> str | None:
    """Returns the thumbnail of an episode, None without a picture; adds a sentence if the file is not a picture."""
    file = picture_of(run, episode_id)
    try:
        return None if file is None else thumbnail(file)
    except ConfigError as error:
        problems.append(str(error))
        return None
