"""An agent in namespaces finds no house, truth, result, seed, process or network, and still gets its observations."""

from __future__ import annotations

import json
import os
import shlex
import signal
import socket
import sys
import time
from pathlib import Path

import msgspec
import pytest

from sim.app.analysis.comparison import read_run
from sim.app.bridges import process_command
from sim.app.bridges.process import ProcessAgent, ProcessConfig
from sim.app.bridges.process_command import fault_of_namespaces, is_bounded
from sim.app.bridges.process_pipe import AgentProcess
from sim.app.commands.run import entry
from sim.app.composition.agents import hidden_from_agents, notes_on
from sim.app.submissions.packing import About, pack
from sim.core.errors import AgentError, ConfigError
from sim.core.paths import assets_dir
from sim.env.objectnav import ObjectNavEnv
from tests.helpers.submissions import CLIENT_AGENT, SMALL, checked, tiny_split, written
from tests.sim.app.bridges.test_process import OBSERVATION, PARTS, command, is_gone

NAMESPACE = ProcessConfig(boundary="namespace")
needs_namespaces = pytest.mark.skipif(bool(fault_of_namespaces()), reason=f"namespaces: {fault_of_namespaces()}")

SPY = """
import json, os, socket, subprocess, sys
from sim.app.bridges.stubborn_client import serve

def names(folder):
    try:
        return sorted(os.listdir(folder))
    except OSError as error:
        return [type(error).__name__]

def content(file):
    try:
        return open(file, "rb").read().decode()
    except OSError as error:
        return type(error).__name__

def connects():
    try:
        socket.create_connection(("127.0.0.1", PORT), 2.0)
        return True
    except OSError:
        return False

def done(*words):
    return subprocess.run(words, capture_output=True).returncode == 0

class Agent:
    def reset(self, goal, seed): pass
    def act(self, observation):
        commands = [content("/proc/%s/cmdline" % name) for name in names("/proc") if name.isdigit()]
        found = {
            "folder": names(FOLDER), "file": content(FILE), "secret": os.environ.get("SECRET"), "connects": connects(),
            "runner": RUNNER in commands, "processes": len(commands),
            "undone": done("umount", FOLDER), "undone_apart": done("unshare", "-Urm", "umount", FOLDER),
            "seen_apart": done("unshare", "-Urm", "sh", "-c", "mount --bind %s /mnt && ls /mnt/*/secret.xml" % ABOVE),
            "shape": list(observation["depth"].shape),
        }
        print(json.dumps(found), file=sys.stderr)
        return 1
serve(lambda setup: Agent())
"""


