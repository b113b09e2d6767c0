"""Memory of a process: one house, no unused render buffers, no memory for unseen parts of maps, no unused libraries."""

from __future__ import annotations

import gc
import subprocess
import sys
import weakref
from pathlib import Path

import pytest

from sim.core.geometry.pose import Pose
from sim.env.objectnav import ObjectNavEnv
from sim.episodes.episode import Episode
from sim.episodes.splits import write_split
from sim.renderer.camera import Camera
from sim.renderer.opengl import describe_gl
from sim.world.world import World
from tests.helpers.worlds import room, with_box

ROOT = Path(__file__).resolve().parents[3]


def resident_mb() -> float:
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * 4096 / 1e6


@pytest.fixture
def split(tmp_path: Path) -> Path:
    furnished = with_box(room(5, 4), "bed_00", centre_m=(1.5, 0, 0.3), half_m=(0.5, 0.9, 0.3))
    houses = ("first", "second")
    for name in houses:
        (tmp_path / f"{name}.xml").write_text(furnished.spec.to_xml())
    episodes = [Episode(name, name, "bed", Pose(-1.0, 0.0, 0.0)) for name in houses]
    write_split(tmp_path, episodes, {name: {} for name in houses}, version="1")
    return tmp_path


def test_the_last_house_is_freed_when_the_next_one_is_loaded(split: Path) -> None:
    env = ObjectNavEnv(split=split, sensors=())
    try:
        env.reset(seed=0, options={"episode_id": "first"})
        first = weakref.ref(env.scene)
        env.reset(seed=0, options={"episode_id": "second"})
        gc.collect()
        assert first() is None
    finally:
        env.close()


def test_a_camera_without_colour_images_has_no_buffer_for_colour_or_shadows() -> None:
    if "llvmpipe" not in describe_gl():
        pytest.skip("the render buffers of a GPU are not in the memory of the process")
    world = World(room(5, 4))
    cameras, grown_mb = [], 0.0
    for _ in range(4):  # the first ones start the driver
        before_mb = resident_mb()
        cameras.append(Camera(world.model, world.labels, profile="good"))
        cameras[-1].render(world.data, Pose(0.0, 0.0, 0.0), ("depth", "semantic"))
        grown_mb = resident_mb() - before_mb
    for camera in cameras:
        camera.close()
    assert grown_mb < 16, grown_mb  # a shadow map alone has 16.8


MAPS = """
import numpy as np

from sim.core.geometry.grid import GridFrame
from stubborn.mapping.navmap import NavMap
from tests.sim.env.test_memory import resident_mb

frame = GridFrame.around_start(1440, 0.05)
NavMap.empty(GridFrame.around_start(10, 0.05))
before_mb = resident_mb()
np.ones(30_000_000, np.uint8)  # from now on malloc keeps blocks up to this size, and clears by hand what it uses again
for _ in range(4):
    navmap = NavMap.empty(frame)
    navmap.score_sum[700:740, 700:740] = 1.0
assert not navmap.visited.any()
print(resident_mb() - before_mb)
"""


@pytest.mark.costly
def test_maps_take_no_memory_for_unseen_parts() -> None:
    """Runs in a process of its own: memory that other tests have freed would hide or add pages."""
    ended = subprocess.run([sys.executable, "-c", MAPS], capture_output=True, text=True, check=True, cwd=ROOT)
    assert float(ended.stdout) < 24, ended.stdout  # all layers have 68


LAYERS = """
import numpy as np

from sim.env.memory import give_large_blocks_pages_of_their_own
from tests.sim.env.test_memory import resident_mb

give_large_blocks_pages_of_their_own()
np.ones(30_000_000, np.uint8)  # from now on malloc would put blocks up to this size on the heap
before_mb = resident_mb()
layers, notes = [], []
for _ in range(20):
    layers.append(np.ones(5_000_000, np.uint8))
    notes.append(np.ones(5_000, np.uint8))  # keeps the heap from shrinking
assert resident_mb() - before_mb > 80
layers.clear()
print(resident_mb() - before_mb)
"""


@pytest.mark.costly
def test_freed_layers_are_returned_though_small_blocks_between_them_live_on() -> None:
    """Runs in a process of its own, because the switch is for a whole process."""
    ended = subprocess.run([sys.executable, "-c", LAYERS], capture_output=True, text=True, check=True, cwd=ROOT)
    assert float(ended.stdout) < 10, ended.stdout  # the layers have 100


SHREDS = """
import numpy as np

from sim.app.options import RunOptions
from sim.app.composition.environments import episodes_of
from sim.app.composition.runner import EpisodeRunner
from sim.app.composition.setup import resolve
from tests.sim.env.test_memory import resident_mb

options = RunOptions(agent="oracle", semantics="gt", only=("val_0000", "val_0030"))
first, second = episodes_of(resolve(options))[0]
assert first.house == second.house
runner = EpisodeRunner(resolve(options))
runner.run(first)
shreds = [np.ones(100_000, np.uint8) for _ in range(3000)]
pins = shreds[::2]
shreds.clear()
before_mb = resident_mb()
runner.run(second)
print(before_mb - resident_mb())
"""


@pytest.mark.slow
def test_memory_freed_in_pieces_is_returned_before_the_next_episode() -> None:
    """Runs in a process of its own; the blocks between the freed ones stay allocated."""
    ended = subprocess.run([sys.executable, "-c", SHREDS], capture_output=True, text=True, check=True, cwd=ROOT)
    assert float(ended.stdout) > 50, ended.stdout  # 150 are freed, some are used again


@pytest.mark.costly
def test_a_worker_imports_no_library_that_it_does_not_need() -> None:
    options = ("semantics='gt'", "semantics='noisy'", "agent='random'", "agent='oracle'")
    code = "from sim.app.options import RunOptions; from sim.app.composition.runner import EpisodeRunner\n"
    code += "from sim.app.composition.setup import resolve\n"
    code += "".join(f"EpisodeRunner(resolve(RunOptions({chosen}))).close()\n" for chosen in options)
    heavy = ("torch", "sklearn", "ray", "rerun", "webdataset")
    code += f"import sys; print(*[name for name in {heavy} if name in sys.modules])"
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert ended.stdout.split() == []
