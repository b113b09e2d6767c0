"""Agents in a process of their own: `--agent process:COMMAND` runs them in another Python, environment or container.

The agent's side is one file that users copy, `stubborn_client`, which describes the protocol. This side is an `Agent`
like any other: it sends observations and nothing else. When the process crashes, hangs or sends anything other than an
answer, the episode ends as an error with the last lines of its standard error, and the next episode starts the process
again.
"""

from __future__ import annotations

import functools
import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Literal, TypeVar

import cv2
import msgspec
import numpy as np
from msgspec import Meta
from numpy.typing import NDArray

from sim.app.bridges.habitat.config import make_config
from sim.app.bridges.habitat.conversions import Conversion
from sim.app.bridges.process_command import ProcessConfig, command_of, is_bounded
from sim.app.bridges.process_pipe import AgentProcess, Answer
from sim.app.bridges.stubborn_client import MAX_HEADER_BYTES, ProtocolError, unpack_arrays
from sim.app.evaluation.own_code import one_line
from sim.app.evaluation.rollout import ask
from sim.app.options import PROCESS
from sim.app.viewers.viewer import Colour
from sim.core.configuration import as_json
from sim.core.errors import AgentError, ConfigError
from sim.core.interface import (
    GOAL_CATEGORIES,
    MPCAT40,
    Action,
    Agent,
    AgentSpec,
    CameraModel,
    Observation,
    RobotModel,
    SuccessRule,
)
from sim.core.reading import Metres

T = TypeVar("T")
_Text = Annotated[str, Meta(max_length=MAX_HEADER_BYTES)]


class _Ready(msgspec.Struct, tag_field="type", tag="ready"):
    draws_map: bool = False
    keeps_memory: bool = False


class _Done(msgspec.Struct, tag_field="type", tag="done"):
    pass


class _Chosen(msgspec.Struct, tag_field="type", tag="action"):
    action: Annotated[int, Meta(ge=0, le=5)]
    stop_confidence: Annotated[float, Meta(ge=0.0, le=1.0)] | None = None
    stop_target_xy_m: tuple[Metres, Metres] | None = None


class _Image(msgspec.Struct):
    name: Literal["map"]
    dtype: Literal["|u1"]
    shape: tuple[Annotated[int, Meta(ge=1)], Annotated[int, Meta(ge=1)], Literal[3]]


class _Map(msgspec.Struct, tag_field="type", tag="map"):
    arrays: tuple[_Image]
    state: Annotated[str, Meta(max_length=1000)] = ""


class _Failed(msgspec.Struct, tag_field="type", tag="error"):
    error: _Text


def process_spec(name: str) -> AgentSpec:
    """Returns the specification of an agent with the name `process:COMMAND`.

    Raises:
        ConfigError: the command is empty or cannot be split into words.
    """
    command = command_of(name)
    return AgentSpec(
        make=functools.partial(ProcessAgent, command),
        description="your agent in a process of its own",
        config=ProcessConfig(),
        uses_segmentation=False,
        words=(),
        pictures=("goal_picture",),
        painter=_painter_of,
        goals=_goals,
    )


