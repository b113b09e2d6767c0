"""Imports MuJoCo after choosing an OpenGL backend that works without a display.

MuJoCo reads `MUJOCO_GL` while it is imported. Every module of `sim` therefore writes `from sim.gl import mujoco` and
never `import mujoco`.
"""

from __future__ import annotations

import ctypes
import importlib
import os
import shutil
import sys
from typing import Any

from sim.core.errors import RenderError

INSTALL_HINT = "apt-get install -y libegl1 libegl-mesa0 libgl1-mesa-dri"
"""Command that installs offscreen rendering on Debian and Ubuntu."""


_REMEDY = f"Unset MUJOCO_GL and PYOPENGL_PLATFORM, or install OpenGL: {INSTALL_HINT}"
_LIBRARIES = {"egl": ("libEGL.so.1",), "osmesa": ("libOSMesa.so.8", "libOSMesa.so.6")}
"""The libraries of each backend, of which one must be installed."""


def _is_installed(backend: str) -> bool:
    return any(_loads(library) for library in _LIBRARIES[backend])


def _loads(library: str) -> bool:
    try:
        ctypes.CDLL(library)
    except OSError:
        return False
    return True


_DEFAULT = ("", "enable", "enabled", "on", "true", "1")
"""Values of `MUJOCO_GL` that name no backend, so that `choose_backend` selects one."""
_BACKENDS = {
    "linux": {"egl": "egl", "osmesa": "osmesa", "glfw": "glfw", "glx": "glfw"},
    "darwin": {"cgl": "cgl", "glfw": "glfw"},
}
"""The backends of each operating system, and the package of `mujoco` that makes their contexts."""


def choose_backend() -> str:
    """Returns the OpenGL backend: the user's `MUJOCO_GL` if set, else one that is installed.

    On Linux, this is `egl` or, if only that is installed, `osmesa`; on macOS `cgl`. A backend that does not exist or is
    not installed is refused by `make_context` only, so that commands without pictures run on every machine.
    """
    chosen = os.environ.get("MUJOCO_GL", "").strip().lower()
    if chosen not in _DEFAULT:
        return chosen
    if sys.platform == "darwin":
        return "cgl"
    if sys.platform != "linux":
        return "glfw"
    return "osmesa" if not _is_installed("egl") and _is_installed("osmesa") else "egl"


MIN_CACHE_BYTES = 64 << 20
"""Free space of the folder of Mesa's shader cache, with less of which it is not used."""


def free_cache_bytes() -> int:
    """Returns the free space for Mesa's cache of shaders."""
    cache = (
        os.environ.get("MESA_SHADER_CACHE_DIR") or os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")
    )
    while not os.path.isdir(cache) and cache != os.path.dirname(cache):
        cache = os.path.dirname(cache)
    try:
        return shutil.disk_usage(cache or ".").free
    except OSError:
        return 0


def memory_limit() -> str:
    """Returns a sentence on the limit of this process's memory (`ulimit -v`); "" if it has none."""
    try:
        import resource
    except ImportError:
        return ""
    limit = resource.getrlimit(resource.RLIMIT_AS)[0]
    if limit == resource.RLIM_INFINITY:
        return ""
    return f"This process is limited to {limit >> 20} MB of memory (ulimit -v), which may be the cause. "


def make_context(width_px: int, height_px: int) -> Any:
    """Returns a new OpenGL context of the chosen backend, even if the user has imported MuJoCo before this module.

    Raises:
        RenderError: there is no such backend, its library is missing, or this process was forked from one that had
            rendered.
    """
    begin_rendering()
    names = _BACKENDS.get(sys.platform, {"glfw": "glfw"})
    if BACKEND not in names:
        raise RenderError(f"MUJOCO_GL is '{BACKEND}', which cannot render here; it may be one of {', '.join(names)}.")
    if BACKEND in _LIBRARIES and not _is_installed(BACKEND):
        raise RenderError(f"MUJOCO_GL={BACKEND} needs {_LIBRARIES[BACKEND][0]}, which is not installed. {_REMEDY}")
    try:
        context = importlib.import_module(f"mujoco.{names[BACKEND]}").GLContext(width_px, height_px)
        with context.as_current():
            if names[BACKEND] == "glfw" and not importlib.import_module("glfw").get_current_context():
                raise RuntimeError("GLFW opened no window: it needs a display")
            return context
    except Exception as error:  # EGL, OSMesa and GLFW raise different classes
        reason = " ".join(str(error).split())[:200]
        raise RenderError(
            f"OpenGL did not start with MUJOCO_GL={BACKEND} ({reason}). {memory_limit()}Import sim before any other "
            f"OpenGL code. {_REMEDY}"
        ) from None


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


BACKEND = choose_backend()
"""The chosen backend; a name that cannot be used is refused when an image is rendered."""
_IS_USABLE = BACKEND in _BACKENDS.get(sys.platform, {}) and (BACKEND not in _LIBRARIES or _is_installed(BACKEND))
# The import of MuJoCo fails if it does not know the name, or if the library of the backend is missing.
os.environ["MUJOCO_GL"] = BACKEND if _IS_USABLE else ""
if _IS_USABLE and BACKEND in _LIBRARIES:
    os.environ.setdefault("PYOPENGL_PLATFORM", BACKEND)
# llvmpipe divides each small frame among all cores and loses more by waiting than it gains.
os.environ.setdefault("LP_NUM_THREADS", "1")
# PyTorch's threads spin for milliseconds while they wait for each other. With two other processes on two cores, a
# frame of the network then takes 200 ms; with this limit 62, and with one thread 44 (docs/performance.md).
os.environ.setdefault("GOMP_SPINCOUNT", "30000")

if (
    free_cache_bytes() < MIN_CACHE_BYTES
):  # Mesa maps the files of its cache; a full disk would end the process by SIGBUS
    os.environ.setdefault("MESA_SHADER_CACHE_DISABLE", "true")

_MUJOCO_WAS_THERE = "mujoco" in sys.modules
import mujoco  # noqa: E402


def _use_backend() -> None:
    """Makes `mujoco.Renderer` use the chosen backend, also if MuJoCo was imported before this module."""
    try:
        from mujoco.rendering.classic import gl_context

        gl_context.GLContext = importlib.import_module(f"mujoco.{_BACKENDS[sys.platform][BACKEND]}").GLContext
    except (ImportError, AttributeError):
        pass  # another version of MuJoCo, which the user has set up


if _IS_USABLE and _MUJOCO_WAS_THERE:
    _use_backend()
if not _IS_USABLE:
    os.environ["MUJOCO_GL"] = BACKEND  # so that spawned workers refuse the same name


def _disable_log_file() -> None:
    """Stops MuJoCo from writing MUJOCO_LOG.TXT into the working directory."""
    config = mujoco.MjLogConfig.get()
    config.logto_file = False
    config.set()


_disable_log_file()

__all__ = ["INSTALL_HINT", "begin_rendering", "choose_backend", "is_forked", "make_context", "mujoco"]
