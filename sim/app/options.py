"""The options of `stubborn run`: each field states what its option means (`sim.core.option_types.Option`)."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from sim.app import cli
from sim.core.option_types import Option, meanings
from sim.robot.config import MotionKind

HABITAT = "habitat:"
"""Beginning of the names of agents with Habitat's interface."""
PROCESS = "process:"
"""Beginning of the names of agents in a process of their own."""
STEP_TIMEOUT_S = 600.0
"""Longest time of a call of the agent if `--step-timeout` is not given."""
WORLD = Option(of_world=True)
"""Belongs to the world, in which a person may drive as well."""
_FOLDER = Option(of_world=True, published=False)
_PRESET = Option(of_world=True, plain=True)
_EPISODES = Option(of_episodes=True, plain=True)
_MORE_EPISODES = Option(of_episodes=True, plain=True, compared="between runs")
_NO_EFFECT = Option(compared="never", published=False)
_VIEWER = Option(compared="never", published=False, viewer=True)
_NOT_RECORDED = Option(recorded=False)
"""Concerns one start of the command, or is a setting; `config.json` has the tree that results from the settings."""


@dataclass(frozen=True, kw_only=True)
class RunOptions:
    """Let an agent look for objects in apartments, and write the results to a folder."""

    agent: str = "stubborn"
    """The agent: a name of --list-agents, or your own as package.module:NAME (an AgentSpec or a factory),
    habitat:package.module:CLASS (with Habitat's interface), or in another process as process:COMMAND."""
    explorer: str | None = None
    """The explorer of agents that take one: a name of --list-agents, or your own as package.module:NAME."""
    semantics: str = "rednet"
    """Source of segmentation: rednet, noisy (ground truth with the errors of a network), gt (ground truth), a server of
    detectors as http://HOST:PORT, or your own as package.module:NAME."""
    weights: Annotated[Path | None, Option(file_field="detector.weights")] = None
    """With --semantics rednet: your network in place of the shipped one."""
    verification: Annotated[str, Option(plain=True)] = "naive-bayes"
    """Method that verifies candidates: naive-bayes (the paper's) or none."""
    verifier: Annotated[Path | None, Option(file_field="verification.parameters")] = None
    """Parameters of verification (`stubborn train verifier`) in place of those shipped for this segmentation."""
    split: Annotated[str, WORLD] = "val"
    """A shipped split, or a folder laid out like one."""
    house: Annotated[Path | None, WORLD] = None
    """One MJCF file in place of a split."""
    labels: Annotated[Path | None, _FOLDER] = None
    """With --house: a JSON file {"regex over names": "category"} for a house that has other names."""
    root: Annotated[Path | None, _FOLDER] = None
    """Another folder whose files the file of --house or --robot may use, in addition to its own folder."""
    robot: Annotated[str | None, Option(of_world=True, file_field="robot.file.path")] = None
    """Replaces the default robot: an MJCF file with its sidecar next to it, or menagerie:NAME (docs/worlds.md)."""
    goal: Annotated[str | None, Option(of_world=True, of_episodes=True, plain=True)] = None
    """Only this goal category; with --house also words, such as "the red chair in the bedroom"."""
    start_deg: Annotated[str | None, Option(of_world=True, of_episodes=True, plain=True)] = None
    """With --house: the start pose "X Y YAW" in metres and degrees."""
    episodes: Annotated[cli.Count, _MORE_EPISODES] = 5
    """The first N episodes of the split; with --house, N episodes are sampled."""
    replicates: Annotated[cli.Count, _EPISODES] = 1
    """Runs of each episode: the first from its start, the others 1 cm away from it, to measure the effect of chance."""
    only: Annotated[tuple[str, ...], _MORE_EPISODES] = ()
    """IDs of the episodes of the split to run, in place of the first N: for example a failure that you want to film."""
    seed: Annotated[cli.Seed, _PRESET] = 0
    """Seed of agents, noise and, with --house, starts and goals."""
    seed_key: Annotated[str | None, Option(compared="never", of_world=True, plain=True)] = None
    """Key with which agents' seeds are computed from --seed; by default a new one for each run, kept in config.json."""
    workers: Annotated[cli.Count, _NO_EFFECT] = 1
    """Number of processes, on this machine or over the cluster."""
    executor: Annotated[str, _NO_EFFECT] = "local"
    """Executor of the episodes: local processes, or ray (extra `ray`), a cluster of machines with the same code."""
    address: Annotated[str | None, _NO_EFFECT] = None
    """With --executor ray: HOST:PORT of the cluster's head; by default the cluster that this machine belongs to."""
    shard: Annotated[str | None, _NO_EFFECT] = None
    """i/n, from 1/n to n/n: every n-th episode from the i-th on, into <out>/shard_i_of_n; see `stubborn merge`."""
    step_timeout: Annotated[cli.NotNegative | None, _NOT_RECORDED] = None
    """Longest time of a call of the agent, seconds; a longer call ends its episode as an error. By default it is 600,
    and your own code runs in a separate process. 0: no limit, and with one worker all code runs in this process."""
    profile: Annotated[str, _PRESET] = "fast"
    """Rendering quality: fast or good."""
    noise: Annotated[str, _PRESET] = "none"
    """Noise of sensors and drive: none, realsense or harsh."""
    motion: Annotated[MotionKind, _PRESET] = "contacts"
    """How the robot moves: contacts (physics), or as in Habitat without physics, where an obstacle ends a motion
    (no-sliding) or deflects it (sliding)."""
    config: Annotated[tuple[str, ...], _NOT_RECORDED] = ()
    """FIELD=VALUE ...: fields of the configuration, for example task.max_steps=300 agent.planning.dilation_m=0.1."""
    config_file: Annotated[Path | None, _NOT_RECORDED] = None
    """A TOML or JSON file of such fields; --config is applied after it."""
    out: Annotated[cli.OutFolder | None, _NO_EFFECT] = None
    """Folder of the results (runs/<time>); an existing run there is resumed."""
    record: Annotated[bool, _NO_EFFECT] = False
    """Write a compact trajectory of each episode (`sim.task.trajectory.read_trajectory`) and its last picture."""
    video: Annotated[bool, _VIEWER] = False
    """Write an MP4 of each episode to <out>/videos."""
    view: Annotated[bool, _VIEWER] = False
    """Show the episodes in MuJoCo's viewer while they run."""
    rerun: Annotated[bool, _VIEWER] = False
    """Stream poses, images, points and map to the Rerun viewer (extra `rerun`)."""
    rerun_save: Annotated[bool, _VIEWER] = False
    """Write a Rerun file of each episode to <out>/rerun (extra `rerun`)."""
    mcap: Annotated[bool, _VIEWER] = False
    """Write ROS 2 messages of each episode to an MCAP file in <out>/mcap (extra `ros`)."""
    retry_errors: Annotated[bool, _NOT_RECORDED] = False
    """Run the episodes again that ended with an error in an earlier start of this run."""
    keep_results: Annotated[bool, _NOT_RECORDED] = False
    """Resume although the code of your agent has changed, and keep the results of the earlier code."""
    list_agents: Annotated[bool, _NOT_RECORDED] = False
    """Print the agents with a description of each, and exit."""

    @property
    def watched(self) -> bool:
        """Whether there is a viewer, so that all images must be rendered."""
        return any(getattr(self, name) for name, option in meanings(RunOptions).items() if option.viewer)

    @property
    def own_code(self) -> dict[str, str]:
        """The names of the user's code that this process imports, such as `package.module:NAME`, by option."""
        names = {"agent": self.agent, "explorer": self.explorer, "semantics": self.semantics}
        return {
            option: name
            for option, name in names.items()
            if name and ":" in name and not is_process(name) and not name.startswith(("http://", "https://"))
        }

    @property
    def own_modules(self) -> list[str]:
        """The modules of the user's code."""
        return [name.removeprefix(HABITAT).partition(":")[0] for name in self.own_code.values()]

    @property
    def step_limit_s(self) -> float:
        """Longest time of a call of the agent; 0: no limit."""
        return STEP_TIMEOUT_S if self.step_timeout is None else self.step_timeout


def is_process(agent: str) -> bool:
    """Returns whether an agent with this name runs in a process of its own."""
    return agent.startswith(PROCESS)
