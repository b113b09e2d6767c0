"""The paper's display, each from one command: play what is missing, then write the table.

    python tools/reproduce.py ablation --episodes 200 --workers 2
    python tools/reproduce.py all --episodes 200 --workers 2 --minutes 110
    python tools/reproduce.py failures --minutes 0            # only the table, of what is there

Tables: failures, ablation, exploration, categories, overall, or all. Runs lie in `<out>/<agent>_<semantics>_...`, a
folder each as `sim.run --record` leaves it, and serve every table that needs them. The agents take turns, a chunk of
episodes each, so that whenever it is stopped they have the same first episodes; the same command goes on where it was.
Tables go to the terminal and to `<out>/tables/<table>.md` and `.csv`; --semantics, --agents, --noise, --split and
--seed have their place in the name where they are given. What was played by older code stays: take
another --out when an agent has changed. See docs/reproduce.md.
"""

from __future__ import annotations

import json
import sys
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import tyro
from rich.console import Console

from sim import cli, run
from sim.analysis import display
from sim.analysis.comparison import MIN_PAIRS, Line, Run, code_of, read_run
from sim.analysis.tables import ResultTable, to_markdown, to_rich, write_csv
from sim.episodes.splits import Episode
from sim.interface import ConfigError
from sim.task.failures import cause_of_failure
from sim.task.trajectory import read_trajectory, trajectory_file
from tools.paper_tables import TABLES, PaperTable, Player, table_named

SAME_IN_ALL = ("agent", "semantics", "semantics_config", "split_identity", "seed", "noise", "noise_config")
"""Entries of a run's config that must be what the table is of."""


@dataclass(frozen=True, kw_only=True)
class Args:
    """Play what a table needs and is not there yet, and write the table."""

    table: tyro.conf.Positional[str]
    """failures, ablation, exploration, categories, overall, or all."""
    episodes: int = 200
    """The first N episodes of the split."""
    workers: int = 1
    """Processes."""
    executor: str = "local"
    """Where: local processes, or ray (extra `ray`) for a cluster whose machines all see --out."""
    address: str | None = None
    """With --executor ray: HOST:PORT of the cluster's head; by default the cluster that this machine is in."""
    split: str = "val"
    """A shipped split, or a folder laid out like one."""
    out: Path = Path("runs/paper")
    """Folder for the runs and display."""
    semantics: str | None = None
    """Where segmentation comes from, in place of what the table says."""
    agents: tuple[str, ...] = ()
    """Who plays, in place of what the table says; the others are compared with the first."""
    noise: str = "none"
    """Noise of sensors and drive."""
    seed: int = 0
    """Of the runs."""
    chunk: int = 20
    """Episodes that an agent plays before it is the next one's turn."""
    minutes: float | None = None
    """Start no chunk that would not be done by then; 0 plays nothing."""


def main(args: Args) -> int:
    """Play and tell; returns the exit status."""
    _check(args)
    console = display.make_console()
    names = list(TABLES) if args.table == "all" else [args.table]
    wanted = {name: table_named(name).players(args.agents, args.semantics) for name in names}
    players = list(dict.fromkeys(player for needed in wanted.values() for player in needed))
    episodes, split = run.plan_episodes(_run_args(args, players[0]))
    play(args, players, episodes, split, console)
    runs = {player: _read(args, player, split) for player in players if _has_run(args, player)}
    status = 0
    for name, needed in wanted.items():
        common = common_episodes(runs, needed, episodes)
        if not common:
            console.print(f"{name}: no episode that {', '.join(p.label for p in needed)} have all played.")
            status = 1
            continue
        tell(args, name, table_named(name), {player: runs[player] for player in needed}, common, console)
    return status


def _read(args: Args, player: Player, split: dict[str, Any]) -> Run:
    """A player's run.

    Raises:
        ConfigError: the folder holds something else than the table is of.
    """
    read = read_run(_folder(args, player))
    wanted = json.loads(json.dumps(run.config_of(_run_args(args, player), split)))
    for key in SAME_IN_ALL:
        if read.config.get(key) != wanted.get(key):
            raise ConfigError(
                f"'{read.path}' holds a run with {key} = {json.dumps(read.config.get(key))}, the table is of "
                f"{json.dumps(wanted.get(key))}; take another --out, or the options of that run."
            )
    return read


def play(
    args: Args, players: Sequence[Player], episodes: Sequence[Episode], split: dict[str, Any], console: Console
) -> None:
    """Let the players take turns, a chunk of episodes each, until all is played or the minutes are used up.

    Raises:
        ConfigError: a folder holds a run with other options.
    """
    began_s, longest_s = time.monotonic(), 0.0
    for first in range(0, len(episodes), args.chunk):
        chunk = episodes[first : first + args.chunk]
        chunk_began_s = time.monotonic()
        if args.minutes is not None and chunk_began_s - began_s + longest_s >= 60.0 * args.minutes:
            console.print(f"The {args.minutes:g} minutes are used up before episode {first + 1}.")
            return
        for player in players:
            done = read_run(_folder(args, player)).lines if _has_run(args, player) else {}
            if first and all(episode.episode_id in done for episode in chunk):
                continue
            run.play_missing(_run_args(args, player), chunk, split, console)
        longest_s = max(longest_s, time.monotonic() - chunk_began_s)


def common_episodes(runs: dict[Player, Run], players: Sequence[Player], episodes: Sequence[Episode]) -> list[str]:
    """Ids of the episodes that all of them have played, in the split's order."""
    if any(player not in runs for player in players):
        return []
    ids = [episode.episode_id for episode in episodes]
    return [i for i in ids if all(i in runs[player].lines for player in players)]


