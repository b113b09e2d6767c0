"""`stubborn`: one command with sub-commands. The module of a sub-command is imported only when it runs."""

from __future__ import annotations

import difflib
import importlib
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from sim.core.invocation import RUN_STOPPED, command, running


@dataclass(frozen=True)
class Command:
    """A sub-command: a module with the options `Args` and the function `main`."""

    module: str
    summary: str
    """One line of the list of commands."""
    stopped: str = "Stopped."
    """The message that is printed after Ctrl-C or SIGTERM."""
    takes_words: bool = False
    """True: words that begin with no dash may follow it, although it is also the name of a group."""


COMMANDS: Mapping[str, Command] = {
    "run": Command("sim.app.commands.run", "Run episodes of an agent", stopped=RUN_STOPPED),
    "report": Command("sim.app.commands.report", "Write the report of one or several runs as an HTML page"),
    "compare": Command("sim.app.commands.compare", "Compare two runs of the same episodes in a table"),
    "merge": Command("sim.app.commands.merge", "Merge the shards of a run into one run"),
    "submit": Command("sim.app.commands.submit", "Pack a recorded run into one file that anybody can check"),
    "verify": Command("sim.app.commands.verify", "Replay the actions of a submission and check its results"),
    "leaderboard": Command("sim.app.commands.leaderboard", "Write the table of the verified submissions in a folder"),
    "seal announce": Command("sim.app.commands.seal.announce", "Announce a sealed split before its seed exists"),
    "seal make": Command("sim.app.commands.seal.make", "Make a sealed split from a secret or an announcement"),
    "seal publish": Command("sim.app.commands.seal.publish", "Write the hash of a split, to be published"),
    "seal reveal": Command("sim.app.commands.seal.reveal", "Check a revealed split against its published hash"),
    "habitat": Command(
        "sim.app.commands.habitat.script", "Run a script for Habitat with habitat-lab", takes_words=True
    ),
    "habitat setup": Command("sim.app.commands.habitat.setup", "Make an environment with habitat-lab"),
    "habitat dataset": Command("sim.app.commands.habitat.dataset", "Write a split as Habitat's ObjectNav files"),
    "ros": Command(
        "sim.app.commands.ros.robot", "Run a robot as a node of ROS 2, which other nodes drive", stopped=RUN_STOPPED
    ),
    "ros agent": Command("sim.app.commands.ros.agent", "Run an agent as a node of ROS 2, which drives a robot"),
    "ros setup": Command("sim.app.commands.ros.setup", "Make an environment with the wheels of ROS 2"),
    "web": Command("sim.app.commands.web", "Watch an agent, or drive the robot, in the browser"),
    "serve detectors": Command(
        "sim.app.commands.serve.detectors", "Serve detectors in the forms of VLFM's model servers"
    ),
    "export lerobot": Command("sim.app.commands.export.lerobot", "Write a recorded run as a LeRobot dataset"),
    "gallery": Command("sim.app.commands.gallery", "Render pictures of houses and sheets of furniture"),
    "houses generate": Command("sim.app.commands.houses.generate", "Generate houses"),
    "houses check": Command("sim.app.commands.houses.check", "Check houses for faults"),
    "houses plans": Command("sim.app.commands.houses.plans", "Write the plans of houses for the 2-D environment"),
    "episodes": Command("sim.app.commands.episodes", "Generate the episodes of a split"),
    "words": Command("sim.app.commands.words", "Write a split of episodes with goals in words"),
    "traps": Command("sim.app.commands.traps.make", "Make traps of a family"),
    "traps report": Command("sim.app.commands.traps.report", "Report which agent escapes from which trap"),
    "label": Command("sim.app.commands.label", "Propose and check label rules for a scene from elsewhere"),
    "import furniture": Command(
        "sim.app.commands.importing.furniture", "Import models of furniture for generated houses"
    ),
    "import furniture infinigen": Command(
        "sim.app.commands.importing.infinigen", "Make furniture with an installed Infinigen"
    ),
    "import procthor": Command("sim.app.commands.importing.procthor", "Import houses of ProcTHOR"),
    "import molmospaces": Command("sim.app.commands.importing.molmospaces", "Import houses of MolmoSpaces"),
    "import robocasa": Command("sim.app.commands.importing.robocasa", "Import kitchens of RoboCasa and others in MJCF"),
    "import mesh": Command("sim.app.commands.importing.mesh", "Import a home that is one GLB, OBJ or PLY file"),
    "import habitat": Command("sim.app.commands.importing.habitat", "Import houses of Habitat's data sets"),
    "views": Command("sim.app.commands.views.generate", "Generate labelled views for training segmentation"),
    "views mix": Command("sim.app.commands.views.mix", "Generate the views that the segmentation is trained on"),
    "views show": Command("sim.app.commands.views.show", "Draw a sheet of views"),
    "views unpack": Command("sim.app.commands.views.unpack", "Unpack views into PNG files"),
    "train segmentation": Command("sim.app.commands.train.segmentation", "Train a segmentation network on views"),
    "train verifier": Command("sim.app.commands.train.verifier", "Fit the verifier of a segmentation"),
    "train fusion": Command("sim.app.commands.train.fusion", "Fit the fusion of views to a segmentation"),
    "train names": Command(
        "sim.training.segmentation.naming", "Train a network's head for the everyday names of objects"
    ),
    "train context": Command("sim.app.commands.train.context", "Fit which objects are near objects of each category"),
    "train semexp": Command("sim.app.commands.train.semexp", "Train the explorer `semexp` in plans"),
    "train poni": Command("sim.training.poni.trainer", "Train the explorer `poni` on plans"),
    "train cloned": Command("sim.training.cloned.trainer", "Train the agent `cloned` on demonstrations"),
    "evaluate": Command("sim.app.commands.evaluate.segmentation", "Evaluate a segmentation network on views"),
    "evaluate mistakes": Command("sim.app.commands.evaluate.mistakes", "Show what the network saw in failed episodes"),
    "evaluate objects": Command("sim.app.commands.evaluate.objects", "Draw the objects that a network misses"),
    "reproduce": Command(
        "sim.app.commands.reproduce.reproduce",
        "Run and write the tables of the paper",
        stopped="Stopped. The same command resumes; with --minutes 0 it only writes the table.",
    ),
    "agent-client": Command(
        "sim.app.commands.agent_client", "Write the client file for agents in a process of their own"
    ),
    "bench": Command("sim.app.commands.bench", "Measure the speed of camera and agent"),
}
"""Every sub-command, by the words that the user types. A group such as `views` may be a command itself."""
REPLACED: Mapping[str, str] = {"teleop": "web"}
"""Removed sub-commands, and those that do their work now; 0.4.0 no longer names them."""


