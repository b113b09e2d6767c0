"""Runs your agent in its own Python, container or virtual environment, for `stubborn run --agent process:COMMAND`.

Copy this file next to your agent; it needs Python 3.6 or newer, and NumPy. The program that COMMAND starts ends with

    from stubborn_client import serve

    serve(MyAgent())

Code that is written for Habitat runs unchanged, with `--config agent.interface=habitat`; COMMAND is one of

    python stubborn_client.py evaluate.py ARGUMENTS             # the agent that it gives to Benchmark or Challenge
    python stubborn_client.py package.module:CLASS NAME=VALUE   # arguments of its constructor

If Habitat is not installed, this file provides the names of Habitat that agents import.

An agent has two methods. `reset(goal, seed)` starts an episode; `goal` is a category such as "chair".
`act(observation)` returns the next action: 0 STOP, 1 MOVE_FORWARD, 2 TURN_LEFT or 3 TURN_RIGHT; with `--config
agent.looks=true` also 4 LOOK_UP or 5 LOOK_DOWN, which tilt the camera by 30 degrees. The observation is a dict of
arrays: `rgb` uint8 (h, w, 3), `depth` float32 (h, w) in metres, `gps` float32 (2,), `compass` float32 (1,) and
`objectgoal` int64 (1,). With goals in words, `goal` is the words, such as "the red chair". With pictures it is "", and
the observation has the picture, `goal_picture` uint8 (h, w, 3). `objectgoal` is -1 in both cases.

An agent with Habitat's interface may also be served: `reset()` and `act(observations)`, whose observations and actions
are Habitat's. The generators of `random`, NumPy and PyTorch are seeded before each episode.

Further methods are optional. `next_goal(goal)` is called in place of `reset` for each goal of a chain after the first
one, so that the agent keeps its memory. `stop_confidence()` and `stop_target_xy_m()` are called after STOP.
`map_image()` returns the agent's map for videos, uint8 RGB (h, w, 3), and `state()` returns a few words on what the
agent is doing.

`serve` also takes a class or a function that gets the description of the task and returns the agent:
`make(setup)` with `setup.camera.width_px`, `height_px`, `hfov_rad`, `height_m`, `min_depth_m`, `max_depth_m`,
`setup.robot.radius_m`, `height_m`, `setup.success.distance_m`, `setup.max_steps`, `setup.looks`, whether the agent may
return LOOK_UP and LOOK_DOWN, `setup.goals`, the categories in the order of `objectgoal`, and `setup.labels`, those in
the order of the numbers in `semantic` images.

Protocol: messages pass through standard input and output, so that any program which forwards these (ssh, docker run -i)
can connect the two processes. What the agent prints goes to standard error. A message consists of `PREFIX` (mark,
version, number of bytes of the header and of the arrays), a header in JSON, and the arrays, little-endian in C order,
one after the other. Each request has a number, which its answer repeats.
"""

import json
import math
import operator
import os
import random
import select
import struct
import sys
import threading
import time
import traceback
from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any

try:
    import numpy as np
except ImportError:
    sys.exit("stubborn_client.py needs NumPy in the Python of the agent, " + sys.executable)

VERSION = 2
"""Version of the protocol; both sides must have the same."""
MARK = b"\x89STUBB\r\n"
"""The first bytes of each message."""
PREFIX = struct.Struct("<8sIIQ")
"""Mark, version, bytes of the header, bytes of the arrays."""
MAX_HEADER_BYTES = 1 << 16
MAX_ARRAY_BYTES = 1 << 29
"""Largest size of the arrays of a message."""
DTYPES = ("|b1", "|u1", "|i1", "<u2", "<i2", "<u4", "<i4", "<u8", "<i8", "<f2", "<f4", "<f8")
"""Allowed types of array elements, in NumPy's notation."""
LAST_WORDS_S = 5.0
"""Longest time in which the agent may end by itself after the simulator has ended."""
STOP, MOVE_FORWARD, TURN_LEFT, TURN_RIGHT, LOOK_UP, LOOK_DOWN = range(6)
HABITAT_ACTIONS = {
    "stop": STOP, "move_forward": MOVE_FORWARD, "turn_left": TURN_LEFT, "turn_right": TURN_RIGHT, "look_up": LOOK_UP,
    "look_down": LOOK_DOWN,
}  # fmt: skip
"""The actions by Habitat's names. The last two tilt the camera; `--config agent.looks=true` declares them."""
ACTIONS = "0 STOP, 1 MOVE_FORWARD, 2 TURN_LEFT, 3 TURN_RIGHT"