@needs_namespaces
def test_an_agent_in_namespaces_finds_nothing_but_its_observations(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("SECRET", "token")
    folder, file = tmp_path / "houses", tmp_path / "truth.json"
    folder.mkdir()
    (folder / "secret.xml").write_text("<mujoco/>")
    file.write_text("sofa")
    with socket.create_server(("127.0.0.1", 0)) as server:
        given: dict[str, object] = {"RUNNER": Path("/proc/self/cmdline").read_bytes().decode()}
        given |= {"FOLDER": str(folder), "FILE": str(file), "ABOVE": str(tmp_path), "PORT": server.getsockname()[1]}
        code = "".join(f"{name} = {value!r}\n" for name, value in given.items()) + SPY
        found = {}
        for config in (NAMESPACE, ProcessConfig()):
            agent = ProcessAgent([sys.executable, "-c", code], **PARTS, config=config, hidden=[folder, file])
            agent.reset("chair", 0)
            agent.act(OBSERVATION)
            agent.close()
            found[config.boundary] = json.loads(capsys.readouterr().err)
    inside, outside = found["namespace"], found["none"]
    assert inside == {
        "folder": [], "file": "", "secret": None, "connects": False, "runner": False, "processes": 2, "undone": False,
        "undone_apart": False, "seen_apart": False, "shape": [480, 640],
    }  # fmt: skip
    assert (outside["folder"], outside["file"], outside["secret"]) == (["secret.xml"], "sofa", "token")
    assert outside["connects"]
    assert outside["runner"]


@needs_namespaces
@pytest.mark.parametrize(
    ("fault", "message"),
    [
        ("forks", "no answer within 0.3 s"), ("sigkill", "its process was ended by SIGKILL"),
        ("exit_3", "its process ended with status 3 before it answered; the last lines .*: Goodbye"),
        ("stops_guard", "no answer within 0.3 s|PermissionError"),
    ],
)  # fmt: skip
def test_no_process_is_left_and_its_end_is_told(fault: str, message: str, tmp_path: Path) -> None:
    limit_s = 0.3 if message.startswith("no answer") else 20.0
    agent = ProcessAgent(command(fault, tmp_path), **{**PARTS, "step_timeout_s": limit_s}, config=NAMESPACE)
    agent.reset("chair", 0)
    assert agent._process is not None
    guard = agent._process._guard.pid
    children = [int(pid) for pid in Path(f"/proc/{guard}/task/{guard}/children").read_text().split()]
    started = [*children, *(int(pid) for pid in _children_of(children))]
    with pytest.raises(AgentError, match=message):
        agent.act(OBSERVATION)
    until_s = time.monotonic() + 5.0
    while time.monotonic() < until_s and not all(map(is_gone, started)):
        time.sleep(0.02)
    assert len(started) >= 2
    assert [pid for pid in started if not is_gone(pid)] == []


def _children_of(pids: list[int]) -> list[str]:
    return [word for pid in pids for word in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]


@needs_namespaces
def test_the_agent_ends_when_its_guard_is_killed(tmp_path: Path) -> None:
    running = AgentProcess(command("no_answer", tmp_path), [])
    running.ask({"type": "start"}, within_s=20.0)
    (first,) = Path(f"/proc/{running._guard.pid}/task/{running._guard.pid}/children").read_text().split()
    (agent,) = _children_of([int(first)])
    os.kill(running._guard.pid, signal.SIGKILL)
    until_s = time.monotonic() + 5.0
    while time.monotonic() < until_s and not is_gone(int(agent)):
        time.sleep(0.02)
    assert is_gone(int(agent))
    running.close(at_once=True)


def test_a_machine_without_namespaces_is_refused_or_named(monkeypatch: pytest.MonkeyPatch) -> None:
    for module in (process_command, sys.modules["sim.app.composition.agents"]):
        monkeypatch.setattr(module, "fault_of_namespaces", lambda: "unshare: Operation not permitted")
    with pytest.raises(ConfigError, match=r"is not possible on this machine: unshare: Operation not permitted\."):
        ProcessAgent(["true"], **PARTS, config=NAMESPACE)
    auto = ProcessConfig(boundary="auto")
    assert not is_bounded(auto)
    assert "has no boundary" in notes_on("process:true", auto)[0]
    assert notes_on("process:true", ProcessConfig()) == ()
    for wrong in ({"boundary": "wall"}, {"hidden": (Path("/a"),)}):
        with pytest.raises(ConfigError, match="boundary"):
            ProcessConfig(**wrong)  # type: ignore[arg-type]


@needs_namespaces
def test_a_hidden_folder_in_another_one_is_hidden_and_a_missing_one_is_named(tmp_path: Path) -> None:
    for name in ("a/b", "a-b"):  # as text, "a-b" is between "a" and "a/b"
        (tmp_path / name).mkdir(parents=True)
    code = f"import os, sys; sys.exit(7 if os.listdir({str(tmp_path / 'a')!r}) == [] else 3)"
    for hidden, message in (
        ([tmp_path / name for name in ("a", "a-b", "a/b")], "status 7"),
        ([tmp_path / "no"], f"'{tmp_path / 'no'}'"),
    ):
        with pytest.raises((AgentError, ConfigError), match=message):
            ProcessAgent([sys.executable, "-c", code], **PARTS, config=NAMESPACE, hidden=hidden).reset("bed", 0)


def test_houses_episodes_and_results_are_hidden_and_the_agents_folder_is_not(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    split, out = tiny_split(tmp_path), tmp_path / "out"
    out.mkdir()
    env = ObjectNavEnv(split=str(split))
    assert hidden_from_agents(env, out) == sorted([assets_dir(), out, split])
    monkeypatch.chdir(split)
    assert hidden_from_agents(env, None) == sorted([assets_dir(), split / "sofa_room.xml"])
    env.close()


@needs_namespaces
def test_the_result_and_the_submission_state_the_boundary(tmp_path: Path) -> None:
    split, out = tiny_split(tmp_path), tmp_path / "run"
    name = "process:" + shlex.join([sys.executable, str(CLIENT_AGENT)])
    options = ["--split", str(split), "--agent", name, "--semantics", "gt", "--episodes", "1", "--record"]
    assert entry([*options, "--out", str(out), "--config", *SMALL, "agent.boundary=namespace"]) == 0
    (line,) = (out / "results.jsonl").read_text().splitlines()
    assert json.loads(line)["isolated"] == "namespace"
    submission = pack(read_run(out), About(name="Ours", authors=()))
    assert submission.manifest.inputs.isolated == "namespace"
    file = written(tmp_path / "ours.json.gz", json.loads(msgspec.json.encode(submission)))
    assert checked(tmp_path, file)[0].covers == "the first 1 of 3 episodes"
