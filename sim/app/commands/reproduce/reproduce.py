"""Reproduces the tables of the paper: runs the missing episodes, then writes the table.

    stubborn reproduce ablation --episodes 200 --workers 2
    stubborn reproduce all --episodes 200 --workers 2 --minutes 110
    stubborn reproduce failures --minutes 0            # only the table, from the existing runs
    stubborn reproduce splits --splits val large hazards --episodes 200 --workers 2

The tables of the paper are failures, ablation, exploration, categories and overall, and `controls` is its figure of
SemExp; `all` makes these six, and one page of all of them. Columns with the paper's figures follow ours, and the
paper's claims come first, each replicated, not replicated or unresolved (`paper_claims`). The table `verification`
compares the methods of verification. `splits` compares the rows of the ablation and two explorers on each of several
splits. `explorers` compares all explorers, also by the median time to first sight, and the learned ones with their
controls. `motions` compares agents with contacts and with the two kinematic motions of Habitat.

Each run has a folder `<out>/<agent>_<semantics>_...`, as `stubborn run --record` writes it; the tables share the runs.
The agents take turns: each runs a chunk of episodes of every split. All agents have therefore run the same first
episodes when the command is stopped; the same command resumes. Tables are printed and written to `<out>/tables`; the
options --semantics, --agents, --noise, --split and --seed become part of the name if they are given. With `--minutes 0`
no episode is run, and runs of older code are accepted if they have the same agent, segmentation, split, seed and noise.
See docs/running.md.
"""

from __future__ import annotations

import shlex
import zlib
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import tyro
from msgspec import structs
from rich.console import Console

from sim.app import cli
from sim.app.analysis import display
from sim.app.analysis.comparison import Run, code_of, read_run
from sim.app.analysis.tables import SIGNIFICANCE, ResultTable, to_csv, to_markdown, to_rich, with_corrections
from sim.app.commands.reproduce.paper_claims import judged
from sim.app.commands.reproduce.paper_figures import beside_paper
from sim.app.commands.reproduce.paper_tables import PAPER_TABLES, table_named
from sim.app.commands.reproduce.runs import MAX_NAME, AgentSetup, RunKey, TableRun, folder_name, key_of, run_in_turns
from sim.app.composition.setup import RunConfig, resolve
from sim.app.evaluation.config_fields import differing_fields, field_text
from sim.app.evaluation.intervals import MIN_PAIRS
from sim.app.evaluation.results import own_weights
from sim.app.options import RunOptions
from sim.core.errors import ConfigError
from sim.core.files import file_name, write_atomically, write_together
from sim.core.option_types import meanings
from sim.core.vocabulary import counted
from sim.episodes.episode import Episode
from sim.episodes.splits import Split, load_split
from sim.task.failures import cause_of_failure
from sim.task.result import EpisodeResult
from sim.task.trajectory import read_trajectory, trajectory_file

SAME_IN_ALL = ("profile", "robot")
"""Entries of config.json in which the runs of a table must be equal, if both have them."""


@dataclass(frozen=True, kw_only=True)
class Args:
    """Run the missing episodes of a table, and write the table."""

    table: tyro.conf.Positional[str]
    """failures, ablation, exploration, controls, categories, overall, verification, splits, explorers, motions, or all
    (the first six, the paper's)."""
    episodes: cli.Count = 200
    """The first N episodes of each split."""
    workers: cli.Count = 1
    """Number of processes."""
    step_timeout: cli.NotNegative | None = None
    """Longest time of a call of an agent, seconds, as in `stubborn run`; 0 runs your own code in this process."""
    executor: str = "local"
    """Executor: local processes, or ray (extra `ray`) for a cluster whose machines can all access --out."""
    address: str | None = None
    """With --executor ray: HOST:PORT of the cluster's head; by default the cluster that this machine belongs to."""
    split: str = "val"
    """A shipped split, or a folder laid out like one."""
    splits: tuple[str, ...] = ()
    """Several of them, in place of --split; each has tables of its own, and one page has all of them."""
    out: cli.OutFolder = Path("runs/paper")
    """Folder for the runs and tables."""
    semantics: str | None = None
    """Source of segmentation, in place of the default of the table."""
    agents: tuple[str, ...] = ()
    """Agents, in place of the default of the table; the others are compared with the first. With options as
    "AGENT [--semantics SOURCE] [--explorer NAME] [--verification METHOD] [--motion KIND]
    [--config FIELD=VALUE ...]"."""
    noise: str = "none"
    """Noise of sensors and drive."""
    seed: cli.Seed = 0
    """Seed of the runs."""
    chunk: cli.Count | None = None
    """Number of episodes that an agent runs before the next agent's turn; by default 20, with several splits 60."""
    minutes: cli.NotNegative | None = None
    """Time limit: a chunk that would end later is not started. 0 makes the tables from the existing runs only."""


