"""No executor changes a result line: this process, several processes, a Ray cluster in which a machine dies."""

from __future__ import annotations

import errno
import importlib
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import pytest

from sim.app.evaluation import processes
from sim.app.evaluation.executors import make_executor
from sim.app.evaluation.parallel import Shard, ordered_map
from sim.app.evaluation.processes import Isolation, Processes, Supervisor
from sim.app.evaluation.results import RunDirectory
from sim.app.evaluation.workers import MAX_FAILED_STARTS, RunnerSpec, WorkerLost, run_in_pool
from sim.core.errors import WorkersError
from sim.core.interface import ConfigError
from tests.helpers.results import lines_of
from tests.helpers.runners import Job, die, die_the_first_time, slow_double
from tests.helpers.worlds import sofa_room

SPEC = RunnerSpec("tests.helpers.runners:make_runner", None)


def jobs(count: int) -> list[Job]:
    return [Job(f"job_{i}", f"house_{i % 3}") for i in range(count)]


def never(item: object, reason: str) -> Any:
    raise AssertionError(f"{item} was given up: {reason}")


def test_results_have_the_order_of_the_items_whichever_ends_first() -> None:
    items = [30, 1, 20, 2, 10, 3]
    assert list(ordered_map(slow_double, items, workers=2)) == [60, 2, 40, 4, 20, 6]


@pytest.mark.costly
def test_an_item_of_an_ordered_map_whose_worker_died_is_tried_once_more(tmp_path: Path) -> None:
    items = [tmp_path / str(i) for i in range(4)]
    assert list(ordered_map(die_the_first_time, items, workers=2)) == [item.name for item in items]


def test_an_item_that_kills_every_worker_ends_an_ordered_map_with_its_name(tmp_path: Path) -> None:
    with pytest.raises(WorkersError, match=r"^Item.*[12].*'deadly'"):
        list(ordered_map(die, ["deadly", "deadly"], workers=2))


class NeverReady:
    """A pool whose workers die before they are ready."""

    started = 0

    def start(self) -> NeverReady:
        self.started += 1
        return self

    def wait(self, workers: Sequence[NeverReady]) -> Sequence[NeverReady]:
        return workers[:1]

    def receive(self) -> None:
        raise WorkerLost("No such library")

    def send(self, item: object) -> None:
        raise AssertionError("no worker was ready")

    def steps(self) -> None:
        raise AssertionError("no worker was ready")

    def stop(self, workers: Sequence[NeverReady]) -> None:
        pass


def test_workers_that_cannot_start_end_the_run_and_say_why() -> None:
    pool = NeverReady()
    with pytest.raises(WorkersError, match=r"3.*\(No.*library\)"):
        list(run_in_pool(pool, jobs(10), max_workers=1, on_death=never))
    assert pool.started == MAX_FAILED_STARTS


class OneProcessor(processes.ProcessPool):
    """A pool like a cluster with one free processor: its other workers never become ready."""

    first: Any = None

    def start(self) -> Any:
        started = super().start()
        self.first = self.first or started
        return started

    def wait(self, workers: Sequence[Any]) -> Any:
        assert self.first in workers, "it would wait forever"
        return super().wait([self.first])


def test_work_does_not_wait_for_workers_that_never_start() -> None:
    lines = list(run_in_pool(OneProcessor(SPEC), jobs(6), max_workers=3, on_death=never))
    assert len({line["pid"] for line in lines}) == 1
    assert len(lines) == 6


def test_shards_hold_every_item_once() -> None:
    items = list(range(11))
    shards = [Shard.parse(f"{i}/4") for i in (1, 2, 3, 4)]
    assert sorted(item for shard in shards for item in shard.select(items)) == items
    for shard in shards:
        assert list(shard.select(items)) == [item for item in items if shard.contains(item)]


