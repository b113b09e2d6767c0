"""Code blocks of README and docs: what readers will copy, and how a test tries it without their hours.

`TRIALS` has a line for every command that stands in a `sh` block. A command that is not in it fails
`tests/commands/test_commands.py`, so whoever documents one says here how it is tried.
"""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from sim.commands.main import COMMANDS, split

ROOT = Path(__file__).resolve().parents[2]
PYTHON = ".venv/bin/python"
OLD_NAMES_ARE_ERRORS = True
"""To be set to True when no page names a command by its old path, such as tools/gallery.py."""
MOVED = {
    "generate_houses": "houses generate",
    "check_houses": "houses check",
    "export_plans": "houses plans",
    "make_episodes": "episodes",
    "make_traps": "traps",
    "trap_report": "traps report",
    "generate_views": "views",
    "show_views": "views show",
    "unpack_views": "views unpack",
    "label_house": "label",
    "import_furniture": "import furniture",
    "train_rednet": "train segmentation",
    "train_verifier": "train verifier",
    "train_tracks": "train fusion",
    "train_semexp": "train semexp",
    "train_poni": "train poni",
    "train_cloned": "train cloned",
    "evaluate_rednet": "evaluate",
    "show_mistakes": "evaluate mistakes",
    "worst_objects": "evaluate objects",
    "compare_runs": "compare",
    "merge_runs": "merge",
    "reproduce": "reproduce",
    "gallery": "gallery",
    "bench": "bench",
}
"""Files of tools/ that users called up to version 0.1, and the commands that they are now."""
MOVED_TOOLS = {
    "render_demonstrations": "training",
    "twin_demonstrations": "training",
    "compare_networks": "training",
    "check_twin": "research",
    "compare_explorers": "research",
    "draw_potentials": "research",
    "draw_trajectories": "research",
    "bench_against": "maintenance",
    "describe_houses": "maintenance",
    "make_textures": "maintenance",
    "readme_picture": "maintenance",
    "split_report": "maintenance",
}
"""Other files of tools/, and the folders in which they are now."""
_EXAMPLE = re.compile(r"`(examples/[\w./]+)`")
_FENCE = re.compile(r"^(?P<indent> *)(?P<marks>```+|~~~+)(?P<language>[\w+-]*)(?P<rest>[^\n]*)$")


@dataclass(frozen=True)
class Block:
    """One fenced block of a page."""

    page: str
    """Relative to the repository."""
    line: int
    language: str
    text: str


def pages() -> list[Path]:
    """README, and everything in docs."""
    return [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]


def blocks(page: Path) -> Iterator[Block]:
    """The fenced blocks of a page, in order."""
    open_fence, began, kept = None, 0, []
    for number, line in enumerate(page.read_text(encoding="utf-8").splitlines(), start=1):
        fence = _FENCE.match(line)
        if open_fence is None:
            if fence:
                open_fence, began, kept = fence, number, []
        elif fence and fence["marks"] == open_fence["marks"] and not fence["language"]:
            name = str(page.relative_to(ROOT))
            yield Block(name, began, open_fence["language"], "\n".join(kept) + "\n")
            open_fence = None
        else:
            kept.append(line.removeprefix(open_fence["indent"]))
    assert open_fence is None, f"{page}: the block that begins in line {began} has no end"


def canonical(words: Sequence[str]) -> str:
    """Returns a command in the form that `TRIALS` has, whatever form a page prefers.

    `.venv/bin/stubborn run` and `python -m sim.run` become `stubborn run`; old names become the new ones.
    """
    first, rest = words[0], list(words[1:])
    if first in ("stubborn", ".venv/bin/stubborn"):
        return shlex.join(["stubborn", *rest])
    if first not in ("python", PYTHON) or not rest:
        return shlex.join(words)
    if rest[0] == "-m" and rest[1] in ("sim.run", "sim.report", "sim.web", "sim.teleop"):
        return shlex.join(["stubborn", rest[1].removeprefix("sim."), *rest[2:]])
    if rest[0] == "-m" and rest[1].startswith("examples."):
        return shlex.join([PYTHON, f"{rest[1].replace('.', '/')}.py", *rest[2:]])
    old = re.fullmatch(r"tools/(\w+)\.py", rest[0])
    if old and old[1] in MOVED:
        return shlex.join(["stubborn", *MOVED[old[1]].split(), *rest[1:]])
    if old and old[1] in MOVED_TOOLS:
        return shlex.join([PYTHON, "-m", f"tools.{MOVED_TOOLS[old[1]]}.{old[1]}", *rest[1:]])
    return shlex.join([PYTHON, *rest])


def old_names() -> list[str]:
    """Every place where a page names a command by its old path."""
    found = []
    for page in pages():
        for number, line in enumerate(page.read_text(encoding="utf-8").splitlines(), start=1):
            for name in re.findall(r"\btools[/.](\w+)", line):
                if name in MOVED or name in MOVED_TOOLS:
                    found.append(f"{page.relative_to(ROOT)}:{number}: {name}")
    return found


def example_of(block: Block) -> str | None:
    """The file of examples/ that the line above a block names, so that the block must be a part of it; or None."""
    lines = (ROOT / block.page).read_text(encoding="utf-8").splitlines()[: block.line - 1]
    while lines and not lines[-1].strip():
        lines.pop()
    named = _EXAMPLE.findall(lines[-1]) if lines else []
    return named[-1] if named else None


def commands() -> dict[str, str]:
    """Every command of the shell blocks in its canonical form, and where it stands first."""
    found: dict[str, str] = {}
    for page in pages():
        for block in blocks(page):
            if block.language == "sh":
                for line in block.text.replace("\\\n", " ").splitlines():
                    words = shlex.split(line, comments=True)
                    if words:
                        found.setdefault(canonical(words), f"{block.page}:{block.line}")
    return found


