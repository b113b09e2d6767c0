"""The finished runs of the page: hostile folders are listed with the reason, and nothing outside of them is read."""

from __future__ import annotations

import fcntl
import io
import json
import os
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from sim.app.web.runs import Runs
from sim.core.errors import ConfigError, HouseError

pytest.importorskip("starlette", reason="no starlette: pip install -e '.[web]'")

import anyio
from starlette.requests import Request
from starlette.responses import Response

from sim.app.web.answers import as_ascii, in_thread
from tests.helpers.results import ENTRIES

LINE = ENTRIES | {"episode_id": "e/0"}


def write_run(folder: Path, line: Any = LINE, config: bytes = b'{"agent": "mine"}') -> Path:
    folder.mkdir(parents=True)
    (folder / "results.jsonl").write_text(json.dumps(line) + "\n")
    (folder / "config.json").write_bytes(config)
    return folder


def link_out(file: Path) -> None:
    (file.parents[2] / "secret.json").write_text('{"agent": "SECRET"}')
    file.symlink_to(file.parents[2] / "secret.json")


PLACES: dict[str, Callable[[Path], None]] = {
    "a link out of the folder": link_out,
    "a pipe": lambda file: os.mkfifo(file),
    "a device": lambda file: file.symlink_to("/dev/zero"),
    "a folder": lambda file: file.mkdir(),
    "a loop of links": lambda file: file.symlink_to(file.name),
}


@pytest.mark.parametrize("place", PLACES.values(), ids=PLACES)
@pytest.mark.parametrize("name", ["config.json", "results.jsonl", "report.html", "videos/e%2F0.mp4"])
def test_only_plain_files_inside_the_folder_are_read(tmp_path: Path, name: str, place: Callable[[Path], None]) -> None:
    run = write_run(tmp_path / "runs" / "run")
    file = run / name
    file.unlink(missing_ok=True)
    file.parent.mkdir(exist_ok=True)
    if "/" in name:  # the link and the pipe then stand for the folder of the videos, or for a file in it
        place(file) if place is not link_out else file.symlink_to("/etc/hostname")
    else:
        place(file)
    runs = Runs(tmp_path / "runs")
    assert "SECRET" not in as_ascii(runs.as_json())
    for read in (lambda: runs.report("run"), lambda: runs.video("run", "e/0")):
        with pytest.raises(ConfigError):
            read()


@pytest.mark.parametrize(
    "config",
    [b"", b"\xff\xfe", b'{"agent": "\\ud800"}', b'{"agent": 5}', b'{"x": 1e999}', b'{"x":' + b"[" * 9999, b"[]"],
)
def test_a_run_that_cannot_be_read_is_listed_with_the_reason(tmp_path: Path, config: bytes) -> None:
    write_run(tmp_path / "broken", config=config)
    write_run(tmp_path / "whole")
    listed = {run["name"]: run for run in Runs(tmp_path).as_json()}
    assert "config.json" in str(listed["broken"]["broken"])
    assert listed["whole"]["agent"] == "mine"
    with pytest.raises(ConfigError):
        Runs(tmp_path).episodes("broken")


def test_a_report_of_traps_is_not_listed_as_a_run(tmp_path: Path) -> None:
    (write_run(tmp_path / "traps") / "traps.csv").touch()
    write_run(tmp_path / "whole")
    assert [run["name"] for run in Runs(tmp_path).as_json()] == ["whole"]


@pytest.mark.parametrize(
    "name", [b"\xff\xfe", b"line\nbreak", b"\x1b[31m", "Häuser ✓".encode(), b"<img src=x>", b"a%2fb"]
)
def test_a_folder_of_any_name_is_listed_and_opened(tmp_path: Path, name: bytes) -> None:
    write_run(tmp_path / os.fsdecode(name))
    (run,) = Runs(tmp_path).as_json()
    assert json.loads(as_ascii(run))["agent"] == "mine"
    assert Runs(tmp_path).episodes(str(run["name"]))[0]["episode_id"] == "e/0"


