"""Agents in other processes: whatever such a process does, an episode ends, the next one runs, and nothing is left."""

from __future__ import annotations

import ast
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sim.app.bridges import habitat_client, process_pipe, stubborn_client
from sim.app.bridges.process import ProcessAgent, ProcessPainter
from sim.app.bridges.process_command import ProcessConfig, command_of, files_of
from sim.app.commands.agent_client import IMPORT, client_file
from sim.app.commands.main import entry as main
from sim.core.errors import AgentError, ConfigError
from sim.core.interface import Action, CameraModel, RobotModel, SuccessRule
from tests.helpers import wording
from tests.helpers.sampling import sample

ROOT = Path(__file__).parents[4]
FAULTY = ROOT / "tests" / "helpers" / "faulty_agent.py"
OBSERVATION = {
    "rgb": np.zeros((480, 640, 3), np.uint8),
    "depth": np.ones((480, 640), np.float32),
    "gps": np.zeros(2, np.float32),
    "compass": np.zeros(1, np.float32),
    "objectgoal": np.zeros(1, np.int64),
}
PARTS: dict[str, Any] = {
    "camera": CameraModel(),
    "robot": RobotModel(),
    "success": SuccessRule(),
    "max_steps": 500,
    "step_timeout_s": 20.0,
}
SOON_S = 0.3
"""Limit of a call in tests of agents that do not answer."""
SLOW = ("no_answer", "forks", "stops_guard", "late_answer", "drip", "flood_stderr", "sigstop")
"""Faults that end at the limit of a call."""
FAULTS = {
    "no_answer": "no answer within 0.3 s",
    "forks": "no answer within 0.3 s",
    "stops_guard": "no answer within 0.3 s",
    "late_answer": "no answer within 0.3 s",
    "drip": "a message does not begin with b'|no answer within 0.3 s",
    "flood_stdout": "a message does not begin with b'(garbage|arbage)",
    "flood_stderr": "no answer within 0.3 s; the last lines of its standard error: .*garbage",
    "garbage": "its answer is not valid: a message does not begin with",
    "text": "a message does not begin with b'Loading weights",
    "closed_stdout": "its process closed its standard output before it answered",
    "closed_stdin": "closed its standard input",
    "sigkill": "its process was ended by SIGKILL before it answered",
    "sigsegv": "its process was ended by SIGSEGV before it answered",
    "sigstop": "no answer within 0.3 s",
    "exit_0": "its process ended with status 0 before it answered$",
    "exit_3": r"its process ended with status 3 before it answered; the last lines .*: Goodbye \| with status 3$",
    "version": "version 1 of the protocol, not 2: copy stubborn_client.py again",
    "huge_header": r"a message of 4294967295 \+ 0 bytes is too large",
    "huge_arrays": r"a message of 2 \+ 9223372036854775808 bytes is too large",
    "large_arrays": "its arrays have 268435456 bytes, at most 67108864",
    "no_json": "its answer is not JSON",
    "no_utf8": "its answer is not JSON",
    "no_object": "its answer: expected object, got array",
    "too_deep": "its answer is nested too deeply",
    "empty": "its answer is empty",
    "no_id": "it answered request None, but 3 was asked",
    "other_id": "it answered request 1, but 3 was asked",
    "other_type": "its answer, field 'type': invalid value 'done'",
    "twice": "it wrote more than one answer",
    "half": "its process ended with status 0 before it answered",
    "text_action": "field 'action': expected int, got str",
    "real_action": "field 'action': expected int, got float",
    "no_action": "missing required field action",
    "action_7": "field 'action': expected int <= 5",
    "nan": "its answer is not JSON",
    "confidence": "field 'stop_confidence': expected float <= 1.0",
    "target": r"field 'stop_target_xy_m\[0\]': expected float <= ",
    "error": r"^KeyError: 'sofa'\\x1b\[2J$",
    "exit_at_reset": "its process ended with status 4 before it answered",
    "map_shape": "field 'arrays.*shape'",
    "map_huge": "is truncated",
    "map_negative": "expected int >= 1",
    "map_large": "is truncated",
    "map_type": "dtype",
    "map_pickle": "dtype",
    "map_missing": "arrays",
}
"""The behaviour of an agent's process at its first step, map or reset, and a part of the message."""


def command(fault: str, folder: Path) -> list[str]:
    return [sys.executable, "-I", "-S", str(FAULTY), fault, str(folder)]


def make(fault: str, folder: Path, **parts: Any) -> ProcessAgent:
    return ProcessAgent(command(fault, folder), **{**PARTS, "config": ProcessConfig(), **parts})


def run_episode(agent: ProcessAgent, goal: str = "chair") -> Action:
    agent.reset(goal, 0)
    action = agent.act(OBSERVATION)
    agent.map_image()
    return action


def is_gone(pid: int) -> bool:
    try:
        state = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
    except OSError:
        return True
    return state == "Z"


