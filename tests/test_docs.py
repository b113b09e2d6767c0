"""The documentation holds together: links, pictures, Python blocks, examples, and nothing from other hosts."""

from __future__ import annotations

import dataclasses
import importlib.util
import os
import re
import shutil
import subprocess
import sys
import types
from pathlib import Path
from typing import Any

import pytest

from sim.geometry.grid import GridFrame
from sim.geometry.pose import Pose
from sim.housegen.furniture import CATALOGUE
from sim.houses.house import read_rooms
from sim.houses.labels import read_labels
from sim.houses.load import load_house
from sim.interface import CameraModel, RobotModel
from stubborn import agent
from stubborn.detection import distances
from stubborn.exploration import corners
from stubborn.exploration.explorer import Ground, run_explorer
from stubborn.mapping import collision_marks, mapper
from stubborn.mapping.navmap import CollisionLayer, NavMap
from stubborn.planning import planner
from stubborn.planning.avoidance import visited_ground
from stubborn.planning.planner import Planner, PlanningConfig, Route
from stubborn.segmentation.ground_truth import GroundTruthSegmenter
from tests.helpers import documented
from tests.helpers.documented import ROOT, Block
from tests.helpers.sampling import sample
from tests.sim.housegen import test_furniture as furniture_laws
from tools.maintenance.site_hooks import fetched_from_elsewhere

DOCS = ROOT / "docs"
CONFIGURED = (agent, collision_marks, corners, mapper, planner, distances)
"""Modules with the configs that the page of differences names."""
SNIPPET = re.compile(r'--8<-- "([^"]+)"')
PYTHON_BLOCKS = [
    block
    for page in documented.pages()
    for block in documented.blocks(page)
    if block.language == "python" and not SNIPPET.search(block.text)
]
PROMISED = (
    *(f"sim.interface.{name}" for name in ("Action", "GOAL_CATEGORIES", "MPCAT40", "CameraModel", "RobotModel")),
    *(f"sim.interface.{name}" for name in ("Observation", "Scores", "Segmenter.scores", "Agent.act", "ConfigError")),
    *(
        "sim.env.objectnav.ObjectNavEnv",
        "stubborn.agents.make",
        "stubborn.agent.AgentConfig",
        "sim.housegen.generator.generate",
    ),
    *(
        "sim.task.trajectory.read_trajectory",
        "sim.episodes.splits.load_split",
        "sim.composition.options.RunOptions.agent",
        "sim.task.failures",
    ),
)
"""Names on which users may rely, and others that pages speak of."""
FURNITURE_LAWS = [
    law
    for name, law in vars(furniture_laws).items()
    if name.startswith("test_") and law.__code__.co_varnames[:1] == ("style",)
]
"""Those that every style must keep."""
NEED_MORE = {
    "rednet_semmap_mp3d_40.pth": "the published checkpoint",
    "runs/plans": "plans that `stubborn houses plans` writes",
    "views_val": "views that `stubborn views` writes",
}
"""Words of blocks that cannot run here, and what they need."""


def _in_code(text: str) -> str:
    """The text without its code, where nothing is a link."""
    return re.sub(r"`[^`\n]*`", "", re.sub(r"^```.*?^```$", "", text, flags=re.MULTILINE | re.DOTALL))


def test_every_link_and_picture_leads_somewhere() -> None:
    broken = []
    for page in documented.pages():
        for link in re.findall(r"\]\(([^)\s]+)\)", _in_code(page.read_text(encoding="utf-8"))):
            if not link.startswith(("http://", "https://", "#")):
                file = (page.parent / link.split("#")[0]).resolve()
                if not file.exists():
                    broken.append(f"{page.relative_to(ROOT)}: {link}")
    assert not broken


def test_every_page_is_in_the_navigation_and_every_entry_a_page() -> None:
    nav = re.findall(r": (\S+\.md)$", (ROOT / "mkdocs.yml").read_text(encoding="utf-8"), flags=re.MULTILINE)
    assert sorted(nav) == sorted(str(page.relative_to(DOCS)) for page in DOCS.rglob("*.md"))


def test_every_picture_in_docs_is_shown() -> None:
    text = "".join(page.read_text(encoding="utf-8") for page in documented.pages())
    assert not [file.name for file in (DOCS / "images").iterdir() if file.name not in text]


def test_every_snippet_is_a_file_of_the_repository() -> None:
    text = "".join(page.read_text(encoding="utf-8") for page in DOCS.rglob("*.md"))
    named = SNIPPET.findall(text)
    assert "examples/my_agent.py" in named
    assert all((ROOT / name).is_file() for name in named)


def test_every_config_field_that_the_differences_name_is_there() -> None:
    """`XConfig.field` in a cell, then bare `field`s of the same class."""
    classes = {
        name: cls for module in CONFIGURED for name, cls in vars(module).items() if dataclasses.is_dataclass(cls)
    }
    seen = 0
    for line in (DOCS / "differences.md").read_text(encoding="utf-8").splitlines():
        owner = None
        for span in re.findall(r"`([^`]+)`", line.rpartition(" | ")[2]) if line.endswith(" |") else ():
            name, _, field = span.rpartition(".")
            owner = classes.get(name) if name else owner
            if owner is not None and dataclasses.is_dataclass(owner):
                seen += 1
                assert field in {each.name for each in dataclasses.fields(owner)}, span
    assert seen >= 35