class ProcessAgent:
    """An agent whose decisions come from another process (`sim.core.interface.Agent`).

    Args:
        command: program and arguments, relative to the current folder.
        camera, robot, success, max_steps: the task, whose description is sent to the agent.
        config: the options of the agent.
        step_timeout_s: longest time of a call; 0: no limit.
        hidden: files and folders of the run that a process in namespaces does not see.

    Raises:
        ConfigError: the process cannot be started or does not answer.
    """

    def __init__(
        self,
        command: Sequence[str],
        *,
        camera: CameraModel,
        robot: RobotModel,
        success: SuccessRule,
        config: ProcessConfig,
        max_steps: int,
        step_timeout_s: float = 0.0,
        hidden: Sequence[Path] = (),
        **others: object,
    ) -> None:
        self.name = f"{PROCESS}{shlex.join(command)}"
        """The name as it is given to `--agent`."""
        self._command, self._config, self._limit_s = list(command), config, step_timeout_s or float("inf")
        self._hidden = [str(path) for path in (*hidden, *config.hidden)] if is_bounded(config) else None
        self._setup = {
            "camera": as_json(camera),
            "robot": as_json(robot),
            "success": as_json(success),
            "max_steps": max_steps,
            "looks": config.looks,
            "goals": list(GOAL_CATEGORIES),
            "labels": list(MPCAT40),
        }
        self._conversion = _conversion(camera, config)
        if self._conversion is not None:
            of_the_run = make_config(
                camera=camera, robot=robot, success=success, max_steps=max_steps, looks=config.looks
            )
            goals = list(self._conversion.goals)
            self._setup |= {"interface": config.interface, "goals": goals, "config": of_the_run}
        self._process: AgentProcess | None = None
        self._chosen = _Chosen(action=0)
        self._keeps_memory, self._seed = False, 0
        self.draws_map = False
        """Whether the agent draws a map."""
        try:
            self._start()
        except AgentError as error:
            raise ConfigError(f"Agent '{self.name}' cannot be started: {error}.") from None

    def reset(self, goal: str, seed: int) -> None:
        """Starts a new episode; if the last process has failed, in a new process.

        Raises:
            AgentError: the process failed, or the data set of an agent with Habitat's interface has no such goal.
        """
        if self._conversion is not None:
            self._conversion.goal_number(goal)
        process = self._process or self._start()
        process.new_episode()
        self._seed = seed
        self._ask({"type": "reset", "goal": goal, "seed": seed}, _Done)

    def next_goal(self, goal: str) -> None:
        """Gives the agent the next goal of a chain; an agent without a method `next_goal` is reset.

        Raises:
            AgentError: as `reset`.
        """
        if not self._keeps_memory:
            self.reset(goal, self._seed)
            return
        if self._conversion is not None:
            self._conversion.goal_number(goal)
        self._ask({"type": "next_goal", "goal": goal}, _Done)

    def act(self, observation: Observation) -> Action:
        """Returns the action that the agent chooses."""
        self._chosen = _Chosen(action=0)
        seen = observation if self._conversion is None else self._conversion.observations(observation)
        self._chosen = self._ask({"type": "act"}, _Chosen, seen)[0]
        return Action(self._chosen.action)

    def stop_confidence(self) -> float | None:
        """Returns the confidence that the agent stated with its STOP; None if it stated none."""
        return self._chosen.stop_confidence

    def stop_target_xy_m(self) -> tuple[float, float] | None:
        """Returns the place of the target that the agent stated with its STOP; None if it stated none."""
        return self._chosen.stop_target_xy_m

    def map_image(self) -> tuple[NDArray[np.uint8], str]:
        """Returns the agent's map, uint8 RGB (h, w, 3), and a few words on what the agent is doing."""
        drawn, answer = self._ask({"type": "map"}, _Map)
        described = [msgspec.to_builtins(array) for array in drawn.arrays]
        try:
            return unpack_arrays(described, answer.content)["map"], one_line(drawn.state)
        except ProtocolError as fault:
            raise self._failure(AgentError(f"its map is not valid: {fault}")) from None

    def close(self) -> None:
        """Ends the process."""
        process, self._process = self._process, None
        if process is not None:
            process.close()

    def _start(self) -> AgentProcess:
        """Starts the process and returns it."""
        process = self._process = AgentProcess(self._command, self._hidden)
        request = {"type": "start", "setup": self._setup}
        ready, _ = self._ask(request, _Ready, within_s=self._config.start_timeout_s)
        self.draws_map, self._keeps_memory = ready.draws_map, ready.keeps_memory
        return process

    def _ask(
        self,
        request: dict[str, object],
        kind: type[T],
        arrays: Observation | None = None,
        *,
        within_s: float | None = None,
    ) -> tuple[T, Answer]:
        """Returns the checked header of the answer to a request, and the whole answer.

        Raises:
            AgentError: no valid answer arrived; the process has been ended.
        """
        if self._process is None:
            raise AgentError("its process has ended")
        try:
            answer = self._process.ask(request, arrays, within_s=self._limit_s if within_s is None else within_s)
            header = answer.parsed(kind | _Failed)  # type: ignore[operator]
        except AgentError as error:
            raise self._failure(error) from None
        except BaseException:  # after Ctrl-C, the answer to this request would arrive as that to the next one
            self.close()
            raise
        if isinstance(header, _Failed):  # the agent raised an error; its process has printed the traceback
            self.close()
            raise AgentError(one_line(header.error))
        return header, answer

    def _failure(self, error: AgentError) -> AgentError:
        """Ends the process and returns the error with the last lines that the process wrote."""
        process, self._process = self._process, None
        assert process is not None
        process.close(at_once=True)
        said, reason = process.last_lines(), str(error).rstrip(".")
        return AgentError(f"{reason}; the last lines of its standard error: {said}" if said else reason)


class ProcessPainter:
    """Draws the map that the agent sends, for viewers (`sim.app.viewers.viewer.MapPainter`)."""

    legend: tuple[tuple[str, Colour], ...] = ()
    """Name and colour of each item; it is empty, because the agent's image has no known colours."""

    def __init__(self, agent: ProcessAgent) -> None:
        self._agent = agent
        self._words = ""

    def paint(self, size_px: int) -> NDArray[np.uint8]:
        """Returns the agent's image, fitted into (size_px, size_px, 3)."""
        image, self._words = ask(f"Agent '{self._agent.name}', map_image", self._agent.map_image)
        height, width = (max(1, round(side * size_px / max(image.shape[:2]))) for side in image.shape[:2])
        kind = cv2.INTER_AREA if height < image.shape[0] else cv2.INTER_NEAREST
        top, left_px = (size_px - height) // 2, (size_px - width) // 2
        paper = np.full((size_px, size_px, 3), 255, np.uint8)
        paper[top : top + height, left_px : left_px + width] = cv2.resize(image, (width, height), interpolation=kind)
        return paper

    def words(self) -> str:
        """Returns the words on what the agent is doing that came with its last image."""
        return self._words


def _conversion(camera: CameraModel, config: ProcessConfig) -> Conversion | None:
    """Returns the conversion of observations for an agent with Habitat's interface; None for one with ours."""
    if config.interface != "habitat":
        return None
    return Conversion(camera=camera, categories=config.categories, normalize_depth=config.normalize_depth)


def _goals(config: ProcessConfig) -> tuple[str, ...]:
    """Returns the goal categories that the agent knows."""
    conversion = _conversion(CameraModel(), config)
    return GOAL_CATEGORIES if conversion is None else conversion.goals


def _painter_of(agent: Agent) -> ProcessPainter | None:
    return ProcessPainter(agent) if isinstance(agent, ProcessAgent) and agent.draws_map else None