def test_a_run_that_goes_on_is_read_again_and_an_unchanged_one_is_not(tmp_path: Path) -> None:
    run = write_run(tmp_path / "run")
    runs = Runs(tmp_path)
    assert runs.run("run") is runs.run("run")
    with (run / "results.jsonl").open("a") as stream:
        stream.write(json.dumps(LINE | {"episode_id": "e/1"}) + "\n")
    assert [episode["episode_id"] for episode in runs.episodes("run")] == ["e/0", "e/1"]


def test_a_comparison_has_the_notes_of_the_command_and_names_the_runs_by_their_folders(tmp_path: Path) -> None:
    write_run(tmp_path / "one")
    write_run(tmp_path / "two", LINE | {"success": 0.0, "spl": 0.0, "end_reason": "error", "error": "it broke"})
    means, _ = Runs(tmp_path).comparison("one", "two")
    notes = means["notes"]
    assert isinstance(notes, list)
    assert notes[0] == "A: one, B: two; 1 episode of both runs."
    assert notes[2].startswith("Ended with an error: 0 of A, 1 of B")


def test_a_folder_that_does_not_exist_holds_no_run(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    assert Runs(tmp_path / "none").as_json() == Runs(tmp_path / "file").as_json() == []


def test_a_run_is_packed_without_links_and_hidden_files(tmp_path: Path) -> None:
    run = write_run(tmp_path / "runs" / "mine")
    (run / "videos").mkdir()
    (run / "videos" / "e%2F0.mp4").write_bytes(b"a video")
    (run / ".lock").write_bytes(b"")
    (tmp_path / "secret").write_text("SECRET")
    (run / "videos" / "link").symlink_to(tmp_path / "secret")
    packed = io.BytesIO(b"".join(Runs(tmp_path / "runs").packed("mine")))
    with zipfile.ZipFile(packed) as archive:
        assert sorted(archive.namelist()) == ["mine/config.json", "mine/results.jsonl", "mine/videos/e%2F0.mp4"]
        assert archive.read("mine/videos/e%2F0.mp4") == b"a video"
        assert archive.read("mine/results.jsonl") == (run / "results.jsonl").read_bytes()


def test_a_run_is_deleted_unless_it_is_being_written(tmp_path: Path) -> None:
    runs, run = Runs(tmp_path / "runs"), write_run(tmp_path / "runs" / "mine")
    other = write_run(tmp_path / "elsewhere")
    (tmp_path / "runs" / "link").symlink_to(other)
    with (run / ".lock").open("ab") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        with pytest.raises(ConfigError, match="'mine' is being written"):
            runs.delete("mine")
    assert run.is_dir()
    runs.delete("mine")
    assert not run.exists()
    for name in ("mine", "link", "..", "../elsewhere", ""):
        with pytest.raises(ConfigError, match="There is no run"):
            runs.delete(name)
    assert (other / "results.jsonl").is_file()


def test_a_lock_that_is_a_pipe_does_not_stop_the_server(tmp_path: Path) -> None:
    runs, run = Runs(tmp_path / "runs"), write_run(tmp_path / "runs" / "mine")
    os.mkfifo(run / ".lock")
    with pytest.raises(ConfigError, match="cannot be deleted"):
        runs.delete("mine")


def test_a_chain_with_one_goal_of_two_is_not_found(tmp_path: Path) -> None:
    write_run(tmp_path / "runs" / "half", LINE | {"success": 0.5})
    assert [run["found"] for run in Runs(tmp_path / "runs").as_json()] == [0]


def test_an_error_of_this_project_is_a_response() -> None:
    def draw(request: Request) -> Response:
        raise HouseError("House 'x.xml' is broken.")

    answer = anyio.run(in_thread(draw), Request({"type": "http"}))
    assert (answer.status_code, answer.body) == (404, b"House 'x.xml' is broken.")


def test_the_list_names_the_segmentation_that_acted_and_not_the_default(tmp_path: Path) -> None:
    names = {"a": None, "b": "rednet"}
    for folder, name in names.items():
        config = {"semantics": "rednet", "segmentation": {"name": name}, "files_sha256": {"weights": "0123456789"}}
        write_run(tmp_path / folder, config=json.dumps(config).encode())
    listed = {run["name"]: run["segmentation"] for run in Runs(tmp_path).as_json()}
    assert listed == {"a": "none", "b": "rednet, shipped weights (01234567)"}
