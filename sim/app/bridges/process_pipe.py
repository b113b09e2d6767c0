"""Starts the process of an agent and exchanges messages with it: one answer for each request, within a time limit.

The process and all processes that it has started are ended when an exchange fails, when `close` is called, and when
the simulator has ended (`process_guard`). Nothing waits without a limit and no queue grows: what the agent prints is
read while an exchange runs, and only its end is kept.
"""

from __future__ import annotations

import codecs
import contextlib
import fcntl
import json
import os
import re
import select
import signal
import socket
import subprocess
import sys
import time
import weakref
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple, TypeVar

from numpy.typing import NDArray

from sim.app.bridges import stubborn_client
from sim.app.bridges.stubborn_client import MARK, PREFIX, ProtocolError
from sim.app.evaluation.own_code import one_line
from sim.app.evaluation.watch import TICK_S
from sim.core.errors import AgentError
from sim.core.reading import parse_json, printable

T = TypeVar("T")
MAX_ANSWER_BYTES = 64 << 20
"""Largest size of the arrays of an answer: a map of 4600 x 4600 pixels."""
TAIL_LINES, TAIL_BYTES = 6, 2000
"""Number of the last lines of standard error that an error message repeats, and of the bytes that are kept."""
PRINTED_BYTES = 1 << 16
"""Largest number of bytes of an agent's output that the terminal shows in each episode."""
GUARD = Path(__file__).with_name("process_guard.py")
ENVIRONMENT = frozenset((
    "PATH", "HOME", "USER", "LANG", "TERM", "TMPDIR", "TZ", "VIRTUAL_ENV", "CONDA_PREFIX", "PYTHONPATH",
    "LD_LIBRARY_PATH", "CUDA_VISIBLE_DEVICES", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS",
))  # fmt: skip
"""Variables of the environment that a process in namespaces gets, with those of the locale (LC_...)."""
CLOSING_S = 2.0
"""Longest time in which the agent may end by itself after its pipe was closed."""
GUARD_S = 5.0
"""Longest time in which the guard may end all processes of the agent."""
_PIPE_BYTES = 1 << 20
"""Size of the pipes, the largest that Linux allows without privileges."""
_CHUNK_BYTES = 1 << 20
_COLOURS = re.compile(r"\x1b\[[0-9;]*m")
"""Sequences for colours in a terminal; other sequences are shown as escapes."""


class Answer(NamedTuple):
    """An answer of the agent."""

    header: bytes
    """The header of the message, JSON."""
    content: memoryview
    """The bytes of its arrays."""

    def parsed(self, kind: type[T]) -> T:
        """Returns the header as the declared type; raises AgentError if it has another type."""
        return parse_json(self.header, kind, where="its answer", error=AgentError)