def main(args: Args) -> int:
    """Runs episodes and writes tables; returns the exit status."""
    _check(args)
    console = display.make_console()
    names = _table_names(args)
    needed = {name: table_named(name).setups(args.agents, args.semantics) for name in names}
    setups = list(dict.fromkeys(setup for of_table in needed.values() for setup in of_table))
    splits = [part_of(of_split) for of_split in _each_split(args)]
    if args.minutes != 0.0:
        runs = [TableRun(_run_args(p.args, setup), p.split, p.episodes) for p in splits for setup in setups]
        run_in_turns(runs, args.chunk or (60 if len(args.splits) > 1 else 20), args.minutes, console)
    status = 0
    pages: dict[str, list[str]] = {name: [] for name in names}
    for of_split in splits:
        made = {name: make_table(of_split, name, of_table, console) for name, of_table in needed.items()}
        status |= None in made.values()
        for name, page in made.items():
            pages[name] += [f"## {of_split.split.name}\n\n{page}"] if page is not None else []
        if len(names) > 1:
            _write_all(of_split.args, [page for page in made.values() if page is not None], console)
    if len(splits) > 1:
        _write_pages(args, [split.args for split in splits], pages, console)
    return status


@dataclass(frozen=True)
class SplitEpisodes:
    """The episodes of one of the splits of a command."""

    args: Args
    """The options, with this split alone."""
    split: Split
    episodes: Sequence[Episode]


def make_table(part: SplitEpisodes, name: str, setups: Sequence[AgentSetup], console: Console) -> str | None:
    """Writes a table of one split; returns its page, None where the setups share no episode.

    Raises:
        ConfigError: the runs differ in conditions that must be equal.
    """
    runs, common = shared_runs(part, setups)
    if not common:
        console.print(f"{name}: no episode that {', '.join(setup.label for setup in setups)} have all run.")
        return None
    require_same_conditions(list(runs.values()))
    return write_table(part.args, name, runs, common, console)


def shared_runs(part: SplitEpisodes, setups: Sequence[AgentSetup]) -> tuple[dict[AgentSetup, Run], list[str]]:
    """Returns the existing runs of some setups, and the ids of the episodes that all setups have run."""
    args = part.args
    runs = {s: _read(args, s, part.split) for s in setups if (_folder(args, s) / "results.jsonl").is_file()}
    return runs, common_episodes(runs, setups, part.episodes)


def lines_of(runs: Mapping[AgentSetup, Run], common: Sequence[str]) -> dict[AgentSetup, list[EpisodeResult]]:
    """Returns the results of some episodes of each run, with the causes of failure by the current rules."""
    return {setup: [with_cause(of, of.results[i]) for i in common] for setup, of in runs.items()}


def common_episodes(
    runs: Mapping[AgentSetup, Run], setups: Sequence[AgentSetup], episodes: Sequence[Episode]
) -> list[str]:
    """Returns the ids of the episodes that all setups have run, in the order of the split."""
    if any(setup not in runs for setup in setups):
        return []
    ids = [episode.episode_id for episode in episodes]
    return [i for i in ids if all(i in runs[setup].results for setup in setups)]


def require_same_conditions(runs: Sequence[Run]) -> None:
    """Raises ConfigError if two runs differ in robot, camera, rendering, noise, task or the shipped network."""
    for other in runs[1:]:
        for path, first, second in differing_fields(_conditions(runs[0], other), _conditions(other, runs[0])):
            raise ConfigError(
                f"'{other.path}' holds a run with {path} = {field_text(second)}, '{runs[0].path}' one with "
                f"{field_text(first)}; one table needs the same conditions."
            )
    shipped = {run.config.get("files_sha256", {}).get("weights"): run for run in runs if not own_weights(run.config)}
    shipped.pop(None, None)  # runs without a network
    if len(shipped) > 1:  # commits ship different ones
        one, another = list(shipped.values())[:2]
        raise ConfigError(f"'{one.path}' and '{another.path}' are of two versions of the shipped network.")