def require_gone(folder: Path, *, within_s: float = 0.0) -> None:
    """Asserts that all processes of an agent have ended."""
    pids = [int(line) for line in (folder / "pids").read_text().split()]
    until_s = time.monotonic() + within_s
    while time.monotonic() < until_s and not all(map(is_gone, pids)):
        time.sleep(0.02)
    assert pids
    assert [pid for pid in pids if not is_gone(pid)] == []


@pytest.mark.costly
@pytest.mark.parametrize("fault", sample(list(FAULTS), 20))
def test_a_fault_ends_its_episode_and_leaves_no_process_and_the_next_episode_runs(fault: str, tmp_path: Path) -> None:
    agent = make(fault, tmp_path, step_timeout_s=SOON_S if fault in SLOW else 20.0)
    with pytest.raises(AgentError, match=FAULTS[fault]):
        run_episode(agent)
    require_gone(tmp_path)
    agent._limit_s = 20.0
    assert run_episode(agent) is Action.MOVE_FORWARD
    agent.close()
    require_gone(tmp_path)


class LatePoll:
    """A poll object that is asked late, when all events of the end of a process have come."""

    def __init__(self, poll: Any) -> None:
        self._poll = poll

    def __getattr__(self, name: str) -> Any:
        return getattr(self._poll, name)

    def poll(self, limit_ms: float) -> list[tuple[int, int]]:
        time.sleep(0.3)
        return self._poll.poll(limit_ms)


def test_the_status_is_told_when_the_end_of_the_output_and_the_line_of_the_guard_arrive_together(
    tmp_path: Path,
) -> None:
    process = process_pipe.AgentProcess(command("exit_0", tmp_path))
    process.ask({"type": "start"}, within_s=20)
    process.ask({"type": "reset"}, within_s=20)
    process._poll = LatePoll(process._poll)  # pyright: ignore[reportAttributeAccessIssue]
    with pytest.raises(AgentError, match=wording.ITS_PROCESS_ENDED_WITH_STATUS_0_BEFORE_IT_ANSWER):
        process.ask({"type": "act"}, within_s=20)
    process.close()


@pytest.mark.parametrize(
    ("fault", "message"),
    [
        ("start_sleep", "no answer within 0.3 s"),
        ("start_flood", "no answer within 0.3 s"),
        ("start_exit", "ended with status 1 .* standard error: ImportError: No module named torch"),
    ],
)
def test_a_process_that_does_not_start_is_refused_in_one_line(fault: str, message: str, tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=f"^Agent 'process:.*' cannot be started: .*{message}") as raised:
        make(fault, tmp_path, config=ProcessConfig(start_timeout_s=20.0 if fault == "start_exit" else SOON_S))
    assert "\n" not in str(raised.value)
    if (tmp_path / "pids").exists():  # on a busy machine it is ended before its first line
        require_gone(tmp_path)


def test_a_command_that_does_not_exist_is_refused_with_its_name() -> None:
    with pytest.raises(ConfigError, match=r"\(No.*'no-such-python'.*\)"):
        ProcessAgent(["no-such-python", "agent.py"], **PARTS, config=ProcessConfig())