@pytest.mark.parametrize("text", ["0/2", "3/2", "1", "a/b", "-1/2", "0/0", "1/2/3", "\u0661/2"])
def test_a_shard_that_does_not_exist_is_refused(text: str) -> None:
    with pytest.raises(ConfigError, match=r'--shard.*"i/n".*1'):
        Shard.parse(text)


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({"name": "cloud"}, "Unknown --executor 'cloud'. Available: local, ray."),
        ({"name": "local", "address": "head:6379"}, "--address 'head:6379' needs --executor ray."),
        ({"name": "local", "workers": 0}, "--workers must be at least 1, got 0."),
    ],
)
def test_options_that_contradict_each_other_are_refused(options: dict[str, Any], sentence: str) -> None:
    with pytest.raises(ConfigError) as raised:
        make_executor(**{"workers": 1, **options})
    assert str(raised.value) == sentence


def test_without_ray_the_message_names_the_package_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delitem(sys.modules, "sim.app.evaluation.executors_ray", raising=False)
    monkeypatch.setitem(sys.modules, "ray", None)
    with pytest.raises(ConfigError, match=r"pip install 'stubborn-objectnav\[ray\]'"):
        make_executor("ray", workers=1)


def test_without_a_cluster_one_sentence_says_how_to_start_one() -> None:
    pytest.importorskip("ray")
    with pytest.raises(ConfigError, match="`ray start --head`"):
        make_executor("ray", workers=1, address="127.0.0.1:1")


@pytest.fixture(scope="module")
def cluster() -> Iterator[Any]:
    """Starts two machines of one processor each; a dead machine is detected within two seconds."""
    ray = pytest.importorskip("ray")
    os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")
    noticed = {f"health_check_{name}": value for name, value in HEALTH.items()}
    head = {"num_cpus": 1, "object_store_memory": 80_000_000, "_system_config": noticed}
    two = importlib.import_module("ray.cluster_utils").Cluster(initialize_head=True, head_node_args=head)
    try:
        yield two
    finally:
        ray.shutdown()
        two.shutdown()


HEALTH = {"initial_delay_ms": 0, "period_ms": 500, "timeout_ms": 500, "failure_threshold": 3}


