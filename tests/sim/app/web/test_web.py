"""`python -m sim.web` as users run it: in headless Chromium, with a second client, and with hostile requests."""

from __future__ import annotations

import contextlib
import http.client
import json
import os
import re
import shutil
import socket as socket_module
import struct
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from sim.app.commands import report, web
from sim.app.commands import run as sim_run
from sim.app.evaluation.results import read_results
from sim.episodes.splits import load_split
from sim.task.trajectory import read_trajectory, trajectory_file
from tests.helpers.browser import ESCAPE, Browser, missing
from tests.helpers.results import ENTRIES

pytest.importorskip("starlette", reason="no starlette: pip install -e '.[web]'")
pytest.importorskip("uvicorn", reason="no uvicorn: pip install -e '.[web]'")
client = pytest.importorskip("websockets.sync.client", reason="no websockets: pip install -e '.[web]'")

from websockets.exceptions import WebSocketException  # noqa: E402

WISH = {"split": "traps", "house": "wedged_spawn", "goal": "bed", "semantics": "gt"}
LINE = ENTRIES | {"episode_id": "e/0", "house": "h", "num_steps": 9}


class Server:
    """A server in a process of its own, on a port that stays the same when it is started again."""

    def __init__(self, runs: Path, port: int = 0) -> None:
        command = [sys.executable, "-m", "sim.web", "--port", str(port), "--runs", str(runs)]
        self.log = tempfile.TemporaryFile("w+")  # noqa: SIM115 - it is there as long as the server
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=self.log, text=True)
        assert self.process.stdout is not None
        match = re.search(r"http://127\.0\.0\.1:(\d+)", self.process.stdout.readline())
        assert match
        self.port = int(match[1])
        self.address = f"http://127.0.0.1:{self.port}"

    def get(self, path: str, host: str | None = None, **headers: str) -> tuple[int, dict[str, str], bytes]:
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=30)
        connection.request("GET", path, headers={"Host": host or f"127.0.0.1:{self.port}", **headers})
        answer = connection.getresponse()
        content = answer.read()
        connection.close()
        return answer.status, {name.lower(): value for name, value in answer.getheaders()}, content

    def connect(self, origin: str | None = "own", host: str | None = None) -> Any:
        headers = {} if host is None else {"Host": host}
        origin = self.address if origin == "own" else origin
        return client.connect(f"ws://127.0.0.1:{self.port}/live", origin=origin, additional_headers=headers)

    def kill(self) -> None:
        self.process.kill()
        self.process.wait()


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("web")
    run = folder / "runs" / "mine"
    (run / "videos").mkdir(parents=True)
    broken = {"episode_id": "e/2", "success": 0.0, "failure": "misc", "end_reason": "error", "error": "It broke."}
    lines = [LINE, LINE | {"episode_id": "e/1"}, LINE | broken]
    (run / "results.jsonl").write_text("".join(json.dumps(line) + "\n" for line in lines))
    (run / "config.json").write_text(json.dumps({"agent": "stubborn", "semantics": "gt"}))
    (run / "videos" / "e%2F0.mp4").write_bytes(b"a video")
    other = folder / "runs" / "other"
    other.mkdir()
    (other / "results.jsonl").write_text(json.dumps(LINE | {"success": 0.0}) + "\n")
    (other / "config.json").write_text(json.dumps({"agent": "oracle", "semantics": "rednet"}))
    (folder / "secret.mp4").write_bytes(b"a secret")
    os.symlink(folder / "secret.mp4", run / "videos" / "e%2F1.mp4")
    os.symlink(folder, folder / "runs" / "elsewhere")
    return folder / "runs"


@pytest.fixture(scope="module")
def server(runs: Path) -> Iterator[Server]:
    server = Server(runs)
    yield server
    server.kill()


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    if reason := missing():
        pytest.skip(reason)
    browser = Browser(tmp_path_factory.mktemp("chromium"), width=1400, height=1000)
    yield browser
    browser.close()


