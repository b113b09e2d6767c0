import subprocess
import sys

import pytest

from sim.app.bridges.habitat_sim.finder import MODULES

READ = """
import stubborn_habitat
import importlib
import habitat_sim, magnum
assert habitat_sim.nav.PathFinder is importlib.import_module("habitat_sim.nav").PathFinder
assert habitat_sim.__version__
class Own(habitat_sim.physics.ManagedRigidObject):
    pass
item: habitat_sim.gfx.DebugLineRender | None = magnum.Matrix4.identity_init()
try:
    item.transform_vector
except NotImplementedError as error:
    print(error)
"""


def python(code: str) -> str:
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    return done.stdout + done.stderr


@pytest.mark.costly
def test_names_that_do_nothing_can_be_imported_and_say_so_when_they_are_used() -> None:
    assert python(READ).strip() == (
        "'magnum.Matrix4.identity_init' is not part of the habitat_sim that runs on MuJoCo (docs/habitat.md)."
    )


def test_another_habitat_sim_is_not_replaced() -> None:
    code = "import sys, types; sys.modules['habitat_sim'] = types.ModuleType('habitat_sim'); import stubborn_habitat"
    assert "`import stubborn_habitat` must come first" in python(code)


@pytest.mark.costly
def test_each_module_has_its_names_also_when_it_is_imported_first() -> None:
    code = f"""
import importlib, sys, stubborn_habitat
for name in {sorted(MODULES)}:
    for imported in [each for each in sys.modules if each.partition(".")[0] == name.partition(".")[0]]:
        del sys.modules[imported]
    importlib.import_module(name)
"""
    assert python(code) == ""