class AgentProcess:
    """A running process of an agent.

    Args:
        command: program and arguments.
        hidden: files and folders that the process does not see; it then runs in namespaces (`process_boundary`), with
            the variables of `ENVIRONMENT` only. None: it runs as any other process of the user.

    Raises:
        AgentError: the operating system does not start another process.
    """

    def __init__(self, command: Sequence[str], hidden: Sequence[str] | None = None) -> None:
        self._control, theirs = socket.socketpair()
        words = [sys.executable, "-I", "-S", str(GUARD), str(theirs.fileno()), json.dumps(hidden), *command]
        known = {name: value for name, value in os.environ.items() if name in ENVIRONMENT or name.startswith("LC_")}
        pipe = subprocess.PIPE
        try:
            self._guard = subprocess.Popen(
                words,
                bufsize=0,
                stdin=pipe,
                stdout=pipe,
                stderr=pipe,
                pass_fds=(theirs.fileno(),),
                env=None if hidden is None else known,
                start_new_session=True,
            )
        except OSError as error:
            self._control.close()
            raise AgentError(f"no process can be started: {error.strerror}") from None
        finally:
            theirs.close()
        streams = self._guard.stdin, self._guard.stdout, self._guard.stderr
        self._source, self._sink, self._printed = (stream.fileno() for stream in streams if stream is not None)
        for number in (self._source, self._sink, self._printed, self._control.fileno()):
            os.set_blocking(number, False)
        for number in (self._source, self._sink):
            with contextlib.suppress(OSError, AttributeError):  # not Linux
                fcntl.fcntl(number, fcntl.F_SETPIPE_SZ, _PIPE_BYTES)
        self._finalizer = weakref.finalize(self, _end, self._guard, self._control, CLOSING_S)
        self._poll = select.poll()
        for number in (self._sink, self._printed, self._control.fileno()):
            self._poll.register(number, select.POLLIN)
        self._received, self._tail, self._begun = bytearray(), bytearray(), False
        self._printed_bytes = 0
        self._decoder = codecs.getincrementaldecoder("utf-8")("replace")
        self._how_it_ended = ""
        """A text on how the process has ended, for messages; "" while it runs."""
        self._number = 0

    def ask(
        self, request: Mapping[str, object], arrays: Mapping[str, NDArray] | None = None, *, within_s: float
    ) -> Answer:
        """Sends a request and returns its answer.

        Args:
            request: header of the message, JSON types; it has the key `type`.
            arrays: arrays of the message by name; None: it has none.
            within_s: longest time until the whole answer has arrived.

        Raises:
            AgentError: no valid answer arrived; the process cannot be used any more and must be closed.
        """
        self._number += 1
        parts = stubborn_client.pack({**request, "id": self._number}, arrays)
        try:
            answer = self._exchange([memoryview(part).cast("B") for part in parts], within_s)
        except ProtocolError as fault:
            raise AgentError(f"its answer is not valid: {fault}") from None
        answered = answer.parsed(dict[str, object]).get("id")
        if answered != self._number:
            raise AgentError(f"it answered request {one_line(str(answered), 40)}, but {self._number} was asked")
        return answer

    def close(self, *, at_once: bool = False) -> None:
        """Ends the process and all that it has started; unless `at_once`, it may first end by itself in `CLOSING_S`."""
        if self._finalizer.detach() is None:
            return
        _end(self._guard, self._control, 0.0 if at_once else CLOSING_S)
        self._drain()
        for stream in (self._guard.stdout, self._guard.stderr):
            if stream is not None:
                stream.close()

    def new_episode(self) -> None:
        """Begins to count the printed bytes again; see `PRINTED_BYTES`."""
        self._printed_bytes = 0

    def last_lines(self) -> str:
        """Returns the last lines of the agent's standard error, in one line; "" if it printed nothing.

        Call it after `close`, when all output has been read.
        """
        text = self._tail[-TAIL_BYTES:].decode("utf-8", errors="replace")
        lines = [line.strip() for line in text.splitlines() if line.strip()][-TAIL_LINES:]
        return printable(" | ".join(lines))

    def _exchange(self, pending: list[memoryview], within_s: float) -> Answer:
        """Writes the parts of a request and returns the next message."""
        self._poll.register(self._source, select.POLLOUT)
        waited_s, looked_s = 0.0, time.monotonic()
        while True:
            if pending and self._begun and self._received:
                raise AgentError("it wrote to its standard output before it was asked")
            if not pending and (answer := self._next_message()) is not None:
                if self._received:
                    raise AgentError("it wrote more than one answer")
                return answer
            if self._how_it_ended:
                raise AgentError(f"its process {self._how_it_ended} before it answered")
            if waited_s >= within_s:
                raise AgentError(f"no answer within {within_s:g} s")
            for number, event in self._poll.poll(1e3 * min(TICK_S, within_s - waited_s)):
                if number == self._source:
                    pending = self._write(pending)
                else:
                    self._read(number, hung_up=not event & select.POLLIN)
            now_s = time.monotonic()  # time in which this process was stopped, for example by Ctrl-Z, does not count
            waited_s, looked_s = waited_s + min(now_s - looked_s, 2.0 * TICK_S), now_s

    def _write(self, pending: list[memoryview]) -> list[memoryview]:
        """Writes as much as the pipe accepts; returns the rest."""
        try:
            done = os.writev(self._source, pending) if pending else 0
        except BlockingIOError:
            return pending
        except OSError:
            self._poll.unregister(self._source)
            self._wait_for_end()
            how = self._how_it_ended or "closed its standard input"
            raise AgentError(f"its process {how} before it answered") from None
        while pending and done >= len(pending[0]):
            done -= len(pending.pop(0))
        if pending:
            pending[0] = pending[0][done:]
        else:
            self._poll.unregister(self._source)
        return pending

    def _read(self, number: int, *, hung_up: bool) -> None:
        """Reads what the agent or its guard has written."""
        try:
            content = b"" if hung_up else os.read(number, _CHUNK_BYTES)
        except OSError:
            content = b""
        if not content:
            self._poll.unregister(number)
        if number == self._sink:
            if not content:
                self._wait_for_end()
                self._how_it_ended = self._how_it_ended or "closed its standard output"
            self._received += content
        elif number == self._printed:
            self._keep(content)
        elif not self._how_it_ended:  # `_wait_for_end` may have read the line already
            self._how_it_ended = _end_in_words(content)
            self._drain()

    def _wait_for_end(self) -> None:
        """Waits up to `TICK_S` for the line of the guard: a closed pipe usually means that the process has ended."""
        if not self._how_it_ended and select.select([self._control], [], [], TICK_S)[0]:
            with contextlib.suppress(OSError):
                self._how_it_ended = _end_in_words(self._control.recv(_CHUNK_BYTES))
            self._drain()

    def _drain(self) -> None:
        """Reads all output that an agent had written before it ended."""
        for number, keep in ((self._sink, self._received.extend), (self._printed, self._keep)):
            with contextlib.suppress(OSError):  # the pipe is empty, and another process still holds it open
                while content := os.read(number, _CHUNK_BYTES):
                    keep(content)

    def _keep(self, printed: bytes) -> None:
        """Keeps the end of the agent's output for messages, and prints the beginning of it."""
        self._tail = (self._tail + printed)[-TAIL_BYTES:]
        before = self._printed_bytes
        self._printed_bytes += len(printed)
        shown = self._decoder.decode(printed[: max(0, PRINTED_BYTES - before)])
        if before <= PRINTED_BYTES < self._printed_bytes:
            shown += "\n[the agent prints more, which is left out]\n"
        if shown:
            with contextlib.suppress(OSError, ValueError):
                sys.stderr.write(printable(_COLOURS.sub("", shown.replace("\r\n", "\n").replace("\r", "\n"))))

    def _next_message(self) -> Answer | None:
        """Removes the next message from the received bytes and returns it; None while it is not complete.

        Raises:
            ProtocolError: the bytes are not a message.
        """
        if not self._begun:  # modules of the agent may print before `serve` is called
            begin = self._received.find(MARK)
            keep = len(MARK) - 1 if begin < 0 else len(self._received) - begin
            text = self._received[: max(0, len(self._received) - keep)]
            self._keep(bytes(text))
            del self._received[: len(text)]
            self._begun = begin >= 0
        if len(self._received) < (PREFIX.size if self._begun else PREFIX.size + len(MARK)):
            return None
        header_bytes, array_bytes = stubborn_client.sizes_of(bytes(self._received[: PREFIX.size]))
        if array_bytes > MAX_ANSWER_BYTES:
            raise ProtocolError(f"its arrays have {array_bytes} bytes, at most {MAX_ANSWER_BYTES}")
        begin = PREFIX.size + header_bytes
        if len(self._received) < begin + array_bytes:
            return None
        message = bytes(self._received[: begin + array_bytes])
        del self._received[: begin + array_bytes]
        return Answer(message[PREFIX.size : begin], memoryview(message)[begin:])


def _end_in_words(line: bytes) -> str:
    """Returns the words for a message on how the process has ended, from the line that its guard wrote."""
    kind, _, value = line.decode(errors="replace").strip().partition(" ")
    if kind == "ended":
        return f"ended with status {value}"
    if kind == "killed":
        return f"was ended by {_signal_name(int(value))}"
    return f"could not be started ({value})" if kind == "failed" else "was lost"


def _signal_name(number: int) -> str:
    try:
        return signal.Signals(number).name
    except ValueError:
        return f"signal {number}"


def _end(guard: subprocess.Popen[bytes], control: socket.socket, within_s: float) -> None:
    """Closes the pipe of an agent and waits for its end; then its guard ends all processes that remain."""
    assert guard.stdin is not None
    guard.stdin.close()
    with contextlib.suppress(OSError, ValueError):
        select.select([control], [], [], within_s)
    control.close()
    guard.send_signal(signal.SIGCONT)  # the agent, a process of the same user, may have stopped its guard
    try:
        guard.wait(GUARD_S)
    except subprocess.TimeoutExpired:
        guard.kill()
        guard.wait()