def _conditions(of: Run, other: Run) -> Mapping[str, object]:
    """Returns the entries of a run's config that must be equal in all runs, if the other run has them too."""
    flat = {key: of.config[key] for key in SAME_IN_ALL if key in of.config and key in other.config}
    tree, others = of.config.get("config", {}), other.config.get("config", {})
    of_world = [name for name, option in meanings(RunConfig).items() if option.of_world]
    world = {key: tree[key] for key in of_world if key in tree and key in others}
    if isinstance(robot := world.get("robot"), Mapping):  # the kind of motion is part of a row's name
        world["robot"] = {key: value for key, value in robot.items() if key != "motion"}
    return flat | {"config": world}


def write_table(args: Args, name: str, runs: Mapping[AgentSetup, Run], common: Sequence[str], console: Console) -> str:
    """Builds one table, prints it, and writes it as Markdown and CSV; returns the Markdown."""
    lines = lines_of(runs, common)
    parts = [with_corrections(part) for part in table_named(name).build(lines, list(runs))]
    if not args.agents:
        parts[0] = beside_paper(name, parts[0])
        claims = judged(name, lines)
        parts = parts if claims is None else [claims.table(name), *parts]
    notes = notes_of(args, name, runs, common)
    folder, stem = args.out / "tables", stem_of(args, name)
    page = to_markdown(parts) + "\n" + "\n\n".join(notes) + "\n"
    write_together({folder / f"{stem}.md": page, folder / f"{stem}.csv": to_csv(parts)})
    _print(console, parts, notes)
    console.print(f"written to {folder / stem}.md and .csv\n")
    return page


def _write_all(args: Args, pages: Sequence[str], console: Console) -> None:
    """Writes the tables of one split on one page."""
    if pages:
        file = args.out / "tables" / f"{stem_of(args, args.table)}.md"
        write_atomically(file, "\n".join(pages))
        console.print(f"{counted(len(pages), 'table')} on {file}")


def _write_pages(args: Args, of_splits: Sequence[Args], pages: Mapping[str, Sequence[str]], console: Console) -> None:
    """Writes for each table one page with all splits that have it."""
    for name, parts in pages.items():
        stem = "_".join((stem_of(replace(args, split=Args.split), name), "+".join(map(_split_name, of_splits))))
        if parts:
            write_atomically(args.out / "tables" / f"{stem}.md", "\n".join(parts))
            console.print(f"{len(parts)} splits on {args.out / 'tables' / stem}.md")


def stem_of(args: Args, name: str) -> str:
    """Returns the name of a table's files: the name of the table, and each option that changes the table."""
    agents = "+".join(file_name(agent).replace(" --", "-").replace(" ", "-") for agent in args.agents)
    if len(agents) > MAX_NAME:
        agents = f"{len(args.agents)}-agents-{zlib.crc32(agents.encode()):08x}"
    noise = "" if args.noise == Args.noise else args.noise
    split = "" if args.split == Args.split else _split_name(args)
    seed = f"seed{args.seed}" if args.seed else ""
    return "_".join(filter(None, (name, file_name(args.semantics or ""), agents, noise, split, seed)))


def with_cause(of: Run, result: EpisodeResult) -> EpisodeResult:
    """Returns the result with the cause of failure by the current rules, if the episode has a trajectory."""
    file = trajectory_file(of.path, result.episode_id)
    return structs.replace(result, failure=cause_of_failure(read_trajectory(file))) if file.is_file() else result


