"""The wheel holds the shipped files, and the agent can be imported without MuJoCo."""

from __future__ import annotations

import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


@pytest.mark.slow
def test_the_wheel_holds_the_shipped_houses(tmp_path: Path) -> None:
    tracked = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    if tracked.returncode:
        pytest.skip("no git checkout")
    for name in filter(None, tracked.stdout.split("\0")):
        copy = tmp_path / "source" / name
        copy.parent.mkdir(parents=True, exist_ok=True)
        copy.write_bytes((ROOT / name).read_bytes())
    build = [
        sys.executable,
        "-m",
        "pip",
        "wheel",
        "--no-index",
        "--no-deps",
        "--no-build-isolation",
        "-w",
        tmp_path,
        "./source",
    ]
    subprocess.run(list(map(str, build)), cwd=tmp_path, check=True)
    (wheel,) = tmp_path.glob("*.whl")
    packed = set(zipfile.ZipFile(wheel).namelist())
    shipped = [
        file for file in (ROOT / "assets/mjcf_houses").rglob("*") if file.suffix in {".xml", ".gz", ".png", ".json"}
    ]
    assert shipped
    for file in shipped:
        assert f"sim/assets/{file.relative_to(ROOT / 'assets')}" in packed
    for file in (ROOT / "stubborn/detection/verifiers").glob("*.json"):
        assert f"stubborn/detection/verifiers/{file.name}" in packed
    assert "stubborn/segmentation/weights/rednet.safetensors" in packed
    for file in (ROOT / "sim/app/analysis/report/page").iterdir():
        assert f"sim/app/analysis/report/page/{file.name}" in packed
    for file in (ROOT / "sim/robot/sidecars").iterdir():
        assert f"sim/robot/sidecars/{file.name}" in packed
    assert "sim/app/services/vlm/prompts.toml" in packed
    for file in (ROOT / "sim/app/web/page").iterdir():
        assert f"sim/app/web/page/{file.name}" in packed


def test_the_citation_names_the_version_of_the_package() -> None:
    version = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"]
    assert f"\nversion: {version}\n" in (ROOT / "CITATION.cff").read_text()
