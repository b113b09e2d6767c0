"""Starts an agent's command and ends it, with all processes that it has started, as soon as the simulator is gone.

A program of its own between the simulator and the agent: it needs nothing but Python, and is alive when either of the
two is killed. It learns that the simulator is gone from the end of the control socket.

    python process_guard.py CONTROL COMMAND ...

CONTROL is the number of an open socket to the simulator. The guard writes one line to it: `ended STATUS`, `killed
SIGNAL` or `failed REASON`, once the command has ended or could not be started.
"""

from __future__ import annotations

import contextlib
import ctypes
import os
import select
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator

TICK_S = 0.02
"""Interval at which the command is looked at where the kernel has no file descriptors for processes."""
ENDING_S = 3.0
"""Longest time for which processes are ended; those of a fork bomb may come faster than they go."""
_PR_SET_PDEATHSIG, _PR_SET_CHILD_SUBREAPER = 1, 36  # sys/prctl.h


def main(control: socket.socket, command: list[str]) -> None:
    """Runs the command until it ends or the simulator is gone, then ends all that is left of it."""
    _prctl(_PR_SET_CHILD_SUBREAPER, 1)  # processes whose parent has ended become children of this one
    try:
        # A session of its own, so that Ctrl-C does not reach it.
        agent = subprocess.Popen(command, start_new_session=True, preexec_fn=_end_with_guard)
    except (OSError, ValueError, subprocess.SubprocessError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        _say(control, f"failed {reason}: '{command[0]}'")
        return
    nothing = os.open(os.devnull, os.O_RDWR)
    for number in (0, 1, 2):  # the pipes belong to the agent alone, whose end closes them
        os.dup2(nothing, number)
    _wait(agent, control)
    status = agent.poll()
    _end_all(agent)
    if status is not None:
        _say(control, f"ended {status}" if status >= 0 else f"killed {-status}")


def _wait(agent: subprocess.Popen[bytes], control: socket.socket) -> None:
    """Returns when the agent has ended or the simulator is gone."""
    watch, tick_ms = select.poll(), TICK_S * 1e3
    watch.register(control, select.POLLIN)
    with contextlib.suppress(OSError, AttributeError):  # neither old kernels nor macOS have it
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
            time.sleep(0.002)  # some are still ending
            continue
        return


def _descendants() -> Iterator[int]:
    """Yields the ids of all processes that descend from this one."""
    parents: dict[int, int] = {}
    for name in os.listdir("/proc") if os.path.isdir("/proc") else ():
        with contextlib.suppress(OSError, ValueError, IndexError), open(f"/proc/{int(name)}/stat", "rb") as stream:
            parents[int(name)] = int(stream.read().rpartition(b")")[2].split()[1])
    found = {os.getpid()}
    while more := {process for process, parent in parents.items() if parent in found} - found:
        yield from more
        found |= more


def _end_with_guard() -> None:
    """Has Linux end the agent where the guard itself is killed; runs in the agent's process before its program."""
    _prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)


def _prctl(option: int, value: int) -> None:
    with contextlib.suppress(OSError, AttributeError):  # not Linux
        ctypes.CDLL(None).prctl(option, value)


def _say(control: socket.socket, line: str) -> None:
    with contextlib.suppress(OSError):  # the simulator is gone
        control.sendall(line.encode(errors="replace") + b"\n")


if __name__ == "__main__":
    main(socket.socket(fileno=int(sys.argv[1])), sys.argv[2:])