def notes_of(args: Args, name: str, runs: Mapping[AgentSetup, Run], common: Sequence[str]) -> list[str]:
    """Returns the notes of a table: episodes, split, how intervals are made, the command, errors and code."""
    some = next(iter(runs.values()))
    config, split, versions = some.config, some.recorded("split_identity"), some.config.get("versions", {})
    houses = len({some.results[i].house for i in common})
    errors = sum(of.results[i].is_error for of in runs.values() for i in common)
    codes = Counter(code_of(of, i) for of in runs.values() for i in common)
    notes = [
        f"{counted(len(common), 'episode')} in {counted(houses, 'house')} of "
        f"{split['name']} {split['version']} ({split['sha256'][:8]}), "
        f"sensor noise {config.get('noise', RunOptions.noise)}, seed {config.get('seed', RunOptions.seed)}, "
        f"mujoco {versions.get('mujoco', 'unknown')}.",
        "Mean [95 % interval over houses]. Differences are paired by episode; not significant: the p-value is at least "
        f"{SIGNIFICANCE} after Holm's correction for the differences of the same table, or there are fewer than "
        f"{MIN_PAIRS} pairs. Intervals are not corrected.",
        "`" + " ".join(["stubborn reproduce", name, *_named_options(args)]) + "`",
    ]
    spent_s = sum(of.results[i].wall_time_s or 0.0 for of in runs.values() for i in common)
    if spent_s:
        notes.append(f"One process needed {spent_s / 3600.0:.1f} h for the {len(runs) * len(common)} episodes.")
    if errors:
        notes.append(f"{errors} episodes ended with an error and count as failures.")
    if len(codes) > 1:
        named = ", ".join(f"{code} ({count})" for code, count in codes.most_common())
        notes.append(f"Not all episodes were run by the same code: {named}.")
    return notes


def _named_options(args: Args) -> list[str]:
    """Returns the options that make the same table; agents and segmentation only if they were given."""
    named = [f"--episodes {args.episodes}", f"--split {args.split}"]
    named += [f"--semantics {args.semantics}"] if args.semantics else []
    named += [f"--agents {shlex.join(args.agents)}"] if args.agents else []
    named += [f"--noise {args.noise}"] if args.noise != "none" else []
    return named + ([f"--seed {args.seed}"] if args.seed else [])


def _print(console: Console, parts: Sequence[ResultTable], notes: Sequence[str]) -> None:
    for part in parts:
        console.print(to_rich(part))
    for note in notes:
        console.print(note, soft_wrap=True)


def _run_args(args: Args, setup: AgentSetup) -> RunOptions:
    """Returns the options of `stubborn run` for one setup."""
    return replace(
        setup.run_options(), split=args.split, episodes=args.episodes, seed=args.seed, workers=args.workers,
        executor=args.executor, address=args.address, step_timeout=args.step_timeout, noise=args.noise,
        out=_folder(args, setup), record=True,
    )  # fmt: skip


def _folder(args: Args, setup: AgentSetup) -> Path:
    return args.out / folder_name(setup, _split_name(args), args.noise, args.seed)


def _split_name(args: Args) -> str:
    return Path(args.split).resolve().name if Path(args.split).is_dir() else args.split


def _read(args: Args, setup: AgentSetup, split: Split) -> Run:
    """Returns the run of a setup.

    Raises:
        ConfigError: the folder holds a run with another agent, segmentation, split, seed or noise.
    """
    run = read_run(_folder(args, setup))
    needed = AgentSetup.named(setup.name, setup.semantics, noise=args.noise, seed=args.seed)
    recorded = _key_text(key_of(run), str(run.recorded("split_identity")["sha256"]))
    expected = _key_text(RunKey(split.name, needed, split.version), split.sha256)
    if recorded != expected:
        raise ConfigError(
            f"'{run.path}' holds a run of {recorded}, the table needs {expected}; "
            "choose another --out, or the options of that run."
        )
    return run


def _key_text(key: RunKey, sha256: str) -> str:
    return f"{key.setup.name} --semantics {key.setup.semantics} on {key.split} {key.version} ({sha256[:8]})"


def _table_names(args: Args) -> list[str]:
    return list(PAPER_TABLES) if args.table == "all" else [args.table]


def _each_split(args: Args) -> list[Args]:
    """Returns the options for each of the splits alone."""
    return [replace(args, split=name, splits=()) for name in args.splits or (args.split,)]


def part_of(args: Args) -> SplitEpisodes:
    """Returns the first episodes of the split of the options; raises ConfigError if it has too few."""
    split = load_split(args.split)
    if args.episodes > len(split.episodes):
        raise ConfigError(f"--episodes {args.episodes}: split '{split.name}' has {len(split.episodes)} episodes.")
    return SplitEpisodes(args, split, split.episodes[: args.episodes])


def _check(args: Args) -> None:
    """Raises ConfigError if an option is not allowed."""
    if args.table != "all":
        table_named(args.table)
    if args.minutes == 0.0:
        return
    setups = {s for name in _table_names(args) for s in table_named(name).setups(args.agents, args.semantics)}
    for of_split in _each_split(args):
        for setup in setups:
            resolve(_run_args(of_split, setup))
