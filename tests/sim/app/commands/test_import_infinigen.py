"""Assets of Infinigen's generators, by a small process in its place: time limit, failures, resumed runs, the import."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

from sim.app.commands.importing import furniture as import_furniture
from sim.app.commands.importing import infinigen as import_infinigen
from sim.core.errors import ConfigError
from sim.homes.housegen.imported import infinigen
from sim.homes.housegen.imported.infinigen import Generator, make_assets
from sim.homes.housegen.imported.infinigen_worker import write_glb
from sim.homes.housegen.imported.library import read_index, read_shape
from tests.helpers import wording
from tests.helpers.models import write_folder

pytest.importorskip("trimesh")
pytest.importorskip("fast_simplification")

FAKE = """
import json, os, shutil, sys, time
print(json.dumps({"ready": "fake"}), flush=True)
for line in sys.stdin:
    asked = json.loads(line)
    open(ASKED, "a").write(asked["factory"] + str(asked["seed"]) + " ")
    if "Slow" in asked["factory"]:
        time.sleep(60.0)
    if "Crash" in asked["factory"]:
        os._exit(1)
    if "Bad" in asked["factory"]:
        print(json.dumps({"error": "ValueError: no mesh"}), flush=True)
        continue
    shutil.copyfile(MODEL, asked["file"])
    print(json.dumps({"extent_m": [0.5, 0.4, 1.0], "triangles": 24}), flush=True)
"""
"""A process that writes the same model each time, and hangs, ends or fails for some names."""
BOXES = (((-0.25, -0.2, 0.0), (0.25, 0.2, 0.5)), ((-0.25, -0.2, 0.5), (-0.2, 0.2, 1.0)))
"""A seat, and a back at the smallest x."""
SIDES = (
    (0, 2, 1), (1, 2, 3), (4, 5, 6), (5, 7, 6), (0, 1, 4), (1, 5, 4), (2, 6, 3), (3, 6, 7), (0, 4, 2), (2, 4, 6),
    (1, 3, 5), (3, 7, 5),
)  # fmt: skip
CHAIR = Generator("seats.ChairFactory", "chair", ("dining",))


@pytest.fixture
def asked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Puts the small process in place of the one with Infinigen; returns the file of the requests that it got."""
    script, requests, model = (tmp_path / name for name in ("fake.py", "asked.txt", "chair.glb"))
    corners = [[box[n >> k & 1][k] for k in range(3)] for box in BOXES for n in range(8)]
    faces = np.array([[n + 8 * b for n in side] for b in range(2) for side in SIDES])
    colours = {0: (0.8, 0.1, 0.1, 1.0), 1: (0.1, 0.1, 0.8, 1.0)}
    write_glb(str(model), np.array(corners), faces, np.repeat([0, 1], 12), colours, two_sided=False)
    script.write_text(f"ASKED, MODEL = {str(requests)!r}, {str(model)!r}\n{FAKE}")
    monkeypatch.setattr(infinigen, "WORKER", script)
    return requests


@pytest.mark.costly
def test_an_asset_that_hangs_ends_the_process_or_fails_is_left_out_and_the_next_is_made(
    tmp_path: Path, asked: Path
) -> None:
    names = ("Slow", "Crash", "Bad", "Chair")
    generators = [Generator(f"seats.{name}Factory", "chair", ("dining",)) for name in names]
    assets = list(make_assets(tmp_path / "out", Path(sys.executable), generators, [0], limit_s=1.0))
    errors = {asset.generator: asset.error for asset in assets}
    assert errors == {
        "Slow": "no answer within 1 s", "Crash": "the process has ended", "Bad": "ValueError: no mesh", "Chair": ""
    }  # fmt: skip
    assert [asset.limit_s for asset in assets] == [1.0, 0.0, 0.0, 0.0]
    again = make_assets(tmp_path / "out", Path(sys.executable), generators, [0], limit_s=2.0)
    assert next(again).error == "no answer within 2 s"
    assert not list((tmp_path / "out").glob("*.part"))


def test_a_second_run_makes_only_the_assets_that_were_not_tried(tmp_path: Path, asked: Path) -> None:
    generators = [CHAIR, Generator("seats.BadFactory", "chair", ("dining",))]
    python = Path(sys.executable)
    assert next(make_assets(tmp_path / "out", python, generators, [0, 1], limit_s=9.0)).error == ""
    again = list(make_assets(tmp_path / "out", python, generators, [0, 1], limit_s=9.0))
    assert [(asset.generator, asset.seed) for asset in again] == [("Chair", 0), ("Bad", 0), ("Chair", 1), ("Bad", 1)]
    list(make_assets(tmp_path / "out", python, generators, [0, 1], limit_s=9.0))
    requests = asked.read_text().split()
    assert sorted(requests) == ["seats.BadFactory0", "seats.BadFactory1", "seats.ChairFactory0", "seats.ChairFactory1"]


def test_the_folder_is_a_source_of_furniture_that_joins_another(
    tmp_path: Path, asked: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(import_infinigen, "GENERATORS", (CHAIR,))
    monkeypatch.setattr(infinigen, "GENERATORS", (CHAIR,))
    args = import_infinigen.Args(python=Path(sys.executable), out=tmp_path / "made", count=3)
    assert import_infinigen.main(args) == 0
    assert "chair: Chair 3 made" in capsys.readouterr().out
    other = write_folder(tmp_path / "other")
    import_furniture.main(import_furniture.Args(source=(tmp_path / "made", other), out=tmp_path / "models"))
    models = read_index(tmp_path / "models")
    made = [model for model in models if model.name.startswith("Chair_")]
    assert (len(made), len(models)) == (3, 5)
    assert {model.split for model in made} == {"train", "transfer"}
    assert made[0].size_m == (0.5, 0.4, 1.0)
    shape = read_shape(tmp_path / "models", made[0])
    (back,) = (part for part in shape.parts if part.vertices_m[:, 2].max() > 0.9)
    assert back.rgba == (0.102, 0.102, 0.8, 1.0)
    assert back.vertices_m[:, 0].max() < 0.0


def test_a_python_without_infinigen_and_an_unknown_category_are_refused(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="--python"):
        list(make_assets(tmp_path, Path(sys.executable), [CHAIR], [0], limit_s=1.0))
    with pytest.raises(ConfigError, match=wording.CANNOT_BE_STARTED):
        list(make_assets(tmp_path, tmp_path / "none", [CHAIR], [0], limit_s=1.0))
    with pytest.raises(ConfigError, match="'shower'"):
        import_infinigen.chosen(["shower"])
