"""Watch an agent, or drive the robot, in the browser: run `stubborn web` and open the address that it prints.

On a machine without a display, forward the port: `ssh -L 8008:127.0.0.1:8008 MACHINE`, and open
http://127.0.0.1:8008 on your own machine.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from msgspec import Meta

from sim.app import cli
from sim.app.services.hosting import in_address, listen, require_web, serve
from sim.core.configuration import with_absolute_paths
from sim.core.errors import ConfigError

if TYPE_CHECKING:
    from sim.app.web.choices import Offer

FIRST_AGENT = "stubborn-plus"
"""The agent that the page proposes first."""
HERE = frozenset(("127.0.0.1", "localhost", "::1"))
"""Names by which this machine addresses itself."""
ALL_INTERFACES = frozenset(("0.0.0.0", "::"))
"""Values of --host that listen on every address of this machine."""


@dataclass(frozen=True, kw_only=True)
class Args:
    """Watch an agent, or drive the robot, in the browser."""

    port: Annotated[int, Meta(ge=0, le=65535)] = 8008
    """Port of the page; 0 takes a free one."""
    host: str = "127.0.0.1"
    """Address to listen on. Every person with access to it can see and drive the robot: there is no password."""
    name: tuple[str, ...] = ()
    """Further names or addresses under which browsers reach this machine; needed with --host 0.0.0.0."""
    agent: tuple[str, ...] = ()
    """Your agents, as package.module:NAME; the page offers them in addition to those of --list-agents."""
    explorer: tuple[str, ...] = ()
    """Your explorers, as package.module:NAME."""
    semantics: tuple[str, ...] = ()
    """Your segmentations."""
    split: tuple[str, ...] = ()
    """Further splits: folders laid out like one."""
    house: tuple[Path, ...] = ()
    """House files, in which episodes are drawn."""
    labels: Path | None = None
    """With --house: a JSON file {"regex over names": "category"} for houses that have other names."""
    root: Path | None = None
    """With --house or --robot: another folder whose files it may use, in addition to its own folder."""
    weights: Path | None = None
    """Your network in place of the shipped one, for segmentation by rednet."""
    robot: str | None = None
    """Replaces the default robot: an MJCF file with its sidecar next to it, or menagerie:NAME (docs/worlds.md)."""
    seed: cli.Seed = 0
    """Seed of agents, noise and, with --house, starts and goals."""
    profile: str = "fast"
    """Rendering quality: fast or good."""
    noise: str = "none"
    """Noise of sensors and drive: none, realsense or harsh."""
    config: tuple[str, ...] = ()
    """FIELD=VALUE ...: fields of the configuration, as for a run."""
    config_file: Path | None = None
    """A TOML or JSON file of such fields; --config is applied after it."""
    runs: Path = Path("runs")
    """Folder of the runs that the page shows; episodes that users drive are recorded there as well."""


def main(args: Args) -> int:
    """Serves the page until it is interrupted; returns the exit status."""
    require_web()
    listening = listen(args.host, args.port)  # before the imports, which take seconds
    from sim.app.web.choices import Choices
    from sim.app.web.driven import DrivenRuns
    from sim.app.web.runs import Runs
    from sim.app.web.server import MAX_MESSAGE_BYTES, Hub, make_app

    choices, folder = Choices(offer(args)), args.runs.absolute()
    port = listening.getsockname()[1]
    hosts = HERE | {name.lower() for name in (args.host, *args.name)} - ALL_INTERFACES
    app = make_app(Hub(DrivenRuns(folder)), choices, Runs(folder), hosts=hosts)
    names = sorted(hosts - HERE) or ["127.0.0.1" if args.host in ALL_INTERFACES else args.host]
    addresses = ", ".join(f"http://{in_address(name)}:{port}" for name in names)
    where = f"Open {addresses} in a browser."
    serve(app, [listening], where, ws_max_size=MAX_MESSAGE_BYTES, timeout_graceful_shutdown=1)
    return 0


def offer(args: Args) -> Offer:
    """Returns the parts that the page offers in addition to those that ship.

    Raises:
        ConfigError: an option contradicts another, or its file or name does not exist.
    """
    from sim.app.composition.setup import resolve
    from sim.app.options import RunOptions
    from sim.app.web.choices import Offer
    from sim.robot.foreign import absolute_robot

    if len({file.stem for file in args.house}) < len(args.house):
        raise ConfigError("--house: two files have the same name; give each house another one.")
    if args.labels is not None and not args.house:
        raise ConfigError("--labels needs --house.")
    if args.root is not None and not args.house and args.robot is None:
        raise ConfigError("--root needs --house or --robot: a file that may use this folder, too.")
    same = ("weights", "labels", "root", "seed", "profile", "noise", "config", "config_file")
    values = {name: getattr(args, name) for name in same}
    robot = None if args.robot is None else absolute_robot(args.robot)
    # Absolute, because agents may change the current folder.
    options = with_absolute_paths(RunOptions(agent=FIRST_AGENT, robot=robot, **values))
    root = options.root if robot is not None else None
    resolve(replace(options, config=(), config_file=None, labels=None, root=root))  # these depend on agent and house
    return Offer(
        agents=args.agent,
        explorers=args.explorer,
        semantics=args.semantics,
        splits=args.split,
        houses=tuple(file.absolute() for file in args.house),
        options=options,
    )


def entry(argv: Sequence[str] | None = None) -> int:
    """Runs the command line; returns its exit status."""
    return cli.run(Args, main, argv)