@pytest.mark.slow
def test_a_cluster_loses_no_episode_with_one_of_its_machines(
    cluster: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from sim.app.commands.run import entry

    machine = cluster.add_node(num_cpus=1, object_store_memory=80_000_000)
    furnished = sofa_room()
    (tmp_path / "sofa_room.xml").write_text(furnished.spec.to_xml())
    command = ["--agent", "oracle", "--house", str(tmp_path / "sofa_room.xml"), "--episodes", "12"]
    assert entry([*command, "--out", str(tmp_path / "here")]) == 0
    written = RunDirectory.append

    def append(run: RunDirectory, line: Any) -> None:
        written(run, line)
        if len(run.lines) == 4:
            cluster.remove_node(machine, allow_graceful=False)

    monkeypatch.setattr(RunDirectory, "append", append)
    on_cluster = ["--executor", "ray", "--address", cluster.address, "--workers", "2"]
    assert entry([*command, *on_cluster, "--out", str(tmp_path / "there")]) == 0
    assert len(cluster.list_all_nodes()) == 1
    assert lines_of(tmp_path / "there") == lines_of(tmp_path / "here")


@pytest.mark.slow
def test_a_worker_of_a_cluster_dies_as_a_process_does(cluster: Any, tmp_path: Path) -> None:
    deadly = Job("deadly", "house_0", kill=tmp_path / "died")
    fatal = Job("fatal", "house_0", kill=tmp_path / "fatal", always=True)
    executor = make_executor("ray", workers=2, address=cluster.address)
    given_up = lambda item, _: {"episode_id": item.episode_id, "dead": True}  # noqa: E731
    lines = list(executor.run(SPEC, [*jobs(4), deadly, fatal], on_death=given_up))
    assert (tmp_path / "died").exists()
    assert len(lines) == 6
    assert [line["episode_id"] for line in lines if line.get("dead")] == ["fatal"]


@pytest.mark.slow
def test_machines_with_other_code_are_refused(cluster: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    from sim.app.evaluation import executors_ray

    executor = make_executor("ray", workers=2, address=cluster.address)
    monkeypatch.setattr(executors_ray, "code_hash", lambda: "0ther")
    with pytest.raises(WorkersError, match="0ther"):
        list(executor.run(SPEC, jobs(2), on_death=never))


@pytest.mark.costly
def test_workers_end_with_the_process_that_started_them_in_the_middle_of_an_item(tmp_path: Path) -> None:
    markers = [tmp_path / "a", tmp_path / "b"]
    code = f"""
from pathlib import Path
from sim.app.evaluation.parallel import ordered_map
from tests.helpers.runners import write_pid_and_sleep
if __name__ == "__main__":
    list(ordered_map(write_pid_and_sleep, [Path({str(markers[0])!r}), Path({str(markers[1])!r})], workers=2))
"""
    (tmp_path / "main.py").write_text(code)
    path = os.pathsep.join([str(Path(__file__).parents[4]), os.environ.get("PYTHONPATH", "")])
    parent = subprocess.Popen([sys.executable, str(tmp_path / "main.py")], env={**os.environ, "PYTHONPATH": path})
    wait_for(lambda: all(marker.exists() and marker.read_text() for marker in markers), 60.0)
    parent.kill()
    parent.wait()
    wait_for(lambda: not any(Path("/proc", marker.read_text(), "cmdline").exists() for marker in markers), 5.0)


def wait_for(condition: Callable[[], bool], seconds: float) -> None:
    until_s = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < until_s, "it did not happen"
        time.sleep(0.02)


@pytest.mark.costly
@pytest.mark.parametrize(("threads", "expected"), [(None, "4"), ("3", "3")])
def test_workers_share_the_processors_unless_the_user_says_how_many_threads(
    monkeypatch: pytest.MonkeyPatch, threads: str | None, expected: str
) -> None:
    name = "OMP_NUM_THREADS"
    monkeypatch.delenv(name, raising=False) if threads is None else monkeypatch.setenv(name, threads)
    monkeypatch.setattr(processes, "_processors", lambda: 8)
    assert list(ordered_map(os.getenv, [name, name], workers=2)) == [expected, expected]
    assert os.environ.get(name) == threads, "this process keeps its own setting"


@pytest.mark.costly
@pytest.mark.parametrize("how", ["loop", "kernel", "stop"])
def test_a_call_that_never_returns_ends_its_item_and_no_other(how: str) -> None:
    items = [Job("hangs", "house_0", hang=how), Job("works", "house_0")]
    given_up = lambda item, reason: {"episode_id": item.episode_id, "reason": reason}  # noqa: E731
    began_s = time.monotonic()
    lines = list(Processes(1, Isolation(needed=True, limit_s=0.3)).run(SPEC, items, on_death=given_up))
    assert time.monotonic() - began_s < 60.0
    assert lines[0] == {
        "episode_id": "hangs",
        "reason": "The job hangs: no answer within 0.3 s (--step-timeout), so its process was ended.",
    }
    assert lines[1]["episode_id"] == "works"


def test_the_supervisor_of_a_clusters_process_reports_its_end_and_goes_on(tmp_path: Path) -> None:
    supervisor = Supervisor(SPEC, limit_s=60.0)
    loss = supervisor.run(Job("deadly", "house_0", kill=tmp_path / "died", always=True))
    assert isinstance(loss, WorkerLost)
    line = supervisor.run(Job("works", "house_0"))
    assert isinstance(line, dict)
    assert line["pid"] != os.getpid()
    supervisor.close()


def test_a_worker_with_threads_and_exit_handlers_that_do_not_end_is_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(processes, "LAST_WORDS_S", 0.2)
    began_s = time.monotonic()
    (line,) = Processes(1, Isolation(needed=True)).run(SPEC, [Job("a", "b", hang="thread")], on_death=never)
    assert line["episode_id"] == "a"
    assert time.monotonic() - began_s < 60.0


def test_an_error_that_cannot_be_pickled_reaches_the_caller_as_text() -> None:
    with pytest.raises(WorkersError, match="OwnError: first"):
        list(Processes(1, Isolation(needed=True)).run(SPEC, [Job("a", "b", hang="raise")], on_death=never))


def test_shared_memory_that_cannot_be_used_is_named_with_the_remedy(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise OSError(errno.EROFS, os.strerror(errno.EROFS))

    monkeypatch.setattr("sim.app.evaluation.processes.Calls", refuse)
    with pytest.raises(ConfigError, match=r"shared memory \(/dev/shm\).*Read-only file system.*--workers 1"):
        processes._Process(RunnerSpec("", None), threads=1, limit_s=0.0)
