"""The documentation is consistent: links, pictures, code, examples; nothing from other hosts."""

from __future__ import annotations

import ast
import dataclasses
import importlib
import importlib.util
import os
import re
import shutil
import subprocess
import sys
import types
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sim.core.geometry.grid import GridFrame
from sim.core.geometry.pose import Pose
from sim.episodes.splits import load_split
from sim.homes.housegen.furniture import CATALOGUE
from sim.houses.house import read_rooms
from sim.houses.labels import read_labels
from sim.houses.load import load_house
from sim.task.ground_truth import GroundTruth
from sim.world.world import World
from stubborn import agent
from stubborn.detection import distances
from stubborn.exploration import corners
from stubborn.exploration.explorer import Ground, run_explorer
from stubborn.mapping import collision_marks, mapper
from stubborn.mapping.navmap import CollisionLayer, NavMap
from stubborn.planning import planner
from stubborn.planning.avoidance import visited_ground
from stubborn.planning.planner import Planner, PlanningConfig, Route
from tests.helpers import documented
from tests.helpers.documented import ROOT, Block
from tests.helpers.sampling import sample
from tests.sim.homes.housegen import test_furniture as furniture_laws
from tools.maintenance.site_hooks import fetched_from_elsewhere, without_links_outside

DOCS = ROOT / "docs"
CONFIGURED = (agent, collision_marks, corners, mapper, planner, distances)
"""Modules with the configs that the page of differences names."""
CHANGELOG_HEADINGS = {"Added", "Changed", "Deprecated", "Fixed", "Removed", "Security"}
PAGES = [str(page.relative_to(ROOT)) for page in documented.pages()]
WRITTEN = [page for page in PAGES if not page.startswith("docs/tables/")]
"""Those that a tool does not make from results."""
BLOCKS = [block for page in documented.pages() for block in documented.blocks(page)]
EXCERPTS = [block for block in BLOCKS if block.language == "python" and documented.example_of(block)]
"""Blocks below a line that names a file of examples/: parts of that file."""
PYTHON_BLOCKS = [block for block in BLOCKS if block.language == "python"]
RUNNABLE_BLOCKS = [block for block in PYTHON_BLOCKS if block not in EXCERPTS]
COMMIT = re.compile(r"\b(?=[0-9a-f]*[0-9])(?=[0-9a-f]*[a-f])[0-9a-f]{7,40}\b")
NOT_ON_GITHUB = re.compile(r"--8<--|^:::", re.MULTILINE)
"""Marks that only MkDocs replaces."""
FURNITURE_LAWS = [
    law
    for name, law in vars(furniture_laws).items()
    if name.startswith("test_") and law.__code__.co_varnames[: law.__code__.co_argcount] == ("style",)
]
"""Those that every style must keep."""
NEED_MORE = {
    "stubborn_habitat": "habitat-lab, in an environment of its own",
    "lerobot.datasets": "lerobot, in an environment of its own",
    "rednet_semmap_mp3d_40.pth": "the published checkpoint",
    "runs/plans": "plans that `stubborn houses plans` writes",
    "views_val": "views that `stubborn views` writes",
}
"""Words of blocks that cannot run here, and what they need."""


def _outside_code(text: str) -> str:
    """The text without its blocks of code, where nothing is a link or a heading."""
    return re.sub(r"^```.*?^```$", "", text, flags=re.MULTILINE | re.DOTALL)


def _anchors(page: Path) -> set[str]:
    """The anchors of a page's headings, as GitHub and MkDocs make them."""
    headings = re.findall(r"^#+ (.+)$", _outside_code(page.read_text(encoding="utf-8")), flags=re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).strip().replace(" ", "-") for heading in headings}


@pytest.mark.parametrize("page", PAGES)
def test_every_link_and_picture_leads_somewhere(page: str) -> None:
    broken = []
    text = _outside_code(re.sub(r"`[^`\n]*`", "", (ROOT / page).read_text(encoding="utf-8")))
    for link in re.findall(r"\]\(([^)\s]+)\)", text):
        if not link.startswith(("http://", "https://")):
            name, _, anchor = link.partition("#")
            file = (ROOT / page).parent / name if name else ROOT / page
            if not file.exists() or (anchor and anchor not in _anchors(file)):
                broken.append(link)
    assert not broken


@pytest.mark.parametrize("page", WRITTEN)
def test_a_page_reads_on_github_as_on_the_site_and_names_no_commit(page: str) -> None:
    text = (ROOT / page).read_text(encoding="utf-8")
    assert page == "docs/reference.md" or not NOT_ON_GITHUB.findall(text)  # it is generated when the site is built
    assert not COMMIT.findall(text)


def test_commits_and_marks_of_mkdocs_are_found() -> None:
    assert len(COMMIT.findall("`2158948a`, 1f9d8bd, 1234567, effaced, 0.474, val_0018")) == 2
    assert len(NOT_ON_GITHUB.findall('--8<-- "examples/my_agent.py"\n\n::: sim.core.interface\n')) == 2


def test_only_links_to_files_outside_of_the_docs_become_paths() -> None:
    text = "[start](../index.md) and [licence](../../LICENSE)"
    assert without_links_outside(text, "tutorials/own_house.md") == "[start](../index.md) and licence (`LICENSE`)"
    assert without_links_outside("[a card](../stubborn/README.md)", "index.md") == "a card (`stubborn/README.md`)"