def wait_for(condition: Callable[[], Any], seconds: float = 60.0) -> Any:
    end = time.monotonic() + seconds
    while not (value := condition()):
        assert time.monotonic() < end, "it did not happen"
        time.sleep(0.05)
    return value


def state_of(socket: Any, phase: str) -> dict[str, Any]:
    """Waits for a state of this phase and returns it."""
    while True:
        message = socket.recv(timeout=60)
        if isinstance(message, str) and (state := json.loads(message)).get("phase") == phase:
            return state


def frame_of(socket: Any) -> tuple[dict[str, Any], bytes]:
    """Waits for a frame; returns its header and its pictures."""
    while isinstance(message := socket.recv(timeout=60), str):
        pass
    length = struct.unpack(">I", message[:4])[0]
    return json.loads(message[4 : 4 + length]), message[4 + length :]


# ---- refused requests


def test_other_hosts_other_origins_and_sockets_of_other_pages_are_refused(server: Server) -> None:
    own = f"127.0.0.1:{server.port}"
    assert server.get("/")[0] == 200
    assert server.get("/", f"localhost:{server.port}")[0] == 200
    assert server.get("/", "rebound.example")[0] == 403
    assert server.get("/api/choices", own, Origin="http://other.example")[0] == 403
    for origin, host in ((None, None), ("http://other.example", None), ("null", None), ("own", "rebound.example")):
        with pytest.raises(WebSocketException):
            server.connect(origin, host)
    with server.connect() as socket:
        assert json.loads(socket.recv(timeout=10))["kind"] == "state"


def test_only_the_page_and_files_of_runs_are_served(server: Server) -> None:
    status, headers, page = server.get("/")
    assert (status, b"<title>" in page) == (200, True)
    assert "script-src 'self'" in headers["content-security-policy"]
    assert not re.search(rb"https?://", page)
    for path in ("/page.css", "/page.js", "/icon.svg"):
        assert server.get(path)[0] == 200
    assert server.get("/runs/mine/video?episode=e/0")[2] == b"a video"
    for path in (
        "/server.py",
        "/../server.py",
        "/page.js/..%2f..%2fserver.py",
        "/runs/mine/video?episode=e/1",  # a link out of the folder
        "/runs/mine/video?episode=../../../secret",
        "/runs/..%2f..%2f/video?episode=secret",
        "/runs/elsewhere/video?episode=secret",
        "/runs/mine/report.html",
        "/runs/mine/config.json",
    ):
        status, _, content = server.get(path)
        assert status == 404, path
        assert b"secret" not in content or b"has no video" in content, path


@pytest.mark.parametrize(
    "message", ["no JSON", "[]", '{"do": "start"}', json.dumps({"do": "start", **WISH, "agent": "os:system"})]
)
def test_commands_that_are_not_in_the_package_cannot_be_started(server: Server, message: str) -> None:
    with server.connect() as socket:
        socket.send(message)
        received = (socket.recv(timeout=10) for _ in range(10))
        answers = (json.loads(message) for message in received if isinstance(message, str))  # others are frames
        assert next(answer for answer in answers if answer["kind"] == "refused")["message"]


BROKEN = {
    "binary": b"\x82\x82abcd\x00\x00",
    "not UTF-8": b"\x81\x82abcd\x9e\x9c",
    "not masked": b"\x81\x02{}",
    "unknown opcode": b"\x83\x81abcdx",
    "continuation of nothing": b"\x80\x81abcdx",
    "longer than memory": b"\x81\xff\x7f\xff\xff\xff\xff\xff\xff\xffabcd",
    "close without a code": b"\x88\x81abcdx",
    "another protocol": b"GET / HTTP/1.1\r\n\r\n",
}
"""Frames of a websocket that no browser sends, masked by "abcd" where they are."""


@pytest.mark.parametrize("frame", BROKEN.values(), ids=BROKEN)
def test_broken_frames_leave_no_traceback(server: Server, frame: bytes) -> None:
    with server.connect() as socket:
        socket.recv(timeout=10)
        socket.socket.sendall(frame)
        with contextlib.suppress(WebSocketException, TimeoutError):  # the server may have closed it already
            while True:
                socket.recv(timeout=0.3)
    assert server.get("/")[0] == 200
    server.log.seek(0)
    assert "Traceback" not in server.log.read()


