"""The one door to MuJoCo: an OpenGL that works without a display is chosen before `mujoco` is imported.

`MUJOCO_GL` is read while `mujoco` is imported, so the choice has to come first. Every module of `sim` therefore
writes `from sim.gl import mujoco` and never `import mujoco`.
"""

from __future__ import annotations

import ctypes
import os

from sim.errors import RenderError

INSTALL_HINT = "apt-get install -y libegl1 libegl-mesa0 libgl1-mesa-dri"
"""The one line that makes offscreen rendering work on Debian and Ubuntu."""


def _loads(library: str) -> bool:
    try:
        ctypes.CDLL(library)
    except OSError:
        return False
    return True


def choose_backend() -> str:
    """Name of the OpenGL backend to take: the user's `MUJOCO_GL` if set, else EGL, else OSMesa.

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


_drawing_pid: int | None = None
"""The process that made the first OpenGL context."""


def begin_drawing() -> None:
    """To be called before an OpenGL context is made.

    Raises:
        RenderError: this process was forked from one that had drawn; its driver's threads are gone and it would hang.
    """
    global _drawing_pid
    if _drawing_pid not in (None, os.getpid()):
        raise RenderError(
            "OpenGL does not survive a fork, and this process was forked from one that had drawn. Start workers with "
            'spawn; for Gymnasium: make_vec(..., vector_kwargs={"context": "spawn"}).'
        )
    _drawing_pid = os.getpid()


os.environ["MUJOCO_GL"] = choose_backend()
if os.environ["MUJOCO_GL"] in ("egl", "osmesa"):
    os.environ.setdefault("PYOPENGL_PLATFORM", os.environ["MUJOCO_GL"])
# llvmpipe spreads one small frame over all cores and loses more in waiting than it gains.
os.environ.setdefault("LP_NUM_THREADS", "1")

import mujoco  # noqa: E402

__all__ = ["INSTALL_HINT", "begin_drawing", "choose_backend", "mujoco"]