def test_the_changelog_keeps_its_headings() -> None:
    lines = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8").splitlines()
    assert {line.removeprefix("### ") for line in lines if line.startswith("### ")} <= CHANGELOG_HEADINGS
    versions = [line.removeprefix("## ") for line in lines if line.startswith("## ")]
    assert versions[0] == "[Unreleased]"
    assert all(re.fullmatch(r"\[\d+\.\d+\.\d+\] - \d{4}-\d\d-\d\d", version) for version in versions[1:])


@pytest.mark.parametrize("block", EXCERPTS, ids=lambda block: f"{block.page}:{block.line}")
def test_a_block_below_the_name_of_an_example_is_a_part_of_it(block: Block) -> None:
    name = documented.example_of(block)
    assert name is not None
    assert f"\n{block.text}" in f"\n{(ROOT / name).read_text(encoding='utf-8')}"


def test_the_example_agent_is_shown() -> None:
    assert "examples/my_agent.py" in {documented.example_of(block) for block in EXCERPTS}


@pytest.mark.parametrize("block", PYTHON_BLOCKS, ids=lambda block: f"{block.page}:{block.line}")
def test_a_python_block_parses(block: Block) -> None:
    ast.parse(block.text)


def _names_of_the_page() -> list[tuple[str, str]]:
    """Each name of the page of names, with the module that it is imported from."""
    names, module = [], ""
    for line in (DOCS / "names.md").read_text(encoding="utf-8").splitlines():
        module = line.removeprefix("## From ") if line.startswith("## ") else module
        if line.startswith("- "):
            for name in re.findall(r"`([\w.]+)`", line.partition(": ")[0]):
                owner, _, last = name.rpartition(".")
                names.append((owner or module, last))
    return names


@pytest.mark.parametrize(("module", "name"), _names_of_the_page())
def test_a_name_of_the_page_of_names_can_be_imported(module: str, name: str) -> None:
    assert hasattr(importlib.import_module(module), name)


def test_the_page_of_names_has_the_names_that_users_touch() -> None:
    names = [name for _, name in _names_of_the_page()]
    assert {"Action", "MPCAT40_ID", "Ground", "LabelledView", "Segmenter", "AgentSpec"} <= set(names)
    assert len(names) == len(set(names))


def test_every_page_is_in_the_navigation_and_every_entry_a_page() -> None:
    nav = re.findall(r": (\S+\.md)$", (ROOT / "mkdocs.yml").read_text(encoding="utf-8"), flags=re.MULTILINE)
    assert sorted(nav) == sorted(str(page.relative_to(DOCS)) for page in DOCS.rglob("*.md"))


def test_every_picture_in_docs_is_shown() -> None:
    text = "".join(page.read_text(encoding="utf-8") for page in documented.pages())
    assert not [file.name for file in (DOCS / "images").iterdir() if file.name not in text]


def test_the_place_to_which_the_ros_example_drives_is_one_where_its_stop_succeeds() -> None:
    page = (DOCS / "ros.md").read_text(encoding="utf-8")
    x_m, y_m = map(float, re.findall(r"ros_drive\.py (\S+) (\S+)", page)[0])
    (number,) = re.findall(r"--wait --only (\w+)", page)
    (asked,) = (episode for episode in load_split("val").episodes if episode.episode_id == number)
    world = World(load_split("val").load_house(asked.house))
    world.restore()
    region = GroundTruth(world).region(asked.goal, asked.start.floor_z_m)
    around = (0.0, *np.linspace(0.0, 2.0 * np.pi, 8))
    reached_m = (0.0, *[0.25] * 8)  # the example stops where it is so near to the end of its path
    for angle, off_m in zip(around, reached_m, strict=True):
        assert region.succeeds(x_m + off_m * np.cos(angle), y_m + off_m * np.sin(angle)), (angle, off_m)


@pytest.mark.parametrize("folder", ["habitat_lab", "lerobot", "ros2"])
def test_tests_in_other_environments_leave_out_our_conftest_and_its_packages(folder: str) -> None:
    text = (ROOT / "Makefile").read_text(encoding="utf-8")
    commands = re.findall(rf"python -m pytest [^\n]*tests/{folder}\b", text)
    assert commands
    assert all(" --noconftest " in command for command in commands), commands


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


@pytest.mark.parametrize("block", sample(RUNNABLE_BLOCKS, 3), ids=lambda block: f"{block.page}:{block.line}")
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


def _explorer_of_the_page() -> Any:
    """The configuration of the explorer on the page of agents."""
    names: dict[str, Any] = {"__name__": "page"}
    sys.modules["page"] = types.ModuleType("page")  # dataclasses look their module up
    (block,) = [block for block in RUNNABLE_BLOCKS if block.page == "docs/agents.md" and "FARTHEST" in block.text]
    exec(block.text, names)
    return names["FARTHEST"]


def test_the_explorer_on_the_page_of_agents_leads_to_the_farthest_reachable_cell() -> None:
    explorer = _explorer_of_the_page().make(None)
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

    assert len(FURNITURE_LAWS) >= 4
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
