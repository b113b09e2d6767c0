"""An agent's process with one fault, for tests: a second writing of the protocol, without NumPy and our client.

    faulty_agent.py FAULT FOLDER

The first process of a folder has the fault, later ones have none. Each writes the ids of its processes to FOLDER/pids.
"""

import json
import os
import signal
import struct
import sys
import time

MARK, PREFIX = b"\x89STUBB\r\n", struct.Struct("<8sIIQ")
FAULT, FOLDER = sys.argv[1:3]
ANSWERS = {
    "start": {"type": "ready", "draws_map": True},
    "reset": {"type": "done"},
    "act": {"type": "action", "action": 1},
    "map": {"type": "map", "state": "", "arrays": [{"name": "map", "dtype": "|u1", "shape": [2, 2, 3]}]},
}
FIRST = not os.path.exists(os.path.join(FOLDER, "pids"))


def note(pid: int) -> None:
    with open(os.path.join(FOLDER, "pids"), "a") as stream:
        stream.write(f"{pid}\n")


def read(count: int) -> bytes:
    content = b""
    while len(content) < count:
        got = os.read(0, count - len(content))
        if not got:
            sys.exit()
        content += got
    return content


def write(content: bytes) -> None:
    while content:
        content = content[os.write(1, content) :]


def message(header: object, arrays: bytes = b"", *, version: int = 2, raw: bytes | None = None) -> bytes:
    head = json.dumps(header).encode() if raw is None else raw
    return PREFIX.pack(MARK, version, len(head), len(arrays)) + head + arrays


def fork(*, apart: bool) -> None:
    """Starts a process that sleeps; `apart`: in a session of its own, whose parent has ended."""
    child = os.fork()
    if child == 0:
        if apart:
            os.setsid()
            if os.fork():
                os._exit(0)
        note(os.getpid())
        time.sleep(60)
        os._exit(0)
    time.sleep(0.05)


def sleep() -> None:
    time.sleep(60)


def drip() -> None:
    while True:
        write(b"\x89")
        time.sleep(0.02)


def flood(number: int) -> None:
    while True:
        os.write(number, b"garbage " * 1000)


def exit_with(status: int) -> None:
    os.write(2, f"Goodbye\nwith status {status}\n".encode())
    os._exit(status)


def forks_and_answers(header: dict) -> None:
    fork(apart=True)
    fork(apart=False)
    sleep()


def stops_guard() -> None:
    """Stops the process that would end this one, after starting another one apart."""
    fork(apart=True)
    os.kill(os.getppid(), signal.SIGSTOP)
    sleep()


def act(header: dict) -> None:
    """Answers a request for an action, or does what the fault says."""
    good = {**ANSWERS["act"], "id": header["id"]}
    instead = {
        "no_answer": sleep,
        "forks": lambda: forks_and_answers(header),
        "stops_guard": stops_guard,
        "escapes": lambda: (os.write(2, b"\x1b]0;title\x07\x1b[31mred\x1b[0m\x1b[2J 50%\r60%\n"), write(message(good))),
        "late_answer": lambda: (time.sleep(0.6), write(message(good))),
        "drip": drip,
        "flood_stdout": lambda: flood(1),
        "flood_stderr": lambda: flood(2),
        "garbage": lambda: write(os.urandom(4000)),
        "text": lambda: write(b"Loading weights ...\n" * 4),
        "closed_stdout": lambda: (os.close(1), sleep()),
        "closed_stdin": lambda: (os.close(0), write(message(good)), sleep()),
        "sigkill": lambda: os.kill(os.getpid(), signal.SIGKILL),
        "sigsegv": lambda: os.kill(os.getpid(), signal.SIGSEGV),
        "sigstop": lambda: os.kill(os.getpid(), signal.SIGSTOP),
        "exit_0": lambda: os._exit(0),
        "exit_3": lambda: exit_with(3),
        "version": lambda: write(message(good, version=1)),
        "huge_header": lambda: write(PREFIX.pack(MARK, 2, 2**32 - 1, 0)),
        "huge_arrays": lambda: write(PREFIX.pack(MARK, 2, 2, 2**63) + b"{}"),
        "large_arrays": lambda: write(PREFIX.pack(MARK, 2, 2, 2**28) + b"{}"),
        "no_json": lambda: write(message({}, raw=b"{'action': 1}")),
        "no_utf8": lambda: write(message({}, raw=b'{"type": "\xff"}')),
        "no_object": lambda: write(message([1])),
        "too_deep": lambda: write(message({}, raw=b'{"id": ' + b"[" * 60_000)),
        "empty": lambda: write(message({}, raw=b"")),
        "no_id": lambda: write(message({"type": "action", "action": 1})),
        "other_id": lambda: write(message({**good, "id": 1})),
        "other_type": lambda: write(message({"type": "done", "id": header["id"]})),
        "twice": lambda: write(message(good) * 2),
        "half": lambda: (write(message(good)[:30]), os._exit(0)),
        "text_action": lambda: write(message({**good, "action": "left"})),
        "real_action": lambda: write(message({**good, "action": 1.5})),
        "no_action": lambda: write(message({"type": "action", "id": header["id"]})),
        "action_7": lambda: write(message({**good, "action": 7})),
        "nan": lambda: write(message({}, raw=json.dumps({**good, "action": float("nan")}).encode())),
        "confidence": lambda: write(message({**good, "action": 0, "stop_confidence": 1.5})),
        "target": lambda: write(message({**good, "action": 0, "stop_target_xy_m": [1e300, 0.0]})),
        "error": lambda: write(message({"type": "error", "id": header["id"], "error": "KeyError:\n'sofa'\x1b[2J"})),
    }
    chosen = instead.get(FAULT) if FIRST else None
    chosen() if chosen else write(message(good))


def draw(header: dict) -> None:
    """Answers a request for a map."""
    good = {**ANSWERS["map"], "id": header["id"]}
    (image,) = good["arrays"]
    shapes = {"map_shape": [2, 2], "map_huge": [2**31, 2**31, 3], "map_negative": [-1, 2, 3], "map_large": [3, 3, 3]}
    wrong = {**good, "arrays": [{**image, "shape": shapes.get(FAULT, [2, 2, 3])}]} if FIRST else good
    if FAULT == "map_type" and FIRST:
        wrong["arrays"][0]["dtype"] = "<f8"
    if FAULT == "map_pickle" and FIRST:
        wrong["arrays"][0]["dtype"] = "|O"
    if FAULT == "map_missing" and FIRST:
        wrong["arrays"] = []
    write(message(wrong, bytes(12)))


def main() -> None:
    note(os.getpid())
    if FIRST and FAULT == "start_sleep":
        sleep()
    if FIRST and FAULT == "start_exit":
        sys.exit("ImportError: No module named torch")
    if FIRST and FAULT == "start_flood":
        flood(1)
    if FAULT == "banner":
        write(b"pygame 2.1\nHello from the pygame community.\n")
    while True:
        mark, _, header_bytes, array_bytes = PREFIX.unpack(read(PREFIX.size))
        assert mark == MARK
        header = json.loads(read(header_bytes))
        read(array_bytes)
        kind = header["type"]
        if kind == "reset" and FIRST and FAULT == "exit_at_reset":
            exit_with(4)
        if kind == "act":
            act(header)
        elif kind == "map":
            draw(header)
        else:
            write(message({**ANSWERS[kind], "id": header["id"]}))


if __name__ == "__main__":
    main()