def unmarked_commands() -> dict[str, str]:
    """Commands outside of `sh` blocks: in running text, where `stubborn` is an agent too, and in blocks of `text`."""
    started = "|".join(sorted({name.split()[0] for name in COMMANDS}))
    begins = re.compile(
        rf"(?:\.venv/bin/)?(?:python (?:-m (?:sim|tools|stubborn)\b|tools/|examples/)|stubborn (?:{started})\b)"
    )
    found: dict[str, str] = {}
    for page in pages():
        lines = [line for block in blocks(page) if block.language == "text" for line in block.text.splitlines()]
        prose = re.sub(r"^```.*?^```$", "", page.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
        for code in [*lines, *re.findall(r"`([^`]+)`", prose)]:
            if not begins.match(code):
                continue
            command = canonical(shlex.split(code.replace("\n", " "), comments=True))
            name, options = program_of(command)
            if options and not {"...", "|"} & set(options) and name:
                found.setdefault(command, str(page.relative_to(ROOT)))
    return found


def program_of(command: str) -> tuple[str, list[str]]:
    """What a canonical command starts (`views show`, `tools.research.check_twin`, `examples/x.py`), and its options."""
    words = shlex.split(command)
    if words[0] == "stubborn":
        return split(words[1:])
    if words[:2] == [PYTHON, "-m"]:
        return words[2], words[3:]
    return words[1] if len(words) > 1 else "", words[2:]


@dataclass(frozen=True)
class Only:
    """A command that is parsed but not run, and why."""

    why: str


_RUN = "stubborn run"
_SMALL = "--house examples/my_house.xml --goal sofa"
_SHIPPED = "stubborn/segmentation/weights/rednet.safetensors"
_NEEDS_SETUP = Only("makes or needs a whole environment; .ci/run does that")
_RECORDED = f"{_RUN} --record --goal bed --episodes 1 --agent random --out {{tmp}}/mine"
_HOUSES = "stubborn houses generate --first-seed 0 --houses 1 --out {tmp}/houses"
_SHOWN = f"{_RUN} --agent oracle --split val --episodes 2 --record --out {{tmp}}/shown/oracle"
_SEARCHES = (
    f"{PYTHON} -m tools.training.twin_demonstrations --first-seed 19 --houses 2 --kind studio --episodes 4 "
    "--out {tmp}/demonstrations/searches"
)
_TRAIN_CLONED = "stubborn train cloned --demonstrations {tmp}/demonstrations --minutes 0.1 --threads 2"
_CLONED = f"{_TRAIN_CLONED} --streams 2 --out {{tmp}}/cloned"
_PLANS = ("stubborn houses plans --pool train --kind studio --houses 4 --out {tmp}/plans",)
_EPISODES = "stubborn episodes --split {tmp}/houses --episodes 3"
_VIEWS = (
    "stubborn views --split val --views 4 --shrink 4 --profile fast --out {tmp}/views --workers 1 --views-per-shard 4"
)
_FOREIGN = f"{PYTHON} -c 'from pathlib import Path; from tests.helpers.foreign import *; "
_SCENE = _FOREIGN + 'write_scene(Path("{tmp}/s"))\''
_ROBOT = _FOREIGN + 'write_robot(Path("{tmp}/r"))\''
_IN_SCENE = (
    f"{_RUN} --house {{tmp}}/s/flat.xml --labels {{tmp}}/s/labels.json --episodes 1 --agent oracle --record"
    " --out {tmp}/run"
)
_OF_SCENE = "--house {tmp}/s/flat.xml --labels {tmp}/s/labels.json"
_PACKED = f"stubborn episodes {_OF_SCENE} --episodes 2 --out {{tmp}}/split"
_KITCHEN = "runs/worlds/gymnasium_robotics/envs/assets/kitchen_franka"
_PACKAGE = Only("needs files of another package; tests/commands/test_foreign_houses.py has a scene of its own")
_MODELS = (
    _FOREIGN.replace("foreign", "models") + 'write_folder(Path("{tmp}/source"), chairs=8)\'',
    "stubborn import furniture --source {tmp}/source --out {tmp}/models",
)
_TRANSFER = (
    *_MODELS,
    "stubborn houses generate --furniture {tmp}/models --transfer-test --houses 1 --out {tmp}/transfer",
    "stubborn episodes --split {tmp}/transfer --recipe val --episodes 3",
)
_UNSEEN = (
    *_MODELS,
    "stubborn houses generate --furniture {tmp}/models --furniture-split transfer --only-imported"
    " --first-seed 7000 --houses 1 --area-m2 60 --out {tmp}/unseen",
    "stubborn episodes --split {tmp}/unseen --recipe val --episodes 3",
)
_SHARDS = tuple(f"{_RUN} {_SMALL} --agent oracle --episodes 2 --shard {i}/2 --out {{tmp}}/big" for i in range(2))

TRIALS: dict[str, tuple[str, ...] | Only] = {
    "make run": _NEEDS_SETUP,
    "make test": _NEEDS_SETUP,
    "make test-all": _NEEDS_SETUP,
    "make lint": _NEEDS_SETUP,
    "make types": _NEEDS_SETUP,
    "make docs": _NEEDS_SETUP,
    # README
    f"{_RUN} --episodes 20 --workers 2 --record --out runs/mine": (
        f"{_RUN} --goal bed --episodes 2 --workers 2 --record --agent random --out {{tmp}}/mine",
    ),
    "stubborn report runs/mine": (_RECORDED, "stubborn report {tmp}/mine"),
    f"{_RUN} --agent examples.my_agent:AGENT --video": (
        f"{_RUN} --agent examples.my_agent:AGENT --video {_SMALL} --episodes 1 --out {{tmp}}/run",
    ),
    f"{_RUN} --semantics noisy --noise realsense": (
        f"{_RUN} --semantics noisy --noise realsense {_SMALL} --episodes 1 --out {{tmp}}/run",
    ),
    "stubborn teleop --house examples/my_house.xml": Only("needs a terminal; tests/sim/test_teleop.py gives it one"),
    "stubborn reproduce ablation --episodes 200 --workers 2": (
        "stubborn reproduce ablation --episodes 1 --workers 1 --agents random oracle --out {tmp}/paper",
    ),
    # docs/index.md
    f"{_RUN} --episodes 20 --workers 2": (f"{_RUN} --episodes 2 --workers 2 --agent random --out {{tmp}}/run",),
    f"{_RUN} --list-agents": (f"{_RUN} --list-agents",),
    f"{_RUN} --agent oracle --goal toilet": (f"{_RUN} --agent oracle --goal toilet --episodes 1 --out {{tmp}}/run",),
    f"{_RUN} --semantics gt --goal toilet": (f"{_RUN} --semantics gt {_SMALL} --episodes 1 --out {{tmp}}/run",),
    f"{_RUN} --house examples/my_house.xml --goal sofa --start-deg '1.0 2.5 90'": (
        f"{_RUN} {_SMALL} --start-deg '1.0 2.5 90' --episodes 2 --out {{tmp}}/run",
    ),
    # docs/agents.md
    f"{_RUN} --agent examples.my_agent:AGENT --config agent.keep_m=1.0 --episodes 5": (
        f"{_RUN} --agent examples.my_agent:AGENT --config agent.keep_m=1.0 {_SMALL} --episodes 1 --out {{tmp}}/run",
    ),
    f"{_RUN} --semantics gt --config agent.planning.dilation_m=0.10 agent.collisions.wide_m=0.35 --episodes 5": (
        f"{_RUN} --semantics gt --config agent.planning.dilation_m=0.10 agent.collisions.wide_m=0.35 --episodes 1"
        f" {_SMALL} --out {{tmp}}/run",
    ),
    f"{_RUN} --explorer thorough --episodes 5": (
        f"{_RUN} --explorer thorough --semantics gt {_SMALL} --episodes 1 --out {{tmp}}/run",
    ),
    f"{_RUN} --semantics gt --episodes 100 --workers 2 --out runs/before": (
        f"{_RUN} --semantics gt {_SMALL} --episodes 1 --workers 1 --out {{tmp}}/before",
    ),
    f"{_RUN} --semantics gt --explorer thorough --episodes 100 --workers 2 --out runs/after": (
        f"{_RUN} --explorer thorough --semantics gt {_SMALL} --episodes 1 --workers 1 --out {{tmp}}/after",
    ),
    "stubborn compare runs/before runs/after": (
        f"{_RUN} --agent oracle {_SMALL} --episodes 1 --out {{tmp}}/before",
        f"{_RUN} --agent random {_SMALL} --episodes 1 --out {{tmp}}/after",
        "stubborn compare {tmp}/before {tmp}/after",
    ),
    # docs/configuration.md
    f"{_RUN} --semantics gt --config agent.planning.dilation_m=0.10 task.max_steps=300 --episodes 5": (
        f"{_RUN} --semantics gt --config agent.planning.dilation_m=0.10 task.max_steps=30 --episodes 1 {_SMALL}"
        " --out {tmp}/run",
    ),
    f"{_RUN} --semantics gt --config robot.body.radius_m=0.20 camera.height_m=0.5 camera.hfov_rad=1.7 --episodes 5": (
        f"{_RUN} --semantics gt --config robot.body.radius_m=0.20 camera.height_m=0.5 camera.hfov_rad=1.7 --episodes 1"
        f" {_SMALL} --out {{tmp}}/run",
    ),
    f"{_RUN} --noise realsense --config noise.depth.hole_share=1.0 task.success.distance_m=0.5 --episodes 5": (
        f"{_RUN} --noise realsense --config noise.depth.hole_share=1.0 task.success.distance_m=0.5 --episodes 1"
        f" {_SMALL} --semantics gt --out {{tmp}}/run",
    ),
    f"{_RUN} --config-file my_settings.toml --episodes 5": (
        f"{PYTHON} -c 'from pathlib import Path; "
        'Path("{tmp}/my.toml").write_text("[agent.planning]\\ndilation_m = 0.10\\n[task]\\nmax_steps = 30\\n")\'',
        f"{_RUN} --config-file {{tmp}}/my.toml --semantics gt --episodes 1 {_SMALL} --out {{tmp}}/run",
    ),
    # docs/gymnasium.md
    f"{PYTHON} examples/gym_agents.py": (f"{PYTHON} examples/gym_agents.py",),
    f"{PYTHON} examples/train_ppo.py --minutes 30 --envs 2 --out runs/ppo": (
        f"{PYTHON} examples/train_ppo.py --minutes 0.01 --envs 1 --steps 1 --max-steps 2 --trials 0 --out {{tmp}}/ppo",
    ),
    "stubborn bench --parts j": ("stubborn bench --quick --parts j",),
    # docs/plans.md
    "stubborn houses plans --split val --out runs/plans/val --workers 2": (
        "stubborn houses plans --split val --houses 1 --workers 1 --out {tmp}/plans",
    ),
    "stubborn houses plans --pool train --first-seed 0 --houses 500 --out runs/plans/many --workers 2": (
        "stubborn houses plans --pool train --first-seed 0 --kind studio --houses 1 --workers 1 --out {tmp}/plans",
    ),
    "stubborn houses plans --pool train --kind large --area-m2 280 --houses 50 --out runs/plans/large": Only(
        "a large house takes long; the command before it is tried with a small one"
    ),
    f"{_RUN} --agent frontier-avoid --semantics gt --record --episodes 100 --workers 2 --out runs/real": (
        f"{_RUN} --agent frontier-avoid --semantics gt --record --episodes 1 --workers 1 --out {{tmp}}/real",
    ),
    f"{PYTHON} -m tools.research.check_twin --plans runs/plans/val --runs runs/real --explore": (
        "stubborn houses plans --split val --houses 1 --out {tmp}/plans",
        f"{_RUN} --semantics gt --record --episodes 1 --out {{tmp}}/real",
        f"{PYTHON} -m tools.research.check_twin --plans {{tmp}}/plans --runs {{tmp}}/real --explore"
        " --out {tmp}/lines.jsonl",
    ),
    # docs/learned_exploration.md
    "stubborn houses plans --pool train --first-seed 0 --houses 240 --out runs/plans/train --workers 2": (
        "stubborn houses plans --pool train --first-seed 0 --kind studio --houses 1 --workers 1 --out {tmp}/plans",
    ),
    (
        "stubborn houses plans --pool train --kind large --area-m2 280 --first-seed 5000 --houses 42 "
        "--out runs/plans/large_train"
    ): Only("a large house takes long; the command before it is tried with a small one"),
    f"{_RUN} --agent semexp --semantics gt --episodes 5": (
        f"{_RUN} --agent semexp --semantics gt {_SMALL} --episodes 1 --out {{tmp}}/run",
    ),
    f"{_RUN} --agent stubborn-plus --explorer semexp --semantics gt --episodes 5": (
        f"{_RUN} --agent stubborn-plus --explorer semexp --semantics gt {_SMALL} --episodes 1 --out {{tmp}}/run",
    ),
    (
        "stubborn train semexp --plans runs/plans/train runs/plans/large_train --minutes 90 --seed 0 "
        "--out runs/semexp_0"
    ): (
        *_PLANS,
        "stubborn train semexp --plans {tmp}/plans --minutes 0.05 --seed 0 --out {tmp}/semexp",
    ),
    (
        "stubborn train semexp --plans runs/plans/train runs/plans/large_train --minutes 90 --seed 1 "
        "--out runs/semexp_1"
    ): Only("the command before it with another seed"),
    **{
        f"{_RUN} --agent semexp --semantics gt --config agent.explorer.{control} --episodes 5": (
            f"{_RUN} --agent semexp --semantics gt --config agent.explorer.{control} {_SMALL} --episodes 1 "
            "--out {tmp}/run",
        )
        for control in ("semantics=shuffled", "goal=wrong", "semantics=none")
    },
    (
        f"{PYTHON} -m tools.research.compare_explorers --plans runs/plans/train runs/plans/large_train --episodes 120 "
        "--explorers random-goals corners semexp semexp:sampled=false semexp:semantics=shuffled semexp:goal=wrong "
        "semexp:semantics=none"
    ): (
        *_PLANS,
        f"{PYTHON} -m tools.research.compare_explorers --plans {{tmp}}/plans --houses all --episodes 1 "
        "--explorers random-goals",
    ),
    (
        f"{PYTHON} -m tools.research.compare_explorers --plans runs/plans/train runs/plans/large_train "
        "--houses held-back-poni --episodes 72 --explorers frontier corners tour poni poni:goal=wrong "
        "poni:semantics=shuffled poni:semantics=none"
    ): (
        *_PLANS,
        f"{PYTHON} -m tools.research.compare_explorers --plans {{tmp}}/plans --houses all --episodes 1 "
        "--explorers poni:goal=wrong",
    ),
    "stubborn train poni --plans runs/plans/train runs/plans/large_train --minutes 30 --out runs/poni": (
        *_PLANS,
        "stubborn train poni --plans {tmp}/plans --minutes 0.05 --out {tmp}/poni",
    ),
    f"{PYTHON} -m tools.research.draw_potentials --samples runs/poni/samples --out potentials.png": (
        *_PLANS,
        "stubborn train poni --plans {tmp}/plans --minutes 0.05 --out {tmp}/poni",
        f"{PYTHON} -m tools.research.draw_potentials --samples {{tmp}}/poni/samples --out {{tmp}}/potentials.png",
    ),
    f"{_RUN} --agent poni --semantics gt": (
        f"{_RUN} --agent poni --semantics gt {_SMALL} --episodes 1 --out {{tmp}}/run",
    ),
    f"{_RUN} --agent stubborn-plus --explorer poni --semantics gt": (
        f"{_RUN} --agent stubborn-plus --explorer poni --semantics gt {_SMALL} --episodes 1 --out {{tmp}}/run",
    ),
    "stubborn houses plans --pool train --kind large --area-m2 280 --first-seed 6300 --houses 24 "
    "--out runs/plans/large_new": (
        "stubborn houses plans --pool train --kind large --area-m2 280 --first-seed 6300 --houses 1 --out {tmp}/plans",
    ),
    f"{PYTHON} -m tools.research.compare_explorers --plans runs/plans/large_new --houses all --episodes 96 --seed 11 "
    "--explorers corners tour poni informed-tour informed-tour:potentials.goal=wrong "
    "informed-tour:potentials.semantics=none": (
        *_PLANS,
        f"{PYTHON} -m tools.research.compare_explorers --plans {{tmp}}/plans --houses all --episodes 1 --seed 11 "
        "--explorers informed-tour:potentials.goal=wrong",
    ),
    f"{_RUN} --agent stubborn-plus --explorer informed-tour --semantics gt": (
        f"{_RUN} --agent stubborn-plus --explorer informed-tour --semantics gt {_SMALL} --episodes 1 --out {{tmp}}/run",
    ),
    f"{_RUN} --agent cloned --semantics gt": (
        f"{_RUN} --agent cloned --semantics gt {_SMALL} --episodes 1 --out {{tmp}}/run",
    ),
    f"{_RUN} --agent cloned --semantics gt --split val --episodes 200 --workers 2": (
        f"{_RUN} --agent cloned --semantics gt --split val --episodes 1 --workers 1 --out {{tmp}}/run",
    ),
    f"{_RUN} --agent oracle --split train --episodes 2000 --record --out runs/shown/oracle": (_SHOWN,),
    f"{PYTHON} -m tools.training.render_demonstrations runs/shown/oracle --out runs/demonstrations": (
        _SHOWN,
        f"{PYTHON} -m tools.training.render_demonstrations {{tmp}}/shown/oracle --out {{tmp}}/demonstrations",
    ),
    f"{PYTHON} -m tools.training.twin_demonstrations --houses 112 --episodes 40 --out runs/demonstrations/searches": (
        _SEARCHES,
    ),
    "stubborn train cloned --demonstrations runs/demonstrations --minutes 30 --threads 2 --out runs/cloned": (
        _SEARCHES,
        _CLONED,
    ),
    f"{_RUN} --agent cloned --semantics gt --config agent.weights=runs/cloned/cloned.safetensors": (
        _SEARCHES,
        _CLONED,
        f"{_RUN} --agent cloned --semantics gt --config agent.weights={{tmp}}/cloned/cloned.safetensors {_SMALL} "
        "--episodes 1 --out {tmp}/run",
    ),
    # docs/houses.md
    f"{_RUN} --house examples/my_house.xml --goal sofa --start-deg '1.0 2.5 90' --episodes 1": (
        f"{_RUN} {_SMALL} --start-deg '1.0 2.5 90' --episodes 1 --out {{tmp}}/run",
    ),
    "stubborn gallery --houses examples/my_house.xml --out runs/my_gallery": (
        "stubborn gallery --houses examples/my_house.xml --out {tmp}/gallery",
    ),
    "stubborn houses generate --first-seed 0 --houses 4 --out runs/mine/houses": (_HOUSES,),
    "stubborn houses check --pool heldout --seeds 200 --workers 2": (
        "stubborn houses check --pool heldout --seeds 1 --workers 1 --kind studio --views 2",
    ),
    "stubborn episodes --split runs/mine/houses --episodes 20": (_HOUSES, _EPISODES),
    f"{_RUN} --split runs/mine/houses --episodes 4": (
        _HOUSES,
        _EPISODES,
        f"{_RUN} --split {{tmp}}/houses --episodes 1 --agent oracle --out {{tmp}}/run",
    ),
    # docs/furniture.md
    f"{PYTHON} examples/my_furniture.py runs/my_house.xml": (
        f"{PYTHON} examples/my_furniture.py {{tmp}}/my_house.xml",
    ),
    "stubborn gallery --houses runs/my_house.xml --out runs/my_gallery": (
        f"{PYTHON} examples/my_furniture.py {{tmp}}/my_house.xml",
        "stubborn gallery --houses {tmp}/my_house.xml --out {tmp}/gallery",
    ),
    f"{_RUN} --house runs/my_house.xml --goal stool --episodes 2": (
        f"{PYTHON} examples/my_furniture.py {{tmp}}/my_house.xml",
        f"{_RUN} --house {{tmp}}/my_house.xml --goal stool --episodes 1 --agent oracle --out {{tmp}}/run",
    ),
    "stubborn import furniture --source /usr/share/sweethome3d/furniture --out runs/models": Only(
        "needs Debian's package; a catalogue of its form is read in tests/sim/housegen/test_imported.py"
    ),
    "stubborn import furniture --source my_models --out runs/my_models": _MODELS,
    "stubborn gallery --sheet --furniture runs/models --out runs/models_sheets": (
        *_MODELS,
        "stubborn gallery --sheet --furniture {tmp}/models --categories table --out {tmp}/sheets",
    ),
    "stubborn houses generate --furniture runs/models --houses 4 --out runs/furnished": (
        *_MODELS,
        "stubborn houses generate --furniture {tmp}/models --houses 1 --out {tmp}/furnished",
    ),
    "stubborn views --pool wide --furniture runs/models --views 20000 --shrink 2 --out views_models": (
        *_MODELS,
        "stubborn views --pool wide --furniture {tmp}/models --views 1 --shrink 4 --profile fast"
        " --out {tmp}/views --workers 1",
    ),
    "stubborn houses generate --furniture runs/models --transfer-test --out runs/transfer": _TRANSFER[:-1],
    "stubborn episodes --split runs/transfer --recipe val": _TRANSFER,
    "stubborn views --split runs/transfer --views 2000 --shrink 2 --profile fast --out views_transfer": (
        *_TRANSFER,
        "stubborn views --split {tmp}/transfer --views 1 --shrink 4 --profile fast --out {tmp}/views --workers 1",
    ),
    f"{_RUN} --split runs/transfer --episodes 20 --workers 2": (
        *_TRANSFER,
        f"{_RUN} --split {{tmp}}/transfer --episodes 1 --agent oracle --workers 1 --out {{tmp}}/run",
    ),
    "stubborn gallery --sheet --categories stool --pool train --out runs/gallery": (
        "stubborn gallery --sheet --categories fireplace --pool train --out {tmp}/gallery",
    ),
    # docs/report.md
    f"{_RUN} --semantics gt --noise harsh --episodes 100 --workers 2 --record --out runs/harsh": (
        f"{_RUN} --semantics gt --noise harsh {_SMALL} --agent oracle --episodes 1 --workers 1 --record"
        " --out {tmp}/harsh",
    ),
    "stubborn report runs/harsh": (_RECORDED, "stubborn report {tmp}/mine"),
    "stubborn report runs/before runs/after": (
        f"{_RUN} --agent oracle --goal bed --episodes 1 --out {{tmp}}/before",
        _RECORDED,
        "stubborn report {tmp}/before {tmp}/mine",
    ),
    "stubborn report runs/may runs/june runs/july": (
        _RECORDED,
        "stubborn report {tmp}/mine {tmp}/mine {tmp}/mine",
    ),
    # docs/gallery.md
    **{
        f"stubborn gallery --houses assets/mjcf_houses/{house}.xml --out runs/gallery": (
            "stubborn gallery --houses examples/my_house.xml --out {tmp}/gallery",
        )
        for house in ("val/val_03", "large/large_10", "hazards/hazards_02")
    },
    "stubborn traps report --out runs/traps --agents stubborn --traps glass_maze --headings 1": (
        "stubborn traps report --out {tmp}/traps --agents oracle --traps glass_pane --headings 1",
    ),
    f"{_RUN} --semantics noisy --episodes 6 --record --video --out runs/six": (
        f"{_RUN} --semantics noisy {_SMALL} --agent oracle --episodes 1 --record --video --out {{tmp}}/six",
    ),
    "stubborn report runs/six": (_RECORDED, "stubborn report {tmp}/mine"),
    # docs/performance.md
    "stubborn bench --out runs/bench.json": ("stubborn bench --quick --parts c --out {tmp}/bench.json",),
    "stubborn bench --parts a,b,d": ("stubborn bench --quick --parts a,b,d",),
    # docs/scale.md
    f"{_RUN} --episodes 200 --workers 2 --out runs/two": (
        f"{_RUN} {_SMALL} --agent oracle --episodes 2 --workers 2 --out {{tmp}}/two",
    ),
    f"{_RUN} --episodes 1000 --shard 0/4 --out runs/big": (_SHARDS[0],),
    f"{_RUN} --episodes 1000 --shard 1/4 --out runs/big": (_SHARDS[1],),
    "stubborn merge runs/big": (*_SHARDS, "stubborn merge {tmp}/big"),
    # docs/reproduce.md
    "stubborn reproduce ablation": (
        "stubborn reproduce ablation --episodes 1 --agents random oracle --out {tmp}/paper",
    ),
    "stubborn reproduce splits --splits val --semantics rednet --agents stubborn stubborn-plus --episodes 200"
    " --workers 2": (
        "stubborn reproduce splits --splits val --semantics rednet --agents stubborn stubborn-plus"
        " --episodes 1 --workers 1 --out {tmp}/tables",
    ),
    "stubborn reproduce splits --splits val --semantics noisy --agents stubborn stubborn-plus --episodes 200"
    " --workers 2": (
        "stubborn reproduce splits --splits val --semantics noisy --agents stubborn stubborn-plus"
        " --episodes 1 --workers 1 --out {tmp}/tables",
    ),
    "stubborn reproduce splits --splits val --agents stubborn stubborn-plus --episodes 200 --workers 2": (
        "stubborn reproduce splits --splits val --agents stubborn stubborn-plus --episodes 1 --workers 1"
        " --out {tmp}/tables",
    ),
    "stubborn reproduce splits --splits hazards large runs/transfer --semantics rednet --agents stubborn"
    " stubborn-plus --episodes 100": (
        *_TRANSFER,
        "stubborn reproduce splits --splits {tmp}/transfer --semantics rednet --agents"
        " 'random --config task.max_steps=5' --episodes 1 --out {tmp}/tables",
    ),
    "stubborn reproduce splits --splits test --semantics rednet --agents stubborn stubborn-plus --episodes"
    " 500 --workers 2": (
        "stubborn reproduce splits --splits test --semantics rednet --agents"
        " 'random --config task.max_steps=5' --episodes 1 --workers 1 --out {tmp}/tables",
    ),
    "stubborn reproduce splits --splits val large hazards --episodes 200 --workers 2": (
        "stubborn reproduce splits --splits val large --episodes 1 --workers 1 --agents random oracle "
        "--out {tmp}/paper",
    ),
    (
        "stubborn reproduce splits --splits val hazards --episodes 200 --workers 2 --agents stubborn "
        "'stubborn --config agent.planning.dilation_m=0.10' 'stubborn --explorer tour'"
    ): (
        "stubborn reproduce splits --splits val --episodes 1 --workers 1 --agents random "
        "'stubborn --config agent.planning.dilation_m=0.10 task.max_steps=3' --out {tmp}/paper",
    ),
    "stubborn reproduce explorers --episodes 200 --workers 2": (
        "stubborn reproduce explorers --episodes 1 --workers 1 --agents random oracle --out {tmp}/paper",
    ),
    "stubborn reproduce explorers --split large --episodes 300 --workers 2": (
        "stubborn reproduce explorers --split large --episodes 1 --workers 1 --agents oracle random --out {tmp}/paper",
    ),
    "stubborn reproduce all --episodes 1000 --workers 2 --out runs/paper": (
        "stubborn reproduce all --episodes 1 --workers 1 --agents random oracle --out {tmp}/paper",
    ),
    f"{PYTHON} -m tools.research.draw_trajectories runs/paper/stubborn_gt_none_val": (
        _RECORDED,
        f"{PYTHON} -m tools.research.draw_trajectories {{tmp}}/mine",
    ),
    f"{PYTHON} -m tools.research.draw_trajectories runs/paper/stubborn_gt_none_val runs/paper/poni_gt_none_val": (
        _RECORDED,
        f"{PYTHON} -m tools.research.draw_trajectories {{tmp}}/mine {{tmp}}/mine",
    ),
    # docs/datasets.md
    "stubborn views --split val --views 500 --shrink 2 --profile fast"
    " --extras instances normals poses --out views_objects": (f"{_VIEWS} --extras instances normals poses",),
    "stubborn views --split val --views 800 --sequence 40 --extras poses --out views_along": (
        f"{_VIEWS} --sequence 4 --extras poses",
    ),
    f"{PYTHON} examples/read_views.py views_val/views-000000.tar": (
        _VIEWS,
        f"{PYTHON} examples/read_views.py {{tmp}}/views/views-000000.tar",
    ),
    # docs/segmentation.md
    "stubborn views --split train --views 100000 --out views --workers 2": (
        "stubborn views --split train --views 1 --out {tmp}/views --workers 1",
    ),
    "stubborn views --split train --views 20000 --shrink 2 --profile fast --out views_small": (
        "stubborn views --split train --views 1 --shrink 2 --profile fast --out {tmp}/views",
    ),
    "stubborn views --pool wide --views 20000 --shrink 2 --profile fast --out views_wide": (
        "stubborn views --pool wide --views 1 --shrink 2 --profile fast --out {tmp}/views",
    ),
    "stubborn views --split val --views 2000 --shrink 2 --profile fast --out views_val": (_VIEWS,),
    "stubborn views --split val --views 500 --out views_val_whole": (
        "stubborn views --split val --views 1 --out {tmp}/views --workers 1",
    ),
    "stubborn views show --views views_objects --out views.png": (
        _VIEWS,
        "stubborn views show --views {tmp}/views --out {tmp}/views.png",
    ),
    "stubborn views unpack --views views_objects --out views_png": (
        _VIEWS,
        "stubborn views unpack --views {tmp}/views --out {tmp}/views_png",
    ),
    "stubborn train segmentation --views views_small --val-views views_val --out runs/rednet --hours 3": (
        _VIEWS,
        "stubborn train segmentation --views {tmp}/views --val-views {tmp}/views --out {tmp}/rednet"
        " --hours 0.01 --steps 2 --batch 2 --val-count 2",
    ),
    f"{_RUN} --semantics rednet --weights runs/rednet/rednet.safetensors": (
        f"{_RUN} --semantics rednet --weights {_SHIPPED} {_SMALL} --episodes 1 --out {{tmp}}/run",
    ),
    "stubborn evaluate --views views_val --calibrate --card card.md --weights runs/rednet/rednet.safetensors": (
        _VIEWS.replace("shard 4", "shard 2"),
        f'{PYTHON} -c \'import shutil; shutil.copy("stubborn/segmentation/weights/rednet.safetensors", "{{tmp}}")\'',
        "stubborn evaluate --views {tmp}/views --calibrate --card {tmp}/card.md --weights {tmp}/rednet.safetensors",
    ),
    "stubborn evaluate --count 400 --views runs/v/train runs/v/wide runs/v/imported runs/v/imported2 "
    "runs/v/val runs/v/transfer": (
        _VIEWS.replace("shard 4", "shard 2"),
        "stubborn evaluate --count 3 --views {tmp}/views",
    ),
    "stubborn evaluate objects --views views_val --out worst.png": (
        _VIEWS,
        "stubborn evaluate objects --views {tmp}/views --out {tmp}/worst.png",
    ),
    f"{_RUN} --episodes 50 --record --out runs/looked": (
        f"{_RUN} {_SMALL} --agent tests.helpers.players:make_quitter --episodes 1 --record --out {{tmp}}/looked",
    ),
    "stubborn evaluate mistakes runs/looked --out runs/false.png": (
        f"{_RUN} {_SMALL} --agent tests.helpers.players:make_quitter --episodes 1 --record --out {{tmp}}/looked",
        "stubborn evaluate mistakes {tmp}/looked --out {tmp}/false.png",
    ),
    "stubborn evaluate mistakes runs/looked --cause missed_detection --out runs/missed.png": Only(
        "a small run has none; tests/commands/test_evaluate_mistakes.py"
    ),
    "stubborn train segmentation --size published --init rednet_semmap_mp3d_40.pth --views views "
    "--val-views views_val_whole --out runs/finetuned --steps 20000": Only("needs the published checkpoint"),
    f"stubborn train segmentation --init {_SHIPPED} --window-px 160 --whole-share 0.5 --focus-share 0.5 "
    "--rare-share 0.15 --val-block-px 2 --rate 6e-4 --views views_small --val-views views_val --out runs/finer "
    "--hours 1": (
        _VIEWS,
        f"stubborn train segmentation --init {_SHIPPED} --window-px 64 --whole-share 0.5 --focus-share 0.5 "
        "--rare-share 0.15 --val-block-px 2 --rate 6e-4 --views {tmp}/views"
        " --val-views {tmp}/views --out {tmp}/finer --hours 0.01 --steps 2 --batch 2 --val-count 2",
    ),
    f"{PYTHON} -m tools.training.compare_networks --views views_small views_wide --val-views views_val "
    "--hours 1 --seeds 0 1 --out runs/networks": (
        _VIEWS,
        f"{PYTHON} -m tools.training.compare_networks --views {{tmp}}/views --val-views {{tmp}}/views "
        "--hours 0 --seeds 0 --out {tmp}/networks",
    ),
    # docs/results.md and the pages of results beside it
    f"{_RUN} --agent stubborn-plus --split val --episodes 100 --config "
    "'agent.seeker.look.bar=[[0,0.05],[40,0.05],[100,0.35],[200,0.45],[300,0.55],[400,0.64],[500,0.7]]'": (
        f"{_RUN} --agent stubborn-plus --split val --episodes 1 --out {{tmp}}/run --config task.max_steps=5 "
        "'agent.seeker.look.bar=[[0,0.05],[40,0.05],[100,0.35],[200,0.45],[300,0.55],[400,0.64],[500,0.7]]'",
    ),
    "stubborn reproduce verification --semantics rednet --episodes 200 --workers 2": (
        "stubborn reproduce verification --semantics rednet --episodes 1 --workers 1 --agents random oracle "
        "--out {tmp}/paper",
    ),
    f"{PYTHON} -m tools.maintenance.bench_against --against 'HEAD~10'": (
        f"{PYTHON} -m tools.maintenance.bench_against --against HEAD --parts start --rounds 1",
    ),
    f"{PYTHON} -m tools.maintenance.bench_against --against 'HEAD~10' --parts step --rounds 60": (
        f"{PYTHON} -m tools.maintenance.bench_against --against HEAD --parts start --rounds 1",
    ),
    # docs/traps.md
    f"{_RUN} --split traps --semantics gt --episodes 21": (
        f"{_RUN} --split traps --semantics gt --episodes 1 --agent oracle --out {{tmp}}/run",
    ),
    "stubborn traps report --out runs/traps": (
        "stubborn traps report --out {tmp}/traps --agents oracle --traps glass_pane --headings 1",
    ),
    # docs/watching.md
    f"{_RUN} --video --out runs/filmed": (f"{_RUN} {_SMALL} --episodes 1 --video --out {{tmp}}/filmed",),
    f"{_RUN} --only val_0018 val_0003 --video --out runs/two": (
        f"{_RUN} --only chair_legs_0 --split traps --agent oracle --semantics gt --video --out {{tmp}}/two",
    ),
    f"{_RUN} --video --noise harsh --split traps --episodes 2": (
        f"{_RUN} --video --noise harsh --split traps --episodes 1 --agent oracle --out {{tmp}}/traps",
    ),
    f"{_RUN} --view --episodes 2": Only("needs a display; tests/sim/test_live.py plays without one"),
    f"{_RUN} --rerun-save --out runs/logged": Only("needs the extra rerun; tests/sim/test_live.py where it is there"),
    f"{_RUN} --rerun --episodes 2": Only("needs a display and the extra rerun"),
    "stubborn web": Only("serves until it is interrupted; tests/sim/web/test_web.py starts it"),
    "stubborn teleop --out runs/me": Only("needs a terminal; tests/sim/test_teleop.py gives it one"),
    "stubborn teleop --goal sofa --noise realsense --video": Only("needs a terminal, as above"),
    # docs/verification.md
    "stubborn train verifier --semantics noisy --split train --episodes 2000 --workers 2": Only(
        "plays until there are candidates enough; tests/commands/test_train_verifier.py plays a few"
    ),
    "stubborn train verifier --semantics noisy --split val --episodes 200 --workers 2 --judge": (
        "stubborn train verifier --semantics noisy --split val --episodes 1 --workers 1 --judge"
        " --max-steps 20 --log {tmp}/log",
    ),
    "stubborn houses generate --furniture runs/models --furniture-split transfer --only-imported"
    " --first-seed 8000 --houses 60 --area-m2 100 --out runs/unseen3": _UNSEEN[:-1],
    "stubborn episodes --split runs/unseen3 --recipe val --episodes 720": _UNSEEN,
    "stubborn train verifier --semantics rednet --split runs/unseen3 --episodes 720": Only(
        "plays until there are candidates enough; tests/commands/test_train_verifier.py plays a few"
    ),
    "stubborn houses generate --furniture runs/models --furniture-split transfer --only-imported"
    " --first-seed 7000 --houses 24 --area-m2 100 --out runs/unseen": _UNSEEN[:-1],
    "stubborn episodes --split runs/unseen --recipe val --episodes 72": _UNSEEN,
    "stubborn train fusion --split runs/unseen --episodes 72": (
        *_UNSEEN,
        "stubborn train fusion --split {tmp}/unseen --episodes 3 --max-steps 60 --log {tmp}/log"
        " --out {tmp}/fusion.json",
    ),
    "stubborn train fusion --split val --episodes 15 --judge": (
        "stubborn train fusion --split val --episodes 1 --judge --max-steps 20 --log {tmp}/log",
    ),
    f"{_RUN} --semantics noisy --verification logistic": (
        f"{_RUN} --semantics noisy --verification logistic {_SMALL} --episodes 1 --out {{tmp}}/run",
    ),
    # docs/worlds.md
    f"{_RUN} --house flat.xml --labels labels.json --episodes 20 --record --out runs/flat": (_SCENE, _IN_SCENE),
    "stubborn report runs/flat": (_SCENE, _IN_SCENE, "stubborn report {tmp}/run"),
    "stubborn label --house flat.xml --out labels.json --picture runs/flat.png": (
        _SCENE,
        "stubborn label --house {tmp}/s/flat.xml --out {tmp}/flat.json --picture {tmp}/flat.png",
    ),
    "stubborn label --house flat.xml --labels labels.json --picture runs/flat.png": (
        _SCENE,
        f"stubborn label {_OF_SCENE} --picture {{tmp}}/flat.png",
    ),
    "stubborn gallery --house flat.xml --labels labels.json --out runs/flat_gallery": (
        _SCENE,
        f"stubborn gallery {_OF_SCENE} --out {{tmp}}/gallery",
    ),
    "stubborn views --house flat.xml --labels labels.json --views 500 --out runs/flat_views": (
        _SCENE,
        f"stubborn views {_OF_SCENE} --views 4 --shrink 4 --profile fast --out {{tmp}}/views",
    ),
    "stubborn episodes --house flat.xml --labels labels.json --episodes 20 --out runs/flat_split": (
        _SCENE,
        _PACKED,
    ),
    f"{_RUN} --split runs/flat_split --episodes 20": (
        _SCENE,
        _PACKED,
        f"{_RUN} --split {{tmp}}/split --episodes 1 --agent oracle --out {{tmp}}/run",
    ),
    f"{_RUN} --root {_KITCHEN} --house {_KITCHEN}/kitchen_assets/kitchen_env_model.xml"
    " --labels examples/worlds/kitchen.json --goal counter --semantics gt --episodes 2": _PACKAGE,
    f"{_RUN} --house runs/worlds/robosuite/models/assets/arenas/pegs_arena.xml"
    " --labels examples/worlds/pegs_arena.json --goal table --semantics gt --episodes 2": _PACKAGE,
    f"{_RUN} --house runs/pitch/pitch.xml --labels examples/worlds/pitch.json --goal gym_equipment --semantics gt"
    " --episodes 2": _PACKAGE,
    f"{_RUN} --robot runs/car/car.xml --house examples/my_house.xml --goal sofa --semantics gt --episodes 1"
    " --video": _PACKAGE,
    f"{_RUN} --robot carrier.xml --episodes 20": (
        _ROBOT,
        f"{_RUN} --robot {{tmp}}/r/carrier.xml {_SMALL} --episodes 1 --agent oracle --out {{tmp}}/run",
    ),
}
"""Each documented command: the commands to try, the last of them the same tool with the same options, or why not.

`{tmp}` is a scratch folder. Commands with `--help` need no line.
"""

STAND_INS = (
    "my_models",
    "/usr/share/sweethome3d/furniture",
    "my_house.xml",
    "my_settings.toml",
    "flat.xml",
    "labels.json",
    "carrier.xml",
    "runs/car/car.xml",
    "runs/pitch/pitch.xml",
    _KITCHEN,
    f"{_KITCHEN}/kitchen_assets/kitchen_env_model.xml",
    "runs/worlds/robosuite/models/assets/arenas/pegs_arena.xml",
    "rednet_semmap_mp3d_40.pth",
)
"""Files of the reader's that the docs speak of and that are not there."""
