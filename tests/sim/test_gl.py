"""Rendering works whenever MuJoCo was imported and in any thread; a backend that cannot render is one line."""

from __future__ import annotations

import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import pytest

RENDER = "from sim.gl import make_context, mujoco; make_context(8, 8); print(mujoco.__version__)"


def _run(code: str, **variables: str) -> subprocess.CompletedProcess[str]:
    env = {name: value for name, value in os.environ.items() if name not in ("DISPLAY", "MUJOCO_GL")}
    env.pop("PYOPENGL_PLATFORM", None)
    return subprocess.run([sys.executable, "-c", code], env=env | variables, capture_output=True, text=True)


def test_a_context_starts_without_a_display_after_the_user_imported_mujoco() -> None:
    done = _run(f"import mujoco; {RENDER}")
    assert done.returncode == 0, done.stderr


@pytest.mark.costly
@pytest.mark.parametrize("name", ["foo", "disable", "cgl"])
def test_a_backend_that_cannot_render_is_refused_only_when_something_is_rendered(name: str) -> None:
    assert _run("import sim.gl", MUJOCO_GL=name).returncode == 0
    done = _run(RENDER, MUJOCO_GL=name)
    assert done.stderr.splitlines()[-1].startswith(f"sim.core.errors.RenderError: MUJOCO_GL is '{name}'")


def test_a_window_without_a_display_is_one_sentence() -> None:
    done = _run(RENDER, MUJOCO_GL="glfw")
    assert done.stderr.splitlines()[-1].startswith(
        "sim.core.errors.RenderError: OpenGL did not start with MUJOCO_GL=glfw"
    )
    assert "needs a display" in done.stderr.splitlines()[-1]


def test_a_missing_library_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    from sim import gl

    monkeypatch.setattr(gl, "BACKEND", "osmesa")
    monkeypatch.setattr(gl, "_loads", lambda library: False)
    with pytest.raises(gl.RenderError, match=r"MUJOCO_GL=osmesa.*libOSMesa\.so\.8"):
        gl.make_context(8, 8)


def test_a_context_is_current_in_any_thread_after_another_one_used_it() -> None:
    from sim.gl import make_context

    context = make_context(8, 8)

    def use() -> bool:
        with context.as_current():
            return True

    assert use()
    with ThreadPoolExecutor(1) as pool:
        assert pool.submit(use).result()
    assert use()


@pytest.mark.parametrize(("free", "expected"), [(0, "true"), (1 << 40, "None")])
def test_the_cache_of_shaders_is_not_used_on_a_full_disk(free: int, expected: str) -> None:
    code = (
        f"import os, shutil, types; shutil.disk_usage = lambda folder: types.SimpleNamespace(free={free})\n"
        "import sim.gl; print(os.environ.get('MESA_SHADER_CACHE_DISABLE'))"
    )
    done = _run(code, MESA_SHADER_CACHE_DIR="/no/such/folder")
    assert done.stdout.strip() == expected, done.stderr


def test_a_limit_of_memory_is_named_where_opengl_does_not_start() -> None:
    code = (
        "import resource; from sim import gl; assert gl.memory_limit() == ''\n"
        "resource.setrlimit(resource.RLIMIT_AS, (4 << 30, 4 << 30))\n"
        "import mujoco.egl as egl\n"
        "def fails(*_): raise RuntimeError('no memory')\n"
        "egl.GLContext = fails; gl.make_context(8, 8)"
    )
    done = _run(code, MUJOCO_GL="egl")
    assert "(no memory). This process is limited to 4096 MB of memory" in done.stderr


def test_a_renderer_of_the_user_works_if_mujoco_was_imported_first() -> None:
    code = (
        'import mujoco, sim.gl; model = mujoco.MjModel.from_xml_string(\'<mujoco><worldbody><geom size="1"/>'
        "</worldbody></mujoco>'); r = mujoco.Renderer(model, 8, 8); data = mujoco.MjData(model);"
        "mujoco.mj_forward(model, data); r.update_scene(data); print(r.render().shape)"
    )
    done = _run(code)
    assert done.stdout == "(8, 8, 3)\n", done.stderr