class ProtocolError(Exception):
    """The other side sent bytes that are not a valid message."""


def pack(header, arrays=None):
    """Returns a message as a list of buffers to be written one after the other.

    Args:
        header: JSON types; has `type` and `id`.
        arrays: NumPy arrays by name, of `DTYPES`.
    """
    described, buffers, size = [], [], 0
    for name, array in (arrays or {}).items():
        array = np.ascontiguousarray(array).reshape(np.shape(array))
        array = array.astype(array.dtype.newbyteorder("<"), copy=False)
        described.append({"name": name, "dtype": array.dtype.str, "shape": list(array.shape)})
        buffers.append(array.reshape(-1).view(np.uint8).data)
        size += array.nbytes
    head = json.dumps(dict(header, arrays=described)).encode()
    if len(head) > MAX_HEADER_BYTES or size > MAX_ARRAY_BYTES:
        raise ProtocolError(f"a message of {len(head)} + {size} bytes is too large")
    return [PREFIX.pack(MARK, VERSION, len(head), size) + head] + [buffer for buffer in buffers if len(buffer)]


def sizes_of(prefix):
    """Returns the bytes of header and arrays that a prefix announces; raises ProtocolError if it is not valid."""
    mark, version, header_bytes, array_bytes = PREFIX.unpack(prefix)
    if mark != MARK:
        raise ProtocolError(f"a message does not begin with {prefix!r}")
    if version != VERSION:
        raise ProtocolError(f"version {version} of the protocol, not {VERSION}: copy stubborn_client.py again")
    if header_bytes > MAX_HEADER_BYTES or array_bytes > MAX_ARRAY_BYTES:
        most = f"{MAX_HEADER_BYTES} + {MAX_ARRAY_BYTES}"
        raise ProtocolError(f"a message of {header_bytes} + {array_bytes} bytes is too large, at most {most}")
    return header_bytes, array_bytes


class Observation(dict):
    """The observation of one step: a dict of arrays by the name of the sensor."""

    def __missing__(self, name):
        raise KeyError("no observation {!r}; there are {}".format(name, ", ".join(self)))


def unpack_arrays(described, content):
    """Returns the arrays of a message by name, as views of its content.

    Args:
        described: a list of dicts, each with `name`, `dtype` and `shape` of an array.
        content: the bytes of the arrays.

    Raises:
        ProtocolError: the description does not fit the content.
    """
    observation, begin = Observation(), 0
    for description in described:
        if description["dtype"] not in DTYPES:
            raise ProtocolError("array '{}' has the type {!r}".format(description["name"], description["dtype"]))
        dtype, count = np.dtype(description["dtype"]), 1
        for side in description["shape"]:
            count *= int(side)
        if min(description["shape"], default=0) < 0 or begin + count * dtype.itemsize > len(content):
            raise ProtocolError("array '{}' of shape {} is truncated".format(description["name"], description["shape"]))
        observation[description["name"]] = np.frombuffer(content, dtype, count, begin).reshape(description["shape"])
        begin += count * dtype.itemsize
    if begin != len(content):
        raise ProtocolError(f"{len(content) - begin} bytes follow the last array")
    return observation


