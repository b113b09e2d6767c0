"""The import of models from its command line, and the options that use them."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import pytest

from sim.app.commands.houses import generate as generate_houses
from sim.app.commands.importing import furniture as import_furniture
from sim.app.commands.views import generate as generate_views
from sim.core.errors import ConfigError
from tests.helpers import wording
from tests.helpers.models import CHAIR, obj_text, properties, write_catalogue, write_folder

pytest.importorskip("trimesh")
pytest.importorskip("fast_simplification")


def test_the_result_counts_what_is_imported_and_what_is_left_out(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    source = write_folder(tmp_path / "source", chairs=3)
    entries = [properties("a", "/a.obj"), properties("b", "/b.obj"), properties("c", "/a.obj", name="Thing")]
    write_catalogue(source / "more.sh3f", entries, {"a.obj": obj_text(CHAIR)})
    assert import_furniture.main(import_furniture.Args(source=(source,), out=tmp_path / "out", verbose=True)) == 0
    printed = capsys.readouterr().out
    assert "chair: 3 train, 1 transfer" in printed
    assert "left out: Thing: no category for it (group Living room)" in printed
    assert "5 models" in printed
    assert "2 left out" in printed


def test_a_source_without_a_usable_model_ends_with_status_1(tmp_path: Path) -> None:
    (tmp_path / "models.csv").write_text("file,category,width_m,depth_m,height_m\nnone.obj,chair,1,1,1\n")
    assert import_furniture.main(import_furniture.Args(source=(tmp_path,), out=tmp_path / "out")) == 1


def test_options_that_do_not_fit_are_refused(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="shipped split"):
        generate_houses.main(generate_houses.Args(out=tmp_path, split="val", furniture=tmp_path))
    with pytest.raises(ConfigError, match="--split train"):
        generate_views.main(generate_views.Args(out=tmp_path, split="val", furniture=tmp_path))
    (tmp_path / "file").write_text("")
    with pytest.raises(ConfigError, match=wording.NOT_A_FOLDER):
        import_furniture.main(import_furniture.Args(source=(tmp_path,), out=tmp_path / "file"))


def test_views_with_models_are_of_new_houses_only(tmp_path: Path) -> None:
    args = generate_views.Args(out=tmp_path, furniture=tmp_path, views=3, views_per_shard=1)
    split = SimpleNamespace(name="train", houses=("train_000", "train_001"))
    tasks = generate_views.plan(args, split)  # type: ignore[arg-type]
    assert all(task.fresh_seed is not None for task in tasks)
    assert generate_views.plan(generate_views.Args(out=tmp_path, views=1), split)[0].fresh_seed is None  # type: ignore[arg-type]


@pytest.mark.costly
def test_a_view_house_shows_models(tmp_path: Path) -> None:
    import_furniture.main(
        import_furniture.Args(source=(write_folder(tmp_path / "source", chairs=12),), out=tmp_path / "out")
    )
    args = generate_views.Args(out=tmp_path, furniture=tmp_path / "out", pool="train")
    assert "Somebody" in generate_views._made(args, 3_000_001).spec.comment
