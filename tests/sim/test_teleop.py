"""Driving by hand: keys become actions, actions become a record, pictures become characters."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import termios
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from sim import teleop
from sim.composition import human
from sim.env.objectnav import ObjectNavEnv
from sim.episodes.splits import Episode, write_split
from sim.evaluation.rollout import play_episode
from sim.geometry.pose import Pose
from sim.interface import Action, CameraModel, ConfigError
from sim.task.trajectory import read_trajectory, trajectory_file
from sim.viewers.terminal import HALF_BLOCK, Colours, Terminal, fitted, half_blocks
from tests.helpers.worlds import sofa_room

START = Pose(0.0, 0.0, 0.0)
STYLE = re.compile(r"\x1b\[[0-9;]*m")


class Script:
    """A `teleop.Cockpit` whose keys are known beforehand."""

    colours: Colours = "true"

    def __init__(self, keys: Sequence[str], size: tuple[int, int] = (80, 24)) -> None:
        self.keys, self.size = list(keys), size
        self.screens: list[list[str]] = []

    def show(self, lines: Sequence[str]) -> None:
        self.screens.append([STYLE.sub("", line) for line in lines])

    def key(self) -> str:
        return self.keys.pop(0) if self.keys else "q"


@pytest.fixture(scope="module")
def split(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("tiny")
    furnished = sofa_room()
    (folder / "sofa_room.xml").write_text(furnished.spec.to_xml())
    write_split(
        folder, [Episode(f"e{i}", "sofa_room", "sofa", START) for i in range(2)], {"sofa_room": {}}, version="1"
    )
    return folder


@pytest.fixture
def env(split: Path) -> Iterator[ObjectNavEnv]:
    env = ObjectNavEnv(split=split, camera=CameraModel(width_px=160, height_px=120))
    yield env
    env.close()


def lines_of(out: Path) -> list[dict]:
    return [json.loads(line) for line in (out / "results.jsonl").read_text().splitlines()]


def test_a_drive_is_recorded_like_an_agents_episode_and_the_next_start_takes_the_next_episode(
    split: Path, tmp_path: Path
) -> None:
    args = teleop.Args(split=str(split), out=tmp_path)
    out, line = teleop.drive(args, Script(["up", "w", "left", "d", "w", "x"]))
    assert out == tmp_path
    assert lines_of(tmp_path) == [line]
    assert (line["episode_id"], line["agent"], line["end_reason"], line["num_steps"]) == ("e0", "human", "stop", 6)
    trajectory = read_trajectory(trajectory_file(tmp_path, "e0"))
    ahead, left, right, stop = Action.MOVE_FORWARD, Action.TURN_LEFT, Action.TURN_RIGHT, Action.STOP
    assert trajectory.actions.tolist() == [ahead, ahead, left, right, ahead, stop]
    assert line["path_length"] == pytest.approx(0.75, abs=0.02)
    with pytest.raises(teleop.Quit):
        teleop.drive(args, Script(["w", "q"]))
    assert lines_of(tmp_path) == [line]
    teleop.drive(args, Script(["x"]))
    assert [line["episode_id"] for line in lines_of(tmp_path)] == ["e0", "e1"]
    assert lines_of(tmp_path)[1]["failure"] == "misc"  # the STOP of a person is not a false detection
    assert json.loads((tmp_path / "summary.json").read_text())["episodes"] == 2
    with pytest.raises(ConfigError, match="another folder"):
        teleop.drive(args, Script(["x"]))


def test_leaving_before_the_first_record_leaves_no_folder(split: Path, tmp_path: Path) -> None:
    for goal in (None, "sofa"):  # a folder with episodes refuses another goal
        with pytest.raises(teleop.Quit):
            teleop.drive(teleop.Args(split=str(split), goal=goal, out=tmp_path / "out", video=True), Script(["w", "q"]))
        assert not (tmp_path / "out").exists()


def test_an_episode_that_does_not_exist_leaves_no_folder(split: Path, tmp_path: Path) -> None:
    args = teleop.Args(split=str(split), episode_id="e99", out=tmp_path / "out")
    with pytest.raises(ConfigError, match="no episode 'e99'"):
        teleop.drive(args, Script(["x"]))
    assert not (tmp_path / "out").exists()


def test_keys_that_move_nothing_take_no_step_and_the_distance_is_shown_on_request_only(env: ObjectNavEnv) -> None:
    cockpit = Script(["g", "c", "m", "p", "p", "?", "x"])
    line = play_episode(env, teleop.Human(env, cockpit), env.split.episodes[0], seed=0)
    assert line["num_steps"] == 1
    heads = [" ".join(screen[:2]) for screen in cockpit.screens]
    assert [f"{line['shortest_path']:.1f} m" in head for head in heads] == [False, True] + [False] * 5
    assert "the agent would" in heads[4]


def test_the_map_learns_collisions_from_executed_actions_and_not_from_its_own_choice(env: ObjectNavEnv) -> None:
    cockpit = Script(["w"] * 9)
    human = teleop.Human(env, cockpit)
    with pytest.raises(teleop.Quit):
        play_episode(env, human, env.split.episodes[0], seed=0)
    assert "COLLISION" in " ".join(cockpit.screens[-1][:2])
    marked = np.argwhere(human.mapper.navmap.optimistic_marks)
    assert len(marked) > 0
    x_m, _ = human.mapper.navmap.frame.centres(marked[:, 0], marked[:, 1])
    assert 1.9 < float(x_m.min()) < float(x_m.max()) < 2.6  # the sofa begins at 2.1 m


@pytest.mark.parametrize("size", [(30, 16), (80, 24), (81, 25), (200, 60)])
def test_no_line_is_wider_and_no_screen_higher_than_the_terminal(env: ObjectNavEnv, size: tuple[int, int]) -> None:
    cockpit = Script(["m", "m", "c", "w"], size)
    with pytest.raises(teleop.Quit):
        play_episode(env, teleop.Human(env, cockpit), env.split.episodes[0], seed=0)
    assert len(cockpit.screens) == 5
    for screen in cockpit.screens:
        assert len(screen) <= size[1]
        assert max(map(len, screen)) <= size[0]
        assert any(HALF_BLOCK in line for line in screen)
        words = " ".join(line for line in screen if HALF_BLOCK not in line)
        assert "Look for: SOFA, step" in words
        assert words.split()[-len(human.HELP.split()) :] == human.HELP.split()


def read_back(lines: Sequence[str]) -> NDArray[np.int64]:
    """Returns the image that `half_blocks` shows in 24 bits."""
    rows: list[list[list[int]]] = []
    for line in lines:
        upper, lower, colours = [], [], [0] * 6
        for style, character in re.findall(r"\x1b\[([0-9;]*)m|(.)", line):
            if style.startswith("38;2"):
                numbers = [int(number) for number in style.split(";")]
                colours = numbers[2:5] + numbers[7:10]
            elif character:
                upper.append(colours[:3])
                lower.append(colours[3:])
        rows += [upper, lower]
    return np.array(rows)


def test_half_blocks_and_back_is_identity() -> None:
    image = np.random.default_rng(0).integers(0, 256, (6, 5, 3), dtype=np.uint8)
    image[:, 2:4] = 7  # equal neighbours share one style
    assert np.array_equal(read_back(half_blocks(image)), image)


def test_256_colours_are_near_the_true_ones() -> None:
    levels = (0, 95, 135, 175, 215, 255)
    image = np.random.default_rng(1).integers(0, 256, (2, 200, 3), dtype=np.uint8)
    (line,) = half_blocks(image, "256")
    for place, (upper, lower) in enumerate(re.findall(r"38;5;(\d+);48;5;(\d+)", line)):
        for row, number in enumerate((int(upper), int(lower))):
            cube = number - 16
            grey = [8 + 10 * (number - 232)] * 3
            shown = grey if number >= 232 else [levels[cube // 36], levels[cube // 6 % 6], levels[cube % 6]]
            assert np.abs(np.array(shown) - image[row, place]).max() <= 48


def test_a_fitted_picture_keeps_its_proportions_and_fits() -> None:
    picture = np.zeros((480, 640, 3), np.uint8)
    for columns, lines in ((39, 20), (80, 10), (10, 50)):
        height, width, _ = fitted(picture, columns, lines).shape
        assert width <= columns
        assert height <= 2 * lines
        assert height % 2 == 0
        assert width / height == pytest.approx(4 / 3, rel=0.1)


@pytest.fixture
def pty() -> Iterator[tuple[int, int]]:
    ends = os.openpty()
    termios.tcsetwinsize(ends[1], (24, 80))
    yield ends
    for end in ends:
        os.close(end)


def test_keys_come_one_by_one_and_the_terminal_is_as_it_was_afterwards(pty: tuple[int, int]) -> None:
    master, slave = pty
    before = termios.tcgetattr(slave)
    with open(slave, closefd=False) as keys, open(slave, "w", closefd=False) as screen:
        with Terminal(keys, screen) as terminal:
            assert terminal.size == (80, 24)
            assert termios.tcgetattr(slave) != before
            os.write(master, b"w\x1b[A\x1bOD\x1b[1;5Cx\x1b")
            assert [terminal.key() for _ in range(6)] == ["w", "up", "left", "right", "x", "\x1b"]
        assert termios.tcgetattr(slave) == before
    shown = b""
    while not shown.endswith(b"\x1b[?25h\x1b[?1049l"):  # the cursor and the previous content of the screen are back
        shown += os.read(master, 1000)


def test_without_a_terminal_one_line_says_so() -> None:
    with open(os.devnull) as nothing, pytest.raises(ConfigError, match="terminal"):
        Terminal(nothing, nothing)


@pytest.mark.costly
def test_the_command_is_driven_through_a_terminal(pty: tuple[int, int], split: Path, tmp_path: Path) -> None:
    master, slave = pty
    command = [sys.executable, "-m", "sim.teleop", "--split", str(split), "--out", str(tmp_path), "--episode-id", "e1"]
    process = subprocess.Popen(command, stdin=slave, stdout=slave, stderr=slave)
    shown = b""
    while b"Look for: SOFA" not in shown:
        shown += os.read(master, 65536)
    os.write(master, b"w\x1b[Dx")
    while b"recorded in" not in shown:
        shown += os.read(master, 65536)
    assert process.wait() == 0
    assert [line["num_steps"] for line in lines_of(tmp_path)] == [3]
    assert HALF_BLOCK.encode() in shown