def serve(agent):
    """Runs episodes with an agent until the simulator ends.

    Args:
        agent: an object with `reset` and `act`, or a class or function that gets the setup and returns one.
    """
    link, client = Link.of_this_process(), _Client(agent)
    request, content = link.first
    while request is not None and request["type"] != "end":
        try:
            answer, arrays = client.answer(request, content)
            buffers = pack(dict(answer, id=request["id"]), arrays)
        except Exception as error:  # the agent raised it; the simulator ends the episode
            traceback.print_exc()
            buffers = pack({"type": "error", "error": _text_of(error), "id": request["id"]}, {})
        for buffer in buffers:
            _write(link.sink, buffer)
        request, content = _receive(link.source)


class Link:
    """The connection to the simulator: its pipes, and its first request, which describes the task."""

    _made = None

    def __init__(self):
        if os.isatty(0):
            sys.exit("This agent is started by a simulator: stubborn run --agent 'process:COMMAND'.")
        self.source, self.sink = _take_pipes()
        threading.Thread(target=_end_with_simulator, args=(self.source,), daemon=True, name="simulator").start()
        self.first = _receive(self.source)

    @classmethod
    def of_this_process(cls):
        """Returns the connection, which a process has once."""
        cls._made = cls._made or cls()
        return cls._made


class _Client:
    """Answers the requests of the simulator."""

    def __init__(self, agent):
        self.agent = agent
        self.interface = "stubborn"

    def answer(self, request, content):
        """Returns the header of the answer to a request, and its arrays."""
        kind = request["type"]
        if kind == "start":
            return self.start(request), {}
        if kind == "reset":
            self.reset(request["goal"], request["seed"])
            return {"type": "done"}, {}
        if kind == "next_goal":
            self.agent.next_goal(request["goal"])
            return {"type": "done"}, {}
        if kind == "act":
            return self.act(unpack_arrays(request["arrays"], content)), {}
        if kind == "map":
            state = str(self.agent.state()) if hasattr(self.agent, "state") else ""
            return {"type": "map", "state": state[:1000]}, {"map": _map_of(self.agent)}
        raise ProtocolError(f"there is no request {kind!r}")

    def start(self, request):
        self.interface = request["setup"].get("interface", self.interface)
        if isinstance(self.agent, type) or not hasattr(self.agent, "act"):
            self.agent = self.agent(_as_namespace(request["setup"]))
        for method in ("reset", "act"):
            if not callable(getattr(self.agent, method, None)):
                raise TypeError(f"the agent {self.agent!r} has no method '{method}'")
        python = ".".join(str(part) for part in sys.version_info[:3])
        keeps_memory = callable(getattr(self.agent, "next_goal", None))
        has = {"draws_map": hasattr(self.agent, "map_image"), "keeps_memory": keeps_memory}
        return dict(has, type="ready", python=python)

    def reset(self, goal, seed):
        if self.interface != "habitat":
            self.agent.reset(goal, seed)
            return
        seed_generators(seed)
        self.agent.reset()

    def act(self, observation):
        chosen = self.agent.act(observation)
        try:
            action = operator.index(from_habitat(chosen) if self.interface == "habitat" else chosen)
        except TypeError:
            raise TypeError(f"act() returned {chosen!r:.100}; an action is one of {ACTIONS}") from None
        answer = {"type": "action", "action": action}
        if action == STOP and hasattr(self.agent, "stop_confidence"):
            answer["stop_confidence"] = _number(self.agent.stop_confidence())
        if action == STOP and hasattr(self.agent, "stop_target_xy_m"):
            place = self.agent.stop_target_xy_m()
            answer["stop_target_xy_m"] = None if place is None else [_number(number) for number in place]
        return answer


def seed_generators(seed):
    """Seeds the generators from which agents with Habitat's interface draw: those agents get no seed."""
    random.seed(seed)
    np.random.seed(seed % 2**32)  # noqa: NPY002 - agents draw from it
    if "torch" in sys.modules:
        sys.modules["torch"].manual_seed(seed)


