"""Starts an agent's command and ends it, with all processes that it has started, as soon as the simulator has ended.

The guard is a program of its own between the simulator and the agent, so that it still runs if either of the two is
killed. It needs nothing but Python. When the simulator has ended, the control socket is closed.

    python process_guard.py CONTROL HIDDEN COMMAND ...

CONTROL is the number of an open socket to the simulator. HIDDEN is JSON: null, or a list of paths, for a command in
namespaces in which they are hidden (`process_boundary`). When the command has ended or could not be started, the guard
writes one line to CONTROL: `ended STATUS`, `killed SIGNAL` or `failed REASON`.
"""

from __future__ import annotations

import contextlib
import ctypes
import functools
import json
import os
import select
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator

TICK_S = 0.02
"""Interval at which the command is checked if the kernel has no file descriptors for processes."""
ENDING_S = 3.0
"""Longest time for which processes are killed; a fork bomb may start them faster than they can be killed."""
_PR_SET_PDEATHSIG, _PR_SET_CHILD_SUBREAPER = 1, 36  # sys/prctl.h


def main(control: socket.socket, hidden: list[str] | None, command: list[str]) -> None:
    """Runs the command until it or the simulator has ended, then kills all processes of the command that remain."""
    _prctl(_PR_SET_CHILD_SUBREAPER, 1)  # processes whose parent has ended become children of this one
    reading, report = os.pipe()
    begin, passed = _end_with_guard, ()
    try:
        if hidden is not None:
            sys.path.append(os.path.dirname(os.path.abspath(__file__)))  # this file is run without the user's modules
            import process_boundary  # pyright: ignore[reportMissingImports]

            process_boundary.enter(hidden)
            begin, passed = functools.partial(process_boundary.begin, report), (report,)
        # The command gets a session of its own, so that Ctrl-C does not reach it.
        agent = subprocess.Popen(command, start_new_session=True, preexec_fn=begin, pass_fds=passed)
    except (OSError, ValueError, subprocess.SubprocessError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        _say(control, f"failed {reason}: '{getattr(error, 'filename', None) or command[0]}'")
        return
    nothing = os.open(os.devnull, os.O_RDWR)
    for number in (0, 1, 2):  # only the agent holds the pipes from here on, so that they are closed when it ends
        os.dup2(nothing, number)
    os.close(report)
    _wait(agent, control)
    status = agent.poll()
    if hidden is not None and status is not None:  # that of the first process of the namespace
        status = os.waitstatus_to_exitcode(int(os.read(reading, 20) or b"9"))
    _end_all(agent)
    if status is not None:
        _say(control, f"ended {status}" if status >= 0 else f"killed {-status}")


def _wait(agent: subprocess.Popen[bytes], control: socket.socket) -> None:
    """Waits until the agent or the simulator has ended."""
    watch, tick_ms = select.poll(), TICK_S * 1e3
    watch.register(control, select.POLLIN)
    with contextlib.suppress(OSError, AttributeError):  # old kernels and macOS do not have it
        watch.register(os.pidfd_open(agent.pid), select.POLLIN)
        tick_ms = None
    while agent.poll() is None:
        if any(number == control.fileno() for number, _ in watch.poll(tick_ms)):
            return


def _end_all(agent: subprocess.Popen[bytes]) -> None:
    """Kills the group of the agent, then every other process that descends from it."""
    with contextlib.suppress(OSError):
        os.killpg(agent.pid, signal.SIGKILL)
    until_s = time.monotonic() + ENDING_S
    while time.monotonic() < until_s:
        for process in _descendants():
            with contextlib.suppress(OSError):
                os.kill(process, signal.SIGKILL)
        with contextlib.suppress(ChildProcessError):
            while os.waitpid(-1, os.WNOHANG)[0]:
                pass
            time.sleep(0.002)  # some processes have not ended yet
            continue
        return


def _descendants() -> Iterator[int]:
    """Yields the ids of all processes that descend from this one."""
    parents: dict[int, int] = {}
    for name in os.listdir("/proc") if os.path.isdir("/proc") else ():
        with contextlib.suppress(OSError, ValueError, IndexError), open(f"/proc/{int(name)}/stat", "rb") as stream:
            parents[int(name)] = int(stream.read().rpartition(b")")[2].split()[1])
    pids = {os.getpid()}
    while more := {process for process, parent in parents.items() if parent in pids} - pids:
        yield from more
        pids |= more


def _end_with_guard() -> None:
    """Makes Linux kill the agent if the guard is killed; it runs in the agent's process before the command."""
    _prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)


def _prctl(option: int, value: int) -> None:
    with contextlib.suppress(OSError, AttributeError):  # not Linux
        ctypes.CDLL(None).prctl(option, value)


def _say(control: socket.socket, line: str) -> None:
    with contextlib.suppress(OSError):  # the simulator has ended
        control.sendall(line.encode(errors="replace") + b"\n")


if __name__ == "__main__":
    main(socket.socket(fileno=int(sys.argv[1])), json.loads(sys.argv[2]), sys.argv[3:])