def test_bytes_that_are_no_request_leave_no_traceback(server: Server) -> None:
    for data in (b"\x16\x03\x01", b"GET /\xff HTTP/1.1\r\n\r\n", b"GET / HTTP/1.1\r\nHost: [\r\n\r\n"):
        with socket_module.create_connection(("127.0.0.1", server.port), timeout=5) as connection:
            connection.sendall(data + b"\r\n\r\n")
            assert connection.recv(100).split()[1] in (b"400", b"403")
    server.log.seek(0)
    assert "Traceback" not in server.log.read()


# ---- in a real browser


@pytest.mark.costly
def test_an_episode_runs_to_its_end_and_a_second_client_sees_it(server: Server, browser: Browser) -> None:
    browser.visit(server.address)
    wait_for(lambda: browser.run("return document.querySelectorAll('#goal option').length"))
    for name, value in {**WISH, "agent": "oracle"}.items():
        browser.run(
            "const s = document.getElementById(arguments[0]); s.value = arguments[1];"
            "s.dispatchEvent(new Event('change'));",
            name,
            value,
        )
    with server.connect() as second:
        second.send(json.dumps({"do": "show", "pictures": ["plan"]}))
        second.send(json.dumps({"do": "speed", "per_s": 60}))
        browser.click("#start")
        begun = state_of(second, "running")
        assert (begun["request"]["house"], begun["request"]["goal"]) == ("wedged_spawn", "bed")
        header, pictures = frame_of(second)
        assert [name for name, _ in header["pictures"]] == ["plan"]
        assert pictures[:2] == b"\xff\xd8"  # a JPEG
        ended = state_of(second, "ended")
        assert ended["outcome"]["found"]
    wait_for(lambda: browser.run("return document.body.dataset.phase") == "ended")
    assert browser.run("return document.getElementById('outcome-headline').textContent").startswith("Found after")
    wait_for(lambda: browser.run("return document.querySelector('#facts').textContent.includes(', stop,')"))
    closing = "return document.getElementById('outcome').hidden"
    assert not browser.run(closing)
    browser.click("#close-outcome")
    assert browser.run(closing)
    assert browser.run("return document.getElementById('doing').textContent").startswith("The STOP counts")
    with server.connect():  # another page sends this page the same end again
        wait_for(lambda: "2 pages" in browser.run("return document.getElementById('link').textContent"))
        assert browser.run(closing)
    drawn = browser.run("""
        return [...document.querySelectorAll("figure")].filter((figure) => {
            const canvas = figure.querySelector("canvas");
            const data = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
            return data.some((value, i) => i % 4 < 3 && value > 100);
        }).map((figure) => figure.dataset.name);
    """)
    assert {"camera", "chase", "plan", "semantic", "depth"} <= set(drawn)
    assert browser.console_errors() == []
    assert all(address.startswith((server.address, "blob:", "data:")) for address in browser.requests())
    browser.visit(server.address)  # a page that is opened now shows the end, but not as one that is new
    wait_for(lambda: browser.run("return document.body.dataset.phase") == "ended")
    assert browser.run(closing)
    message, doing = (f"return document.getElementById('{name}').textContent" for name in ("message", "doing"))
    assert browser.run(message).startswith("Last episode: Found after")
    wait_for(lambda: browser.run(doing).startswith("The STOP counts"))