def from_habitat(action: Any) -> Any:
    """Returns the number of an action in one of Habitat's forms: a number, a name, or a dict with the key `action`.

    A number may be a tensor or array of one element. Anything else is returned unchanged.

    Raises:
        TypeError: it is a truth value.
    """
    inner: Any = action
    for _ in range(3):  # a dict may hold itself
        inner = inner["action"] if isinstance(inner, Mapping) and "action" in inner else inner
    if isinstance(inner, (list, tuple)) and len(inner) == 1:
        inner = inner[0]
    if isinstance(inner, bool) or "bool" in str(getattr(inner, "dtype", "")):
        raise TypeError("a truth value is not an action")
    if isinstance(inner, str):
        return HABITAT_ACTIONS.get(inner.lower(), inner)
    shape = getattr(inner, "shape", ())
    if shape != () and np.prod(shape) == 1:  # an array or tensor of one element
        return getattr(inner, "reshape")(-1)[0]  # noqa: B009 - of an unknown class
    return inner


def _take_pipes():
    """Returns copies of standard input and output for the protocol; from here on, `print` writes to standard error."""
    sys.stdout.flush()
    source, sink = os.dup(0), os.dup(1)
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    os.close(nothing)
    os.dup2(2, 1)
    return source, sink


def _end_with_simulator(source):
    """Ends this process soon after the simulator has closed its pipe, also in the middle of a call."""
    watch = select.poll()
    watch.register(source, 0)  # reports only that the other side has closed the pipe
    while not any(event & (select.POLLHUP | select.POLLERR | select.POLLNVAL) for _, event in watch.poll()):
        pass
    time.sleep(LAST_WORDS_S)
    os._exit(1)


def _receive(source):
    """Returns header and arrays of the next message; None and None at the end of the pipe."""
    prefix = _read(source, PREFIX.size)
    if prefix is None:
        return None, None
    header_bytes, array_bytes = sizes_of(prefix)
    header, content = _read(source, header_bytes), _read(source, array_bytes)
    if header is None or content is None:
        return None, None
    return json.loads(bytes(header).decode()), content


def _read(source, count):
    """Returns this number of bytes; None if the pipe is closed before they have arrived."""
    content, done = np.empty(count, np.uint8), 0
    view = content.data
    while done < count:
        got = os.readv(source, [view[done:]])
        if not got:
            return None
        done += got
    return content


def _write(sink, buffer):
    view = memoryview(buffer).cast("B")
    while len(view):
        view = view[os.write(sink, view) :]


def _map_of(agent):
    """Returns the agent's map, uint8 RGB (h, w, 3)."""
    image = np.asarray(agent.map_image())
    if image.dtype != np.uint8 or image.ndim != 3 or image.shape[2] != 3 or 0 in image.shape:
        raise TypeError(f"map_image() returned {image.dtype} {image.shape}; a map is uint8 of shape (h, w, 3)")
    return image


def _number(value):
    """Returns a number of the agent as a Python float; None if it is None."""
    if value is not None and not math.isfinite(value):
        raise TypeError(f"stop_confidence() and stop_target_xy_m() return finite numbers, got {value!r}")
    return None if value is None else float(value)


def _as_namespace(value):
    """Returns JSON objects as objects with attributes."""
    if isinstance(value, dict):
        return SimpleNamespace(**{name: _as_namespace(item) for name, item in value.items()})
    return value


def _text_of(error):
    """Returns an error in one line, with file and line of the agent's code."""
    text = " ".join(f"{type(error).__name__}: {error}".split())[:2000]
    frames = traceback.extract_tb(error.__traceback__)
    frame = next((frame for frame in reversed(frames) if frame[0] != __file__ and not frame[0].startswith("<")), None)
    return text if frame is None else f"{text} ({os.path.basename(frame[0])}, line {frame[1]})"