def entry(argv: Sequence[str] | None = None) -> int:
    """Runs the command line of `stubborn`; returns its exit status."""
    if argv is None:
        status = entry(sys.argv[1:])
        cli = sys.modules.get("sim.app.cli")  # a list of commands needs no parser of options, and starts no thread
        return status if cli is None else cli.leave_soon(status)
    words = list(argv)
    name, rest = split(words)
    is_word = bool(rest) and not rest[0].startswith("-")
    if name in COMMANDS and not (name in _groups() and is_word and not COMMANDS[name].takes_words):
        return _run(name, rest)
    if words[:1] == ["help"]:
        return entry([*words[1:], "--help"])
    if not words or words[0] in ("-h", "--help"):
        print(_text_of_list())
        return 0
    if words == ["--version"]:
        import importlib.metadata

        print(importlib.metadata.version("stubborn-objectnav"))
        return 0
    if name and (not rest or rest[0] in ("-h", "--help")):
        print(_text_of_list(group=name))
        return 0
    return _unknown(f"{name} {rest[0]}" if name else words[0], group=name)


def split(words: Sequence[str]) -> tuple[str, list[str]]:
    """Returns the longest known sub-command or group at the start of a command line, and the words after it."""
    for length in (3, 2, 1):
        name = " ".join(words[:length])
        if len(words) >= length and (name in COMMANDS or name in _groups()):
            return name, list(words[length:])
    return "", list(words)


def _run(name: str, words: Sequence[str]) -> int:
    """Runs a sub-command; returns its exit status."""
    from sim.app import cli  # the parser of options, which the list does not need

    chosen = COMMANDS[name]
    module = importlib.import_module(chosen.module)
    with running(name):
        return cli.run(module.Args, module.main, words, stopped=chosen.stopped)


def _groups() -> set[str]:
    """Returns the first words of the sub-commands that have more than one."""
    return {name.split()[0] for name in COMMANDS if " " in name}


def _text_of_list(group: str | None = None) -> str:
    """Returns the list of all sub-commands, or of those of a group."""
    listed = {name: command for name, command in COMMANDS.items() if group is None or name.split()[0] == group}
    width = max(map(len, listed))
    start = command()
    head = f"usage: {start} {group or 'COMMAND'} ..."
    rows = [f"  {name:<{width}}  {command.summary}." for name, command in listed.items()]
    example = f"{start} {next(iter(listed))}"
    return "\n".join([head, "", *rows, "", f"`{example} --help` lists the options of a command."])


def _unknown(typed: str, group: str) -> int:
    """Prints that there is no such command, with the most similar name; returns the exit status."""
    from sim.core.reading import printable

    if typed in REPLACED:
        print(f"error: The command '{typed}' is now `{command(*REPLACED[typed].split())}`.", file=sys.stderr)
        return 2
    known = [*COMMANDS, *_groups()]
    if group:
        known = [name for name in known if name.startswith(f"{group} ")]
    similar = difflib.get_close_matches(typed, known, n=1, cutoff=0.4)
    hint = f" Did you mean '{similar[0]}'?" if similar else ""
    print(f"error: There is no command '{printable(typed)}'.{hint} `{command()}` lists all commands.", file=sys.stderr)
    return 2


if __name__ == "__main__":
    sys.exit(entry())