@pytest.mark.costly
def test_ten_actions_are_driven_the_agent_is_taken_over_from_and_gets_the_robot_back(
    server: Server, browser: Browser, runs: Path
) -> None:
    browser.visit(server.address)
    wait_for(lambda: browser.run("return document.querySelector('#link').textContent") == "connected")
    with server.connect() as second:
        second.send(json.dumps({"do": "show", "pictures": []}))
        second.send(json.dumps({"do": "speed", "per_s": 1}))  # other tests let it run as fast as it can
        second.send(json.dumps({"do": "start", **WISH, "agent": "stubborn"}))
        state_of(second, "running")
        wait_for(lambda: browser.run("return document.body.dataset.phase") == "running")
        browser.click("#pause")
        wait_for(lambda: browser.run("return document.querySelector('#pause').textContent") == "Run")
        before = wait_for(lambda: frame_now(browser) + 1)

        def stepped() -> bool:  # a click that comes before the pause does nothing
            browser.click("#step")
            time.sleep(1.0)
            return frame_now(browser) >= before

        wait_for(stepped)
        browser.click("#take")
        wait_for(lambda: browser.run("return document.querySelector('#driver').textContent") == "you drive")
        for step in range(10):
            now = frame_now(browser)
            if step % 2:
                browser.click('[data-action="2"]')  # by mouse or finger
            else:
                browser.keys("body", "d")
            wait_for(lambda now=now: frame_now(browser) > now)
        driven = frame_now(browser)
        browser.click("#take")
        browser.click("#pause")
        wait_for(lambda: frame_now(browser) > driven)  # the agent goes on
        assert browser.run("return document.querySelector('#driver').textContent") == "stubborn"
        browser.click('[data-action="0"]')
        ended = state_of(second, "ended")
    # The STOP of a person is not a false detection. The agent may have driven near the bed.
    sentence = ended["outcome"]["sentence"]
    assert "came too early" in sentence or "The STOP counts" in sentence
    run = runs / Path(ended["outcome"]["recorded"].removeprefix("Recorded in ").removesuffix(".")).name
    (line,) = read_results(run / "results.jsonl").values
    assert (line.agent, line.other_driver, line.person_steps) == ("human+agent", "stubborn", 11)
    recorded = read_trajectory(trajectory_file(run, line.episode_id))
    assert (recorded.num_steps, recorded.end_reason) == (line.num_steps, "stop")
    assert browser.console_errors() == []


def frame_now(browser: Browser) -> int:
    """Returns the step that the page shows; -1 before the first."""
    return int(browser.run("return document.body.dataset.step ?? -1"))


@pytest.mark.costly
def test_escape_and_another_house_close_the_outcome_of_each_episode(server: Server, browser: Browser) -> None:
    browser.visit(server.address)
    hidden = "return document.getElementById('outcome').hidden"
    choose = "document.getElementById('house').dispatchEvent(new Event('change'))"
    with server.connect() as second:
        for close in (lambda: browser.keys("body", ESCAPE), lambda: browser.run(choose)):
            second.send(json.dumps({"do": "speed", "per_s": 60}))
            second.send(json.dumps({"do": "start", **WISH, "agent": "random"}))
            state_of(second, "running")
            second.send(json.dumps({"do": "act", "action": 0}))
            wait_for(lambda: browser.run(hidden) is False)
            close()
            assert browser.run(hidden)
            state_of(second, "ended")


def test_a_page_that_was_left_is_not_counted_and_the_back_button_brings_it_back(
    server: Server, browser: Browser, tmp_path: Path
) -> None:
    link = "return document.querySelector('#link').textContent"
    browser.visit(server.address)
    wait_for(lambda: browser.run(link) == "connected")
    (tmp_path / "other.html").write_text("<title>other</title>")
    browser.open(tmp_path / "other.html")
    browser.visit(f"{server.address}/#again")
    wait_for(lambda: browser.run(link).startswith("connected"))
    time.sleep(0.3)  # a counted page would get the state at once
    assert browser.run(link) == "connected"
    browser.run("history.go(-2)")
    wait_for(lambda: browser.run("return location.hash") == "")
    wait_for(lambda: browser.run(link) == "connected")