@pytest.mark.parametrize("block", sample(PYTHON_BLOCKS, 3), ids=lambda block: f"{block.page}:{block.line}")
def test_a_python_block_runs(block: Block, tmp_path: Path) -> None:
    """As a file in a process of its own, as a reader would; what needs another file is compiled only."""
    file = tmp_path / "block.py"
    file.write_text(block.text, encoding="utf-8")
    if any(word in block.text for word in NEED_MORE):
        compile(block.text, str(file), "exec")
        return
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    ended = subprocess.run(
        [sys.executable, str(file)],
        cwd=tmp_path,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
    )
    assert ended.returncode == 0, ended.stderr


def _names_on_the_page_of_agents() -> dict[str, Any]:
    names: dict[str, Any] = {"__name__": "page"}
    sys.modules["page"] = types.ModuleType("page")  # dataclasses look their module up
    for block in PYTHON_BLOCKS:
        if block.page == "docs/agents.md":
            exec(block.text, names)
    return names


def test_the_variant_on_the_page_of_agents_is_an_agent_with_its_own_config() -> None:
    spec = _names_on_the_page_of_agents()["BOLD"]
    variant = spec.make(camera=CameraModel(), robot=RobotModel(), segmenter=GroundTruthSegmenter(), config=spec.config)
    assert (variant.config.planning.dilation_m, variant.config.collisions.wide_m) == (0.10, 0.35)
    assert variant.config.untrap == agent.AgentConfig().untrap


def test_the_explorer_on_the_page_of_agents_leads_to_the_farthest_reachable_cell() -> None:
    explorer = _names_on_the_page_of_agents()["FARTHEST"].make(None)
    frame = GridFrame.around_start(101, 0.05)
    navmap = NavMap.empty(frame)
    layers, planner = (CollisionLayer.NONE,), Planner(PlanningConfig(), visited_ground)
    whole = frame.part(slice(None), slice(None))
    route = run_explorer(explorer, Ground(navmap, whole, Pose(0.0, 0.0, 0.0), layers, planner, "chair"))
    assert isinstance(route, Route)
    assert route.length_m > 3.0  # a corner of the map is 3.5 m away


def test_the_example_agent_is_thirty_lines() -> None:
    code = (ROOT / "examples" / "my_agent.py").read_text(encoding="utf-8")
    body = code[code.index("class Wanderer") :]
    assert len([line for line in body.splitlines() if line.strip()]) <= 30


@pytest.mark.parametrize("law", FURNITURE_LAWS, ids=lambda law: law.__name__)
def test_the_example_furniture_keeps_the_laws_of_shipped_furniture(law: Any) -> None:
    from examples.my_furniture import CRATE

    assert len(FURNITURE_LAWS) >= 5
    law(CRATE)


def test_the_example_house_has_the_example_furniture_and_the_catalogue_is_as_before(tmp_path: Path) -> None:
    from examples.my_furniture import main

    before = CATALOGUE.styles("stool")
    main(tmp_path / "house.xml")
    assert CATALOGUE.styles("stool") == before
    house = load_house(tmp_path / "house.xml")
    crates = [body for body in house.spec.bodies if body.name.startswith("stool_")]
    assert crates
    assert all(len(crate.geoms) >= 4 for crate in crates)


def test_the_example_house_by_hand_keeps_the_house_format() -> None:
    house = load_house(ROOT / "examples" / "my_house.xml")
    model = house.spec.compile()
    assert read_labels(model).categories() == ("wall", "floor", "chair", "cushion", "sofa", "ceiling")
    assert [room.kind for room in read_rooms(model)] == ["living_room"]


@pytest.mark.parametrize(
    "page",
    [
        '<script src="https://cdn.example/x.js"></script>',
        '<link rel="stylesheet" href="//fonts.example/css">',
        '<img alt="x" src="http://elsewhere.example/x.png">',
        "@import 'https://fonts.example/css';",
        "body { background: url(https://elsewhere.example/x.png) }",
        '<pre class="mermaid">graph LR</pre>',
    ],
)
def test_what_a_page_would_fetch_from_another_host_is_found(page: str) -> None:
    assert list(fetched_from_elsewhere(page))


def test_links_and_files_of_the_site_are_not_fetched_from_elsewhere() -> None:
    page = '<a href="https://arxiv.org/abs/1806.01054">x</a> <img src="images/x.png"> <link rel="canonical" href="https://x.y/">'
    assert not list(fetched_from_elsewhere(page))


@pytest.mark.slow
def test_the_site_builds_without_a_warning(tmp_path: Path) -> None:
    if importlib.util.find_spec("mkdocs") is None or shutil.which("git") is None:
        pytest.skip("the extra [docs] is not installed; `make docs` installs it and builds")
    ended = subprocess.run(
        [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", str(tmp_path / "site")],
        cwd=ROOT, env={**os.environ, "NO_MKDOCS_2_WARNING": "1"}, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert ended.returncode == 0, ended.stderr
    anchors = "".join(page.read_text(encoding="utf-8") for page in (tmp_path / "site" / "api").glob("*.html"))
    assert not [name for name in PROMISED if f'id="{name}"' not in anchors]