def test_what_is_printed_before_the_first_answer_is_no_fault(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    agent = make("banner", tmp_path)
    assert run_episode(agent) is Action.MOVE_FORWARD
    agent.close()
    assert "Hello from the pygame community." in capsys.readouterr().err


def test_what_an_agent_prints_is_shown_up_to_a_limit(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    agent = make("flood_stderr", tmp_path, step_timeout_s=SOON_S)
    with pytest.raises(AgentError):
        run_episode(agent)
    printed = capsys.readouterr().err
    assert process_pipe.PRINTED_BYTES <= len(printed) < process_pipe.PRINTED_BYTES + 200
    assert printed.endswith("[the agent prints more, which is left out]\n")


def test_an_agent_cannot_control_the_terminal(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    agent = make("escapes", tmp_path)
    agent.reset("chair", 0)
    agent.act(OBSERVATION)
    agent.close()
    assert capsys.readouterr().err == "\\x1b]0;title\\x07red\\x1b[2J 50%\n60%\n"


HOST = """
import sys, time
from sim.app.bridges.process_pipe import AgentProcess
process = AgentProcess(sys.argv[1:])
process.ask({"type": "start"}, within_s=20)
process.ask({"type": "reset"}, within_s=20)
process.ask({"type": "act"}, within_s=60)
"""
"""A simulator that waits for an agent that has started other processes and hangs."""


@pytest.mark.parametrize("killed", ["simulator", "guard"])
def test_after_kill_9_of_the_simulator_or_the_guard_no_process_is_left(killed: str, tmp_path: Path) -> None:
    words = [sys.executable, "-c", HOST, *command("forks" if killed == "simulator" else "no_answer", tmp_path)]
    with subprocess.Popen(words, cwd=ROOT, stderr=subprocess.DEVNULL) as host:
        count = 3 if killed == "simulator" else 1
        until_s = time.monotonic() + 20.0
        while not (tmp_path / "pids").exists() or len((tmp_path / "pids").read_text().split()) < count:
            assert time.monotonic() < until_s
            time.sleep(0.02)
        (guard,) = Path(f"/proc/{host.pid}/task/{host.pid}/children").read_text().split()
        os.kill(host.pid if killed == "simulator" else int(guard), signal.SIGKILL)
        require_gone(tmp_path, within_s=5.0)
        assert host.wait(10.0) != 0
        (tmp_path / "pids").write_text(guard)
        require_gone(tmp_path, within_s=5.0)


def test_an_observation_arrives_as_it_was_sent_and_is_the_agents_own(tmp_path: Path) -> None:
    code = """
import hashlib, sys
import numpy as np
from sim.app.bridges.stubborn_client import serve
class Agent:
    def reset(self, goal, seed):
        self.seen, self.goal = [], goal
    def act(self, observation):
        self.seen.append(observation)
        return 1
    def map_image(self):
        last = self.seen[0]
        assert all(each.flags.writeable for each in last.values())
        for each in last.values():
            print(each.dtype.str, each.shape, file=sys.stderr)
        sent = np.concatenate([np.frombuffer(each.tobytes(), np.uint8) for each in last.values()])
        return sent[:, None, None].repeat(3, 2)
    def state(self):
        return " ".join(last for last in self.seen[0]) + " " + self.goal
serve(lambda setup: Agent() if setup.camera.width_px == 640 and setup.goals[0] == "chair" else None)
"""
    agent = ProcessAgent([sys.executable, "-c", code], **PARTS, config=ProcessConfig())
    rng = np.random.default_rng(0)
    observation = {
        "rgb": rng.integers(0, 256, (30, 40, 3), dtype=np.uint8)[:, ::-1],
        "depth": rng.random((30, 40), dtype=np.float32).T,
        "gps": np.array([1.5, np.nan], np.float32),
        "objectgoal": np.array([7], np.int64),
    }
    expected = np.concatenate([np.frombuffer(array.tobytes(), np.uint8) for array in observation.values()])
    agent.reset("chair", 0)
    agent.act(observation)
    agent.act({name: np.zeros_like(array) for name, array in observation.items()})
    image, words = agent.map_image()
    np.testing.assert_array_equal(image[:, 0, 1], expected)
    assert words == "rgb depth gps objectgoal chair"
    agent.close()


def test_a_map_is_fitted_into_the_square_of_a_video(tmp_path: Path) -> None:
    agent = make("none", tmp_path)
    agent.reset("bed", 0)
    painted = ProcessPainter(agent).paint(296)
    assert painted.shape == (296, 296, 3)
    assert not painted.any()  # 2 x 2 black pixels
    agent.close()


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("process:", wording.A_COMMAND_MUST_FOLLOW),
        ("process:''", wording.A_COMMAND_MUST_FOLLOW),
        ("process:a 'b", "No closing quot"),
    ],
)
def test_a_command_that_is_none_is_refused(name: str, message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        command_of(name)


def test_the_files_of_a_command_are_those_that_it_names(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("agent.py", "weights.pt", "package/run.py"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text("")
    files = files_of("process:python agent.py --weights weights.pt --out package")
    assert files == [Path("agent.py"), Path("weights.pt")]
    assert files_of("process:conda run -n old python -m package.run") == [Path("package/run.py")]
    monkeypatch.setenv("PYTHONPATH", "package")
    assert files_of("process:python client.py run:Agent args=other:get()") == [Path("package/run.py")]


def test_the_client_file_is_printed_as_one_file_and_python_3_6_reads_it(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["agent-client"]) == 0
    printed = capsys.readouterr().out
    assert printed == client_file()
    assert "from sim" not in printed
    assert len(IMPORT.findall(Path(habitat_client.__file__).read_text())) == 1
    ast.parse(printed, feature_version=(3, 6))
    imports = [node for node in ast.walk(ast.parse(printed)) if isinstance(node, ast.Import)]
    modules = {alias.name.split(".")[0] for node in imports for alias in node.names}
    assert modules - set(sys.stdlib_module_names) == {"numpy"}


def test_a_client_without_a_guard_ends_when_its_pipe_is_closed_even_if_the_agent_hangs(tmp_path: Path) -> None:
    code = """
import time
from sim.app.bridges import stubborn_client
stubborn_client.LAST_WORDS_S = 0.1
class Agent:
    def reset(self, goal, seed):
        print("hangs", flush=True)
        time.sleep(60)
    def act(self, observation): return 1
stubborn_client.serve(Agent())
"""
    pipes: dict[str, Any] = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    with subprocess.Popen([sys.executable, "-c", code], cwd=ROOT, **pipes) as client:
        assert client.stdin is not None
        assert client.stderr is not None
        for part in stubborn_client.pack({"type": "reset", "id": 1, "goal": "bed", "seed": 0}):
            client.stdin.write(part)
        client.stdin.flush()
        assert client.stderr.readline() == b"hangs\n"
        client.stdin.close()
        assert client.wait(20.0) == 1