@pytest.mark.parametrize(
    ("option", "value", "told"),
    [
        ("--weights", "none.safetensors", "No weights at 'none.safetensors'."),
        ("--agent", "no_such:AGENT", "'no_such:AGENT': no module 'no_such' can be imported from here."),
        ("--house", "none.xml", "House 'none.xml': there is no such file."),
    ],
)
def test_what_is_not_there_is_refused_in_one_line(
    option: str, value: str, told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert web.entry(["--port", "0", option, value]) == 2
    assert capsys.readouterr().err.replace(f"{Path.cwd()}/", "") == f"error: {told}\n"


def test_finished_runs_are_filtered_opened_and_compared(server: Server, browser: Browser) -> None:
    browser.visit(server.address)
    browser.click("#tab-runs")
    rows = "return [...document.querySelectorAll('#run-list tr')].map(row => row.innerText)"
    wait_for(lambda: browser.run(rows))
    browser.keys("#run-filter", "rednet other")
    (other,) = browser.run(rows)
    assert "other" in other
    assert "0 of 1" in other
    browser.run(
        "const f = document.getElementById('run-filter'); f.value = 'mine'; f.dispatchEvent(new Event('input'))"
    )
    (mine,) = browser.run(rows)
    assert "2 of 3, 1 error" in mine
    assert str(time.localtime().tm_year) in mine
    browser.click("#run-list button")
    episodes = "return [...document.querySelectorAll('#episodes tr')].map(row => row.innerText)"
    shown = wait_for(lambda: browser.run(episodes))
    assert "found" in shown[0]
    assert [("Video" in row) for row in shown] == [True, False, False]
    assert "error" in shown[2]
    assert "misc" not in shown[2]
    browser.run(
        "const f = document.getElementById('outcome-filter'); f.value = 'missed'; f.dispatchEvent(new Event('change'))"
    )
    assert browser.run(episodes) == shown[2:]
    browser.run("for (const name of ['mine', 'other']) marked.add(name); showRuns();")
    browser.click("#compare")
    compared = wait_for(lambda: browser.run("return document.getElementById('comparison-tables').innerText"))
    assert "paired over 1 episodes" in compared
    assert "-100.0" in compared
    wait_for(lambda: not browser.run("return document.getElementById('no-replay').hidden"))  # they share no video
    assert browser.console_errors() == []


def test_a_press_on_the_house_chooses_the_start(server: Server, browser: Browser) -> None:
    browser.visit(server.address)
    wait_for(lambda: browser.run("return above !== null && state.phase !== 'running'"))
    browser.run("document.getElementById('place').focus()")
    browser.run(
        "const c = document.getElementById('above-picture'), box = c.getBoundingClientRect();"
        "c.setPointerCapture = () => {};"
        "const at = (type, x, y) => c.dispatchEvent(new PointerEvent(type, {button: 0, pointerId: 1,"
        " clientX: box.left + x * box.width, clientY: box.top + y * box.height}));"
        "at('pointerdown', 0.5, 0.5); at('pointermove', 0.5, 0.4); at('pointerup', 0.5, 0.4);"
    )
    x, y, deg = (float(word) for word in browser.run("return document.getElementById('place').value").split())
    assert [x, y] == pytest.approx(browser.run("return above.middle_m"), abs=0.02)
    assert deg == 90
    assert "Start: the arrow" in browser.run("return document.getElementById('above-words').textContent")
    browser.run("document.getElementById('house').selectedIndex = 1; chosenHouse();")
    assert browser.run("return document.getElementById('place').value") == ""
    assert browser.console_errors() == []


def test_descriptions_that_ship_for_a_house_are_proposed_to_the_stronger_agent(
    server: Server, browser: Browser
) -> None:
    browser.visit(server.address)
    wait_for(lambda: browser.run("return document.getElementById('wishes').children.length"))
    assert browser.run("return document.getElementById('agent').value") == "stubborn-plus"
    proposed = browser.run("return [...document.getElementById('wishes').children].map((option) => option.value)")
    split = load_split("descriptions")
    assert set(proposed) == {episode.goal for episode in split.episodes if episode.house == split.houses[0]}
    assert browser.run("return document.getElementById('wish').placeholder") == min(proposed, key=len)
    house = "const house = document.getElementById('house'); return [house.options[0].text, house.value]"
    assert browser.run(house) == [split.houses[0], split.houses[0]]
    choose = "const split = document.getElementById('split'); split.value = 'traps'; "
    browser.run(choose + "split.dispatchEvent(new Event('change'))")
    assert browser.run("return document.getElementById('wishes').children.length") == 0


def test_a_wish_that_the_house_cannot_satisfy_shows_the_house_again(server: Server, browser: Browser) -> None:
    browser.visit(server.address)
    wait_for(lambda: browser.run("return above !== null && state.phase !== 'running'"))
    with server.connect() as client:
        client.send(json.dumps({"do": "start", **WISH, "agent": "stubborn-plus", "goal": "a kettle"}))
        wait_for(lambda: browser.run("return state.phase") == "failed")
    assert "has no 'kettle'" in browser.run("return document.getElementById('message').textContent")
    wait_for(lambda: browser.run("return document.getElementById('above').offsetHeight > 0"))
    assert browser.console_errors() == []


def test_the_form_hides_no_text_and_its_buttons_need_no_row_of_their_own(server: Server, browser: Browser) -> None:
    browser.visit(server.address)
    wait_for(lambda: browser.run("return document.getElementById('agent-note').textContent"))
    hidden = "const note = document.getElementById('agent-note'); return note.scrollWidth > note.clientWidth"
    middle = "const box = document.getElementById('{}').getBoundingClientRect(); return (box.top + box.bottom) / 2"
    caption = "const words = document.getElementById('segmentation-name'); return words.scrollWidth > words.clientWidth"
    browser.run(
        "document.body.dataset.step = 0; document.getElementById('segmentation-name').textContent = 'Segments (rednet)'"
    )
    for width, height in ((1280, 900), (1200, 789), (390, 900)):
        browser.resize(width, height)
        assert not browser.run(hidden)
        assert not browser.run(caption)
    browser.resize(1280, 900)
    assert browser.run(middle.format("start")) == pytest.approx(browser.run(middle.format("agent-note")), abs=5)


def test_on_a_phone_no_column_of_the_finished_runs_is_clipped(server: Server, browser: Browser) -> None:
    browser.visit(server.address)
    browser.resize(390, 900)
    try:
        browser.run("tab('runs')")
        wait_for(lambda: browser.run("return document.querySelectorAll('#run-list tr').length"))
        browser.run("document.querySelector('#run-list button').click()")
        wait_for(lambda: browser.run("return document.querySelectorAll('#episodes tr').length"))
        names = "const [run, , agent] = [...document.querySelector('#run-list tr').cells].slice(1); "
        longest = "run.firstElementChild.textContent = 'driven_2026-12-01_04-20-31'; agent.textContent = 'human+agent'"
        browser.run(names + longest)
        clipped = "[...document.querySelectorAll('#runs .scroll')].filter(box => box.scrollWidth > box.clientWidth)"
        assert browser.run(f"return {clipped}.length") == 0
    finally:
        browser.resize(1280, 900)


def test_a_run_is_downloaded_and_deleted_with_a_second_click(runs: Path, server: Server, browser: Browser) -> None:
    spare = runs / "spare"
    shutil.copytree(runs / "other", spare)
    status, headers, content = server.get("/runs/spare/run.zip")
    assert (status, headers["content-type"], content[:2]) == (200, "application/zip", b"PK")
    browser.visit(server.address)
    browser.click("#tab-runs")
    names = "return [...document.querySelectorAll('#run-list button')].map(button => button.innerText)"
    wait_for(lambda: "spare" in browser.run(names))
    browser.run("[...document.querySelectorAll('#run-list button')].find(b => b.innerText === 'spare').click()")
    wait_for(lambda: browser.run("return !document.getElementById('run').hidden"))
    browser.click("#run-delete")
    assert browser.run("return document.getElementById('run-delete').textContent") == "Really delete?"
    assert spare.is_dir()
    browser.click("#run-delete")
    wait_for(lambda: not spare.exists())
    wait_for(lambda: "spare" not in browser.run(names))
    assert browser.console_errors() == []


def test_only_the_page_deletes_runs(server: Server, runs: Path) -> None:
    for headers in ({}, {"Origin": "http://evil.example"}):
        connection = http.client.HTTPConnection("127.0.0.1", server.port, timeout=30)
        connection.request("DELETE", "/api/runs/other", headers={"Host": f"127.0.0.1:{server.port}", **headers})
        assert connection.getresponse().status == 403
        connection.close()
    assert (runs / "other" / "results.jsonl").is_file()


@pytest.mark.costly
def test_a_report_shows_its_pictures_and_videos(tmp_path: Path, browser: Browser) -> None:
    run = tmp_path / "runs" / "real"
    options = ["--split", "traps", "--agent", "oracle", "--semantics", "gt", "--episodes", "1", "--video", "--record"]
    assert sim_run.entry([*options, "--out", str(run)]) == 0
    assert report.main(report.Args(runs=(run,))) == 0
    episode = json.loads((run / "results.jsonl").read_text())["episode_id"]
    server = Server(run.parent)
    try:
        for name in (f"pictures/{episode}.jpg", f"videos/{episode}.mp4"):
            assert server.get(f"/runs/real/{name}")[2] == (run / name).read_bytes()
        for name in (f"trajectories/{episode}.npz", f"pictures/{episode}.mp4", "pictures/..%2fconfig.json"):
            assert server.get(f"/runs/real/{name}")[0] == 404
        browser.visit(f"{server.address}/runs/real/report.html#episode={episode}")
        large = "return [...document.images].filter(i => i.src.includes('/pictures/') && i.naturalWidth >= 640).length"
        wait_for(lambda: browser.run(large))
        browser.run("const film = document.querySelector('video'); film.preload = 'auto'; film.load();")
        wait_for(lambda: browser.run("return document.querySelector('video').readyState"))
        assert browser.console_errors() == []
    finally:
        server.kill()


def test_all_pictures_are_above_the_fold_and_none_is_black_while_loading(server: Server, browser: Browser) -> None:
    browser.resize(1400, 900)
    try:
        browser.visit(server.address)
        wait_for(lambda: browser.run("return document.querySelector('#link').textContent").startswith("connected"))
        boxes = browser.run(
            "showState({...state, phase: 'loading', note: ''});"
            "return [...document.querySelectorAll('figure')].map(f => [f.getBoundingClientRect().bottom,"
            " getComputedStyle(f.querySelector('canvas')).visibility, f.offsetHeight])"
        )
        assert len(boxes) == 8
        assert all(bottom <= 900 and height > 100 for bottom, _, height in boxes)
        assert {visibility for _, visibility, _ in boxes} == {"hidden"}
    finally:
        browser.resize(1400, 1000)


def test_nothing_is_wider_than_a_phone(server: Server, browser: Browser) -> None:
    browser.resize(390, 844)
    try:
        browser.visit(server.address)
        for tab in ("live", "runs"):
            browser.click(f"#tab-{tab}")
            assert browser.run("return document.documentElement.scrollWidth") <= 390
    finally:
        browser.resize(1400, 1000)


@pytest.mark.costly
def test_the_page_comes_back_when_the_server_is_killed_and_started_again(
    runs: Path, server: Server, browser: Browser
) -> None:
    browser.visit(server.address)
    link = "return document.querySelector('#link').textContent"
    wait_for(lambda: browser.run(link) == "connected")
    server.kill()
    wait_for(lambda: "lost" in browser.run(link))
    server.process = Server(runs, server.port).process
    wait_for(lambda: browser.run(link) == "connected")
    assert browser.run("return document.body.dataset.phase") == "idle"


@pytest.mark.costly
def test_a_port_in_use_gives_one_sentence(server: Server) -> None:
    command = [sys.executable, "-m", "sim.web", "--port", str(server.port)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith(f"error: Cannot listen on 127.0.0.1, port {server.port}: ")