def tell(
    args: Args, name: str, table: PaperTable, runs: dict[Player, Run], common: Sequence[str], console: Console
) -> None:
    """Build one table, show it, and write it as Markdown and CSV."""
    lines = {player: [with_cause(of, of.lines[i]) for i in common] for player, of in runs.items()}
    parts = table.build(lines, list(runs))
    notes = notes_of(args, name, runs, common)
    folder, stem = args.out / "tables", stem_of(args, name)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / f"{stem}.md").write_text(to_markdown(parts) + "\n" + "\n\n".join(notes) + "\n", encoding="utf-8")
    write_csv(folder / f"{stem}.csv", parts)
    _show(console, parts, notes)
    console.print(f"written to {folder / stem}.md and .csv\n", highlight=False)


def stem_of(args: Args, name: str) -> str:
    """Name of a table's files: the table's own, and each option that makes another table of it."""
    agents = "+".join(_file_name(agent) for agent in args.agents)
    noise = "" if args.noise == Args.noise else args.noise
    split = "" if args.split == Args.split else _split_name(args)
    return "_".join(filter(None, (name, args.semantics, agents, noise, split, _seed_name(args))))


def with_cause(of: Run, line: Line) -> Line:
    """The line with the cause of failure that today's rules find in the trajectory, where there is one."""
    file = trajectory_file(of.path, line["episode_id"])
    return {**line, "failure": cause_of_failure(read_trajectory(file))} if file.is_file() else line


def notes_of(args: Args, name: str, runs: dict[Player, Run], common: Sequence[str]) -> list[str]:
    """What must be known beside the numbers: episodes, split, errors, code, the command."""
    some = next(iter(runs.values()))
    config, split, versions = some.config, some.config["split_identity"], some.config["versions"]
    errors = sum(of.lines[i]["end_reason"] == "error" for of in runs.values() for i in common)
    codes = Counter(code_of(of, i) for of in runs.values() for i in common)
    notes = [
        f"{len(common)} episodes of {split['name']} {split['version']} ({split['sha256'][:8]}), sensor noise "
        f"{config['noise']}, seed {config['seed']}, mujoco {versions['mujoco']}; mean [95 % bootstrap interval over "
        f"episodes]. A difference is paired by episode; unresolved: its interval holds 0, or it has fewer than "
        f"{MIN_PAIRS} pairs.",
        "`" + " ".join(["python tools/reproduce.py", name, *_named_options(args)]) + "`",
    ]
    if errors:
        notes.append(f"{errors} episodes broke and count as failures.")
    if len(codes) > 1:
        told = ", ".join(f"{code} ({count})" for code, count in codes.most_common())
        notes.append(f"Not all episodes were played by the same code: {told}.")
    return notes


def _named_options(args: Args) -> list[str]:
    """What has to be said to get the same table; agents and segmentation only where they were asked for."""
    said = [f"--episodes {args.episodes}", f"--split {args.split}"]
    said += [f"--semantics {args.semantics}"] if args.semantics else []
    said += [f"--agents {' '.join(args.agents)}"] if args.agents else []
    said += [f"--noise {args.noise}"] if args.noise != "none" else []
    return said + ([f"--seed {args.seed}"] if args.seed else [])


def _show(console: Console, parts: Sequence[ResultTable], notes: Sequence[str]) -> None:
    for part in parts:
        console.print(to_rich(part))
    for note in notes:
        console.print(note, markup=False, highlight=False, soft_wrap=True)


def _run_args(args: Args, player: Player) -> run.Args:
    """The options of `sim.run` for one player."""
    return run.Args(
        agent=player.agent,
        semantics=player.semantics,
        split=args.split,
        episodes=args.episodes,
        seed=args.seed,
        workers=args.workers,
        executor=args.executor,
        address=args.address,
        noise=args.noise,
        out=_folder(args, player),
        record=True,
    )


def _folder(args: Args, player: Player) -> Path:
    parts = (_file_name(player.agent), player.semantics, args.noise, _split_name(args), _seed_name(args))
    return args.out / "_".join(filter(None, parts))


def _file_name(agent: str) -> str:
    return agent.replace(":", "_").replace("/", "_")


def _split_name(args: Args) -> str:
    return Path(args.split).resolve().name if Path(args.split).is_dir() else args.split


def _seed_name(args: Args) -> str:
    return f"seed{args.seed}" if args.seed else ""


def _has_run(args: Args, player: Player) -> bool:
    return (_folder(args, player) / "results.jsonl").is_file()


def _check(args: Args) -> None:
    if args.table != "all":
        table_named(args.table)
    for name, value, least in (("episodes", args.episodes, 1), ("workers", args.workers, 1), ("chunk", args.chunk, 1)):
        if value < least:
            raise ConfigError(f"--{name} must be at least {least}, got {value}.")
    if args.minutes is not None and not args.minutes >= 0.0:
        raise ConfigError(f"--minutes must be at least 0, got {args.minutes}.")
    names = [args.table] if args.table != "all" else list(TABLES)
    for player in {player for name in names for player in table_named(name).players(args.agents, args.semantics)}:
        run.check(_run_args(args, player))


def entry(argv: Sequence[str] | None = None) -> int:
    """The command line."""
    try:
        return cli.run(Args, main, argv)
    except KeyboardInterrupt:
        print("\nStopped. The same command goes on where it was; with --minutes 0 it only writes the table.")
        return 130


if __name__ == "__main__":
    sys.exit(entry())
