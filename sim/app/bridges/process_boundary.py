"""Namespaces of Linux around an agent's process, which `process_guard` enters before it starts the command.

In them, the agent sees no process but its own, no network, and none of the hidden files and folders. It needs no
privileges where the kernel lets users make namespaces. This module needs nothing but Python.

    python process_boundary.py

exits with 0 where the kernel allows such namespaces, else it prints the reason.
"""

from __future__ import annotations

import ctypes
import errno
import os
import signal
import subprocess
import sys
from collections.abc import Iterable

# linux/sched.h, linux/mount.h, linux/prctl.h
_NEWNS, _NEWUTS, _NEWIPC, _NEWUSER, _NEWPID, _NEWNET = 0x20000, 0x4000000, 0x8000000, 0x10000000, 0x20000000, 0x40000000
_RDONLY, _NOSUID, _NODEV, _NOEXEC, _BIND, _REC, _PRIVATE = 0x1, 0x2, 0x4, 0x8, 0x1000, 0x4000, 0x40000
_PR_SET_PDEATHSIG, _PR_CAPBSET_DROP, _PR_SET_NO_NEW_PRIVS = 1, 24, 38
_CAPABILITIES = 64


def enter(hidden: Iterable[str]) -> None:
    """Moves this process into namespaces in which files and folders are hidden; its children get one for processes.

    Raises:
        OSError: the kernel does not allow it, or a path does not exist.
    """
    uid, gid = os.getuid(), os.getgid()
    _call("unshare", _NEWUSER | _NEWNS | _NEWPID | _NEWNET | _NEWIPC | _NEWUTS)
    for name, content in (("setgroups", "deny"), ("uid_map", f"{uid} {uid} 1"), ("gid_map", f"{gid} {gid} 1")):
        with open(f"/proc/self/{name}", "w") as stream:
            stream.write(content)
    _call("mount", None, b"/", None, _REC | _PRIVATE, None)
    covered = ""
    for path in sorted(map(os.path.realpath, hidden), key=lambda path: path.split(os.sep)):  # folders before content
        if covered and os.path.commonpath((covered, path)) == covered:
            continue  # it is in a folder that is hidden already
        if not os.path.lexists(path):
            raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), path)
        covered = path
        if os.path.isdir(path):
            _call("mount", b"none", os.fsencode(path), b"tmpfs", _RDONLY | _NOSUID | _NODEV | _NOEXEC, None)
        else:
            _call("mount", b"/dev/null", os.fsencode(path), None, _BIND, None)


def begin(report: int) -> None:
    """Becomes the first process of the namespace and returns in its child, which may start the command.

    The first process is the parent of all that lose theirs. When it ends, the kernel ends all others. It writes the
    status of its child, as `os.wait` has it, to the file descriptor `report`. It runs after the fork of `subprocess`.
    """
    _call("prctl", _PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)
    _call("unshare", _NEWNS)
    _call("mount", b"proc", b"/proc", b"proc", _NOSUID | _NODEV | _NOEXEC, None)
    child = os.fork()
    if child == 0:
        os.close(report)
        _give_up_capabilities()
        return
    nothing = os.open(os.devnull, os.O_RDWR)
    for number in (0, 1, 2):  # only the agent holds the pipes, so that they are closed when it ends
        os.dup2(nothing, number)
    os.closerange(3, report)
    os.closerange(report + 1, os.sysconf("SC_OPEN_MAX"))
    ended, status = 0, 0
    while ended != child:
        ended, status = os.wait()
    os.write(report, str(status).encode())
    os._exit(0)


def _give_up_capabilities() -> None:
    """Removes the right to undo the mounts, which root has in its namespace, from this process and its children."""
    for number in range(_CAPABILITIES):
        ctypes.CDLL(None).prctl(_PR_CAPBSET_DROP, number, 0, 0, 0)  # later ones do not exist
    _call("prctl", _PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0)


def _call(name: str, *arguments: object) -> None:
    """Calls a function of the C library; raises OSError where it fails or does not exist."""
    library = ctypes.CDLL(None, use_errno=True)
    if getattr(library, name, lambda *_: -1)(*arguments) != 0:
        number = ctypes.get_errno()
        raise OSError(number, f"{name}: {os.strerror(number)}")


def main() -> None:
    """Tries the namespaces."""
    reading, report = os.pipe()
    try:
        enter(())
        subprocess.run(["/bin/true"], preexec_fn=lambda: begin(report), pass_fds=(report,), check=True)
    except (OSError, subprocess.SubprocessError) as error:
        sys.exit(getattr(error, "strerror", None) or str(error))
    sys.exit(0 if os.read(reading, 20) == b"0" else "the command has failed")


if __name__ == "__main__":
    main()
