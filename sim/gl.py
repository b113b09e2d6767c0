"""Imports MuJoCo after choosing an OpenGL backend that works without a display.

MuJoCo reads `MUJOCO_GL` while it is imported. Every module of `sim` therefore writes `from sim.gl import mujoco` and
never `import mujoco`.
"""

from __future__ import annotations

import ctypes
import os

from sim.errors import RenderError

INSTALL_HINT = "apt-get install -y libegl1 libegl-mesa0 libgl1-mesa-dri"
"""Command that installs offscreen rendering on Debian and Ubuntu."""


def _loads(library: str) -> bool:
    try:
        ctypes.CDLL(library)
    except OSError:
        return False
    return True


def choose_backend() -> str:
    """Returns the OpenGL backend: the user's `MUJOCO_GL` if set, else `egl`, else `osmesa`.

    Raises:
        RenderError: neither library is installed.
    """
    chosen = os.environ.get("MUJOCO_GL", "").strip().lower()
    if chosen:
        return chosen
    if _loads("libEGL.so.1"):
        return "egl"
    if any(_loads(f"libOSMesa.so.{version}") for version in (8, 6)):
        return "osmesa"
    raise RenderError(
        f"No OpenGL for offscreen rendering: neither libEGL nor libOSMesa is installed. Try: {INSTALL_HINT}"
    )


_rendering_pid: int | None = None
"""The process that created the first OpenGL context."""


def is_forked() -> bool:
    """Returns whether this process was forked from one with an OpenGL context."""
    return _rendering_pid not in (None, os.getpid())


def begin_rendering() -> None:
    """Must be called before an OpenGL context is created or used.

    Raises:
        RenderError: this process was forked from one with an OpenGL context. The threads of its driver are missing, so
            rendering would hang.
    """
    global _rendering_pid
    if is_forked():
        raise RenderError(
            "OpenGL does not survive a fork, and this process was forked from one that had rendered. Start workers "
            'with spawn; for Gymnasium: make_vec(..., vector_kwargs={"context": "spawn"}).'
        )
    _rendering_pid = os.getpid()


os.environ["MUJOCO_GL"] = choose_backend()
if os.environ["MUJOCO_GL"] in ("egl", "osmesa"):
    os.environ.setdefault("PYOPENGL_PLATFORM", os.environ["MUJOCO_GL"])
# llvmpipe divides each small frame among all cores and loses more by waiting than it gains.
os.environ.setdefault("LP_NUM_THREADS", "1")
# PyTorch's threads spin for milliseconds while they wait for each other. With two other processes on two cores, a
# frame of the network then takes 200 ms; with this limit 62, and with one thread 44 (docs/performance.md).
os.environ.setdefault("GOMP_SPINCOUNT", "30000")

import mujoco  # noqa: E402


def _disable_log_file() -> None:
    """Stops MuJoCo from writing MUJOCO_LOG.TXT into the working directory."""
    config = mujoco.MjLogConfig.get()
    config.logto_file = False
    config.set()


_disable_log_file()

__all__ = ["INSTALL_HINT", "begin_rendering", "choose_backend", "is_forked", "mujoco"]
