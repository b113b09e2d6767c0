"""Code blocks of README and docs: what readers will copy, and how a test tries it without their hours.

Every command that stands in a `sh` block is tried as `TRIALS` says, or else as it stands with less to do (`reduced`).
Those that cannot be tried have a reason in `UNTRIED`, or in `TRIALS`.
"""

from __future__ import annotations

import re
import shlex
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from sim.app.commands.main import COMMANDS, split

ROOT = Path(__file__).resolve().parents[2]
PYTHON = ".venv/bin/python"
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
    """Returns a command in the form of `TRIALS`, which names `.venv/bin/stubborn run` and `python -m sim.run` alike."""
    first, rest = words[0], list(words[1:])
    if first in ("stubborn", ".venv/bin/stubborn", ".venv-ros2/bin/stubborn"):
        return shlex.join(["stubborn", *rest])
    if first not in ("python", PYTHON) or not rest:
        return shlex.join(words)
    if rest[0] == "-m" and rest[1] in ("sim.run", "sim.report", "sim.web"):
        return shlex.join(["stubborn", rest[1].removeprefix("sim."), *rest[2:]])
    return shlex.join([PYTHON, *rest])


def example_of(block: Block) -> str | None:
    """The file of examples/ that the paragraph above a block names, so that the block must be a part of it; or None."""
    lines = (ROOT / block.page).read_text(encoding="utf-8").splitlines()[: block.line - 1]
    paragraph = "\n".join(lines).rstrip().rpartition("\n\n")[2]
    named = _EXAMPLE.findall(paragraph)
    return named[-1] if named else None


def commands() -> dict[str, str]:
    """Every command of the shell blocks in its canonical form, and where it stands first."""
    texts: dict[str, str] = {}
    for page in pages():
        for block in blocks(page):
            if block.language == "sh":
                for line in block.text.replace("\\\n", " ").splitlines():
                    words = shlex.split(line, comments=True)
                    if words:
                        texts.setdefault(canonical(words), f"{block.page}:{block.line}")
    return texts


def unmarked_commands() -> dict[str, str]:
    """Commands outside of `sh` blocks: in running text, where `stubborn` is an agent too, and in blocks of `text`."""
    started = "|".join(sorted({name.split()[0] for name in COMMANDS}))
    begins = re.compile(
        rf"(?:\.venv/bin/)?(?:python (?:-m (?:sim|tools|stubborn)\b|tools/|examples/)|stubborn (?:{started})\b)"
    )
    texts: dict[str, str] = {}
    for page in pages():
        lines = [line for block in blocks(page) if block.language == "text" for line in block.text.splitlines()]
        prose = re.sub(r"^```.*?^```$", "", page.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
        for code in [*lines, *re.findall(r"`([^`]+)`", prose)]:
            if not begins.match(code):
                continue
            command = canonical(shlex.split(code.replace("\n", " "), comments=True))
            name, options = program_of(command)
            if options and not {"...", "|"} & set(options) and name:
                texts.setdefault(command, str(page.relative_to(ROOT)))
    return texts


def program_of(command: str) -> tuple[str, list[str]]:
    """Returns the program of a command (such as `views show`, `examples/x.py`), and its options."""
    words = shlex.split(command)
    if words[0] == "stubborn":
        return split(words[1:])
    if words[:2] == [PYTHON, "-m"]:
        module = words[2]
        return f"{module.replace('.', '/')}.py" if module.startswith("examples.") else module, words[3:]
    return words[1] if len(words) > 1 else "", words[2:]


@dataclass(frozen=True)
class Only:
    """A command that is parsed but not run, and why."""

    why: str


_RUN = "stubborn run"
_SMALL = "--house examples/my_house.xml --goal sofa"
_ANNOUNCED = "tests/sim/app/submissions/test_sealing.py announces, makes and reveals a split of one house"
_SHIPPED = "stubborn/segmentation/weights/rednet.safetensors"
LAB_PYTHON = ".venv-habitat/bin/python"
"""The Python that `stubborn habitat setup` makes."""
FOREIGN = (LAB_PYTHON, ".venv-ros2/bin/python", "ros2")
"""Programs of other environments."""
_RECORDED = f"{_RUN} --record --goal bed --episodes 1 --agent random --out {{tmp}}/mine"
_HOUSES = "stubborn houses generate --houses 1 --kind flat --area-m2 90 --rooms gym --hazards glass --out {tmp}/houses"
_SHOWN = f"{_RUN} --agent oracle --split val --episodes 2 --record --out {{tmp}}/shown/oracle"
_SEARCHES = (
    f"{PYTHON} -m tools.training.plan_demonstrations --first-seed 19 --houses 2 --kind studio --episodes 4 "
    "--out {tmp}/demonstrations/searches"
)
_TRAIN_CLONED = "stubborn train cloned --demonstrations {tmp}/demonstrations --minutes 0.1 --threads 2"
_CLONED = f"{_TRAIN_CLONED} --streams 2 --out {{tmp}}/cloned"
_PLANS = ("stubborn houses plans --pool train --kind studio --houses 4 --out {tmp}/plans",)
_MY_TRAPS = (
    f"{PYTHON} -c 'from tests.helpers.foreign import *; write_trap(Path(\"{{tmp}}/traps\"))'",
    "stubborn episodes --split {tmp}/traps --recipe traps",
)
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
_PACKAGE = Only("needs files of another package; tests/sim/app/commands/test_foreign_houses.py has a scene of its own")
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
    " --first-seed 7000 --houses 2 --area-m2 60 --out {tmp}/unseen",
    "stubborn episodes --split {tmp}/unseen --recipe val --episodes 3",
)
_SHARDS = tuple(f"{_RUN} {_SMALL} --agent oracle --episodes 2 --shard {i}/2 --out {{tmp}}/big" for i in (1, 2))

_PUBLISHED = "needs a repository of others, which is not part of this project"
_ENTRY = (
    f"{_RUN} --agent 'process:{sys.executable} tests/helpers/client_agent.py' --split val --episodes 1 --record"
    " --out {tmp}/entry"
)
_SUBMIT = "stubborn submit {tmp}/entry --name 'My agent' --authors 'A. Author' --out {tmp}/my_agent.json.gz"
_SEAL = "stubborn seal make --out {tmp}/sealed2027 --secret-file {tmp}/secret --houses 1 --episodes 2"
_COMPARED = (
    f"{_RUN} --agent oracle {_SMALL} --episodes 1 --out {{tmp}}/before",
    f"{_RUN} --agent random {_SMALL} --episodes 1 --out {{tmp}}/after",
    "stubborn compare {tmp}/before {tmp}/after",
)
_REPORTED = (
    f"{_RUN} --agent oracle --goal bed --episodes 1 --out {{tmp}}/before",
    _RECORDED,
    "stubborn report {tmp}/before {tmp}/mine",
)
_FLAT = "stubborn episodes --house examples/my_flat.xml --episodes 2 --out {tmp}/flat_split"
_MY_NETWORK = (
    _VIEWS.replace(" --shrink 4", ""),
    f"{PYTHON} -m examples.train_my_network --views {{tmp}}/views --minutes 0.01 --out {{tmp}}/my_network.pt",
)
_LAB = "needs habitat-lab; `make test-habitat` runs it"
_ROS = "needs ROS 2; `make test-ros` runs such a command"
UNTRIED = {
    "make ": "makes or needs a whole environment; .ci/run does that",
    "stubborn habitat": _LAB,
    LAB_PYTHON: _LAB,
    "stubborn ros": _ROS,
    ".venv-ros2/bin/python": _ROS,
    "ros2 launch": "needs a ROS installation with Nav2",
    "agent.boundary=namespace": "tests/sim/app/bridges/test_process_boundary.py runs agents behind the boundary",
    "stubborn serve detectors": "tests/sim/app/services runs servers and clients",
    "http://localhost": "needs a server; tests/sim/app/services runs servers and clients",
    "--agent vlm": "tests/sim/app/services/vlm runs the agent with a scripted server",
    "stubborn export lerobot": "needs pyarrow; tests/sim/app/bridges/test_lerobot.py exports runs",
    "stubborn words": "writes beside the shipped houses; tests/sim/app/commands/test_words.py makes a split",
    "runs/procthor10": "needs files of another package; tests/sim/app/commands/test_foreign_houses.py has scenes",
    "challenge/mine": _ANNOUNCED,
    "leaderboard/sealed4": _ANNOUNCED,
    "stubborn leaderboard": "a row needs 50 episodes; test_submission_commands.py makes tables of fewer",
    "--view ": "needs a display; tests/sim/app/viewers/test_live.py plays without one",
    "--rerun": "needs the extra rerun; tests/sim/app/viewers/test_live.py where it is there",
    "stubborn web": "serves until it is interrupted; tests/sim/app/web/test_web.py starts it",
    "stubborn bench": "takes minutes; tests/sim/app/commands/test_bench.py runs it with --quick",
}
"""How parts of documented commands begin that are parsed but not run, and why."""
TRIALS: dict[str, tuple[str, ...] | Only] = {
    # README
    "stubborn report runs/mine": (_RECORDED, "stubborn report {tmp}/mine"),
    # docs/index.md
    f"{_RUN} --list-agents": (f"{_RUN} --list-agents",),
    # docs/agents.md
    f"{_RUN} --agent 'process:old/bin/python my_agent.py'": (
        f"{_RUN} --agent 'process:{sys.executable} tests/helpers/client_agent.py' {_SMALL} --episodes 1 "
        "--config task.max_steps=5 --out {tmp}/run",
    ),
    "stubborn compare runs/before runs/after": _COMPARED,
    # docs/gymnasium.md
    f"{PYTHON} -m examples.train_ppo --minutes 30 --envs 2 --out runs/ppo": (
        f"{PYTHON} -m examples.train_ppo --minutes 0.01 --envs 1 --steps 1 --max-steps 2 --trials 0 --out {{tmp}}/ppo",
    ),
    f"{_RUN} --agent examples.ppo_agent:AGENT --config-file runs/ppo/run.toml {_SMALL} --video": (
        f"{PYTHON} -m examples.train_ppo --minutes 0.01 --envs 1 --steps 1 --max-steps 2 --trials 0 --out {{tmp}}/ppo",
        f"{_RUN} --agent examples.ppo_agent:AGENT --config-file {{tmp}}/ppo/run.toml {_SMALL} --episodes 1 --video"
        " --out {tmp}/filmed",
    ),
    "stubborn houses plans --split val --out runs/plans/val --workers 2": (
        "stubborn houses plans --split val --houses 1 --workers 1 --out {tmp}/plans",
    ),
    "stubborn houses plans --pool train --first-seed 0 --houses 240 --out runs/plans/train --workers 2": (
        "stubborn houses plans --pool train --first-seed 0 --kind studio --houses 1 --workers 1 --out {tmp}/plans",
    ),
    f"{_RUN} --agent oracle --split train --episodes 2000 --record --out runs/shown/oracle": (_SHOWN,),
    f"{PYTHON} -m tools.training.render_demonstrations runs/shown/oracle --out runs/demonstrations": (
        _SHOWN,
        f"{PYTHON} -m tools.training.render_demonstrations {{tmp}}/shown/oracle --out {{tmp}}/demonstrations",
    ),
    f"{PYTHON} -m tools.training.plan_demonstrations --houses 112 --episodes 40 --out runs/demonstrations/searches": (
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
    # docs/models.md
    # docs/lerobot.md
    # docs/tables/splits.md
    f"{PYTHON} -m tools.maintenance.split_report --workers 2 --published --out splits.md": (
        f"{PYTHON} -m tools.maintenance.split_report --splits hazards --episodes 2 --workers 1 --published --out "
        "{tmp}/splits.md",
    ),
    # docs/words.md
    f"{PYTHON} -m tools.research.check_descriptions --split val --per-house 180 --workers 2"
    " --out runs/descriptions.json": (
        f"{PYTHON} -m tools.research.check_descriptions --split val --per-house 2 --houses 1 --workers 1"
        " --out {tmp}/descriptions.json",
    ),
    # docs/stubborn_plus.md
    # docs/tutorials
    f"{_RUN} --agent random_agent:make --episodes 2 --video --out runs/random": Only(
        "tests/test_docs.py runs the agent"
    ),
    "stubborn compare runs/first_seeing runs/first_map": _COMPARED,
    "stubborn compare runs/random20 runs/cloned20": _COMPARED,
    "stubborn report runs/first_map": (_RECORDED, "stubborn report {tmp}/mine"),
    "stubborn report runs/pt_truth runs/pt_network": _REPORTED,
    f"{_RUN} --split runs/flat_split --agent stubborn-plus --semantics gt --episodes 20 --workers 2": (
        _FLAT,
        f"{_RUN} --split {{tmp}}/flat_split --agent oracle --semantics gt --episodes 1 --workers 1 --out {{tmp}}/run",
    ),
    "stubborn views show --views runs/views_train --out runs/views.png": (
        _VIEWS,
        "stubborn views show --views {tmp}/views --out {tmp}/views.png",
    ),
    f"{PYTHON} -m examples.train_my_network --views runs/views_train --minutes 10 --out runs/my_network.pt": (
        *_MY_NETWORK,
    ),
    "stubborn evaluate --views runs/views_test --semantics examples.my_segmentation:SEGMENTATION"
    " --config detector.weights=runs/my_network.pt": (
        *_MY_NETWORK,
        "stubborn evaluate --views {tmp}/views --semantics examples.my_segmentation:SEGMENTATION"
        " --config detector.weights={tmp}/my_network.pt",
    ),
    f"stubborn evaluate --views runs/views_test --weights {_SHIPPED}": (
        _VIEWS.replace("shard 4", "shard 2"),
        f"stubborn evaluate --views {{tmp}}/views --weights {_SHIPPED}",
    ),
    f"{_RUN} --agent stubborn-plus --semantics examples.my_segmentation:SEGMENTATION"
    " --config detector.weights=runs/my_network.pt --goal bed --episodes 5 --video": (
        *_MY_NETWORK,
        f"{_RUN} --agent stubborn-plus --semantics examples.my_segmentation:SEGMENTATION"
        f" --config detector.weights={{tmp}}/my_network.pt task.max_steps=5 {_SMALL} --episodes 1 --video"
        " --out {tmp}/run",
    ),
    "stubborn train segmentation --init shipped --init-share 0.5 --views runs/views_finer --val-views views_val "
    "--rate 0.0003 --hours 1 --out runs/finer": Only("docs/segmentation.md has the same command, which is tried"),
    f"{_RUN} --agent 'process:python my_agent.py' --split val --episodes 5 --record --out runs/walker": (_ENTRY,),
    "stubborn submit runs/walker --name Walker --authors 'A. Student' --out walker.json.gz": (
        _ENTRY,
        "stubborn submit {tmp}/entry --name Walker --authors 'A. Student' --out {tmp}/walker.json.gz",
    ),
    "stubborn verify walker.json.gz": (_ENTRY, _SUBMIT, "stubborn verify {tmp}/my_agent.json.gz"),
    # docs/houses.md
    "stubborn episodes --split runs/houses --episodes 20": (_HOUSES, _EPISODES),
    f"{_RUN} --split runs/houses --episodes 4": (
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
    "stubborn houses generate --furniture runs/models --houses 4 --out runs/furnished": (
        *_MODELS,
        "stubborn houses generate --furniture {tmp}/models --houses 1 --out {tmp}/furnished",
    ),
    "stubborn houses generate --furniture runs/models --transfer-test --out runs/transfer": _TRANSFER[:-1],
    "stubborn episodes --split runs/transfer --recipe val": _TRANSFER,
    "stubborn views --split runs/transfer --views 200 --seed 12 --shrink 2 --profile fast --out runs/views_transfer": (
        *_TRANSFER,
        "stubborn views --split {tmp}/transfer --views 2 --seed 12 --shrink 4 --profile fast --out {tmp}/views",
    ),
    "stubborn views --split runs/rooms --views 400 --seed 12 --shrink 2 --profile fast --out runs/views_rooms": (
        f"{_VIEWS} --seed 12",
    ),
    "stubborn evaluate --views runs/views_val runs/views_val_1": (
        _VIEWS.replace("shard 4", "shard 2"),
        "stubborn evaluate --views {tmp}/views {tmp}/views",
    ),
    "stubborn evaluate --views runs/views_val --weights runs/finer/rednet.safetensors"
    " --against stubborn/segmentation/weights/rednet.safetensors": (
        _VIEWS.replace("shard 4", "shard 2"),
        f"stubborn evaluate --views {{tmp}}/views --weights {_SHIPPED} --against {_SHIPPED}",
    ),
    f"{_RUN} --agent stubborn-plus --split runs/transfer --episodes 100": (
        *_TRANSFER,
        f"{_RUN} --agent stubborn-plus --split {{tmp}}/transfer --episodes 1 --config task.max_steps=5"
        " --out {tmp}/run",
    ),
    "stubborn report runs/harsh": (_RECORDED, "stubborn report {tmp}/mine"),
    "stubborn report runs/before runs/after": _REPORTED,
    "stubborn merge runs/big": (*_SHARDS, "stubborn merge {tmp}/big"),
    # docs/segmentation.md
    "stubborn train segmentation --furniture runs/models --hours 1.5 --out runs/rednet": Only(
        "renders 800 views at least; test_views_mix.py and test_train_segmentation.py try its parts"
    ),
    "stubborn train segmentation --init shipped --init-share 0.5 --views views --val-views views_val "
    "--rate 0.0003 --hours 1 --out runs/finer": (
        _VIEWS.replace("shard 4", "shard 2") + " --extras instances",
        "stubborn train segmentation --init shipped --init-share 0.5 --views {tmp}/views --val-views {tmp}/views "
        "--rate 0.0003 --hours 0.003 --batch 2 --out {tmp}/finer",
    ),
    "stubborn train names --views views --val-views views_val --minutes 30 --out runs/names": (
        _VIEWS.replace("--views 4", "--views 40").replace("shard 4", "shard 40") + " --extras instances",
        "stubborn train names --views {tmp}/views --val-views {tmp}/views --minutes 0.02 --batch 2 --val-count 4"
        " --out {tmp}/names",
    ),
    "stubborn views show --views views_objects --out views.png": (
        _VIEWS,
        "stubborn views show --views {tmp}/views --out {tmp}/views.png",
    ),
    "stubborn views unpack --views views_objects --out views_png": (
        _VIEWS,
        "stubborn views unpack --views {tmp}/views --out {tmp}/views_png",
    ),
    f"{_RUN} --semantics examples.my_segmentation:SEGMENTATION --config detector.weights=my_network.pt": (
        f"{PYTHON} -c 'import torch; from examples.my_segmentation import MyNetwork; "
        'torch.save(MyNetwork().state_dict(), "{tmp}/my_network.pt")\'',
        f"{_RUN} --semantics examples.my_segmentation:SEGMENTATION --config detector.weights={{tmp}}/my_network.pt"
        f" task.max_steps=5 {_SMALL} --episodes 1 --out {{tmp}}/run",
    ),
    "stubborn evaluate --views views_val --semantics examples.my_segmentation:SEGMENTATION"
    " --config detector.weights=my_network.pt": (
        _VIEWS,
        f"{PYTHON} -c 'import torch; from examples.my_segmentation import MyNetwork; "
        'torch.save(MyNetwork().state_dict(), "{tmp}/my_network.pt")\'',
        "stubborn evaluate --views {tmp}/views --semantics examples.my_segmentation:SEGMENTATION"
        " --config detector.weights={tmp}/my_network.pt",
    ),
    f"{_RUN} --semantics rednet --weights runs/rednet/rednet.safetensors": (
        f"{_RUN} --semantics rednet --weights {_SHIPPED} {_SMALL} --episodes 1 --out {{tmp}}/run",
    ),
    "stubborn evaluate --views views_val --calibrate --card card.md --weights runs/rednet/rednet.safetensors": (
        _VIEWS.replace("shard 4", "shard 2"),
        f'{PYTHON} -c \'import shutil; shutil.copy("stubborn/segmentation/weights/rednet.safetensors", "{{tmp}}")\'',
        "stubborn evaluate --views {tmp}/views --calibrate --card {tmp}/card.md --weights {tmp}/rednet.safetensors",
    ),
    "stubborn evaluate objects --views views_val --out worst.png": (
        _VIEWS,
        "stubborn evaluate objects --views {tmp}/views --out {tmp}/worst.png",
    ),
    "stubborn evaluate mistakes runs/mine --out runs/false.png": (
        f"{_RUN} {_SMALL} --agent tests.helpers.runners:make_quitter --episodes 1 --record --out {{tmp}}/looked",
        "stubborn evaluate mistakes {tmp}/looked --out {tmp}/false.png",
    ),
    # docs/leaderboard.md
    "stubborn submit runs/entry --name 'My agent' --authors 'A. Author' --out my_agent.json.gz": (_ENTRY, _SUBMIT),
    "stubborn verify my_agent.json.gz": (_ENTRY, _SUBMIT, "stubborn verify {tmp}/my_agent.json.gz"),
    "stubborn seal make --out challenge/sealed2027 --secret-file secret.txt --houses 20 --episodes 400": (_SEAL,),
    "stubborn seal reveal challenge/sealed2027.sealed.json --secret-file secret.txt --out revealed/sealed2027": (
        _SEAL,
        "stubborn seal reveal {tmp}/sealed2027.sealed.json --secret-file {tmp}/secret --out {tmp}/revealed/sealed2027",
    ),
    # docs/traps.md
    "stubborn episodes --split my_traps --recipe traps": _MY_TRAPS,
    "stubborn traps report --split my_traps --out runs/my_traps": (
        *_MY_TRAPS,
        "stubborn traps report --split {tmp}/traps --agents oracle --headings 1 --out {tmp}/report",
    ),
    # docs/watching.md
    # docs/worlds.md
    f"{_RUN} --house flat.xml --labels labels.json --episodes 20 --record --out runs/flat": (_SCENE, _IN_SCENE),
    "stubborn label --house flat.xml --out labels.json --picture runs/flat.png": (
        _SCENE,
        "stubborn label --house {tmp}/s/flat.xml --out {tmp}/flat.json --picture {tmp}/flat.png",
    ),
    "stubborn label --house flat.xml --labels labels.json --picture runs/flat.png": (
        _SCENE,
        f"stubborn label {_OF_SCENE} --picture {{tmp}}/flat.png",
    ),
    "stubborn episodes --house flat.xml --labels labels.json --episodes 20 --out runs/flat_split": (_SCENE, _PACKED),
    f"{_RUN} --root {_KITCHEN} --house {_KITCHEN}/kitchen_assets/kitchen_env_model.xml"
    " --labels examples/worlds/kitchen.json --goal counter --semantics gt --episodes 2": _PACKAGE,
    f"{_RUN} --robot carrier.xml --episodes 20": (
        _ROBOT,
        f"{_RUN} --robot {{tmp}}/r/carrier.xml {_SMALL} --episodes 1 --agent oracle --out {{tmp}}/run",
    ),
    # docs/differences.md
    "stubborn compare runs/default runs/paper_way": _COMPARED,
    # docs/motions.md
    "stubborn reproduce motions --semantics gt --split val --episodes 100 --workers 2": (
        "stubborn reproduce motions --semantics gt --split val --agents oracle 'oracle --motion sliding' --episodes 1"
        " --workers 1 --out {tmp}/paper",
    ),
    "stubborn reproduce splits --episodes 100 --agents stubborn stubborn-plus oracle": (
        "stubborn reproduce splits --agents random oracle --episodes 1 --out {tmp}/paper",
    ),
    f"{_RUN} --agent my_agent:make --semantics gt --episodes 2 --video --out runs/me": (
        f"{_RUN} --agent examples.my_agent:make --semantics gt --video {_SMALL} --episodes 1 --out {{tmp}}/me",
    ),
    "stubborn report runs/me": (_RECORDED, "stubborn report {tmp}/mine"),
    f"{_RUN} --config-file my_settings.toml": (
        f'{PYTHON} -c \'from pathlib import Path; Path("{{tmp}}/my.toml").write_text("[task]\\nmax_steps = 3\\n")\'',
        f"{_RUN} --config-file {{tmp}}/my.toml --semantics gt --episodes 1 {_SMALL} --out {{tmp}}/run",
    ),
    "stubborn reproduce splits --splits val hazards --agents stubborn 'stubborn --explorer tour'": (
        "stubborn reproduce splits --splits val hazards --agents oracle random --episodes 1 --out {tmp}/paper",
    ),
    f"{_RUN} --episodes 1000 --shard 1/2 --out runs/big": (_SHARDS[0],),
    f"{_RUN} --episodes 1000 --shard 2/2 --out runs/big": (_SHARDS[1],),
    "stubborn houses generate --furniture runs/models --furniture-split transfer --only-imported --houses 60"
    " --out runs/unseen": _UNSEEN[:-1],
    "stubborn episodes --split runs/unseen --recipe val --episodes 720": _UNSEEN,
    "stubborn train verifier --semantics rednet --weights runs/rednet/rednet.safetensors --split runs/unseen"
    " --episodes 720 --out runs/verifier.json": Only(
        "runs until there are enough candidates; tests/sim/app/commands/test_train_verifier.py runs a few episodes"
    ),
    f"{_RUN} --weights runs/rednet/rednet.safetensors --verifier runs/verifier.json": (
        f"{_RUN} --weights {_SHIPPED} --verifier stubborn/detection/verifiers/rednet.json {_SMALL} --episodes 1"
        " --out {tmp}/run",
    ),
    "stubborn train fusion --weights runs/rednet/rednet.safetensors --split runs/unseen --episodes 72"
    " --out runs/fusion.json": (
        *_UNSEEN,
        f"stubborn train fusion --weights {_SHIPPED} --split {{tmp}}/unseen --episodes 3 --max-steps"
        f" 60 --log {{tmp}}/log"
        " --out {tmp}/fusion.json",
    ),
    "stubborn houses plans --split runs/unseen --out runs/plans/unseen": (
        "stubborn houses generate --pool train --kind studio --houses 1 --out {tmp}/own",
        "stubborn episodes --split {tmp}/own --episodes 3",
        "stubborn houses plans --split {tmp}/own --out {tmp}/plans/own",
    ),
    "stubborn train context --plans runs/plans/unseen --out runs/context.json": (
        *_PLANS,
        "stubborn train context --plans {tmp}/plans --out {tmp}/context.json",
    ),
    f"{_RUN} --agent stubborn-plus --weights runs/rednet/rednet.safetensors --config"
    " agent.seeker.tracks.evidence.fusion=runs/fusion.json agent.seeker.context=runs/context.json": (
        f"{_RUN} --agent stubborn-plus --weights {_SHIPPED} --config"
        " agent.seeker.tracks.evidence.fusion=stubborn/detection/fusions/rednet.json"
        f" agent.seeker.context=stubborn/detection/context.json {_SMALL} --episodes 1"
        " --out {tmp}/run",
    ),
    "stubborn train poni --plans runs/plans/train --minutes 30 --out runs/poni": (
        *_PLANS,
        "stubborn train poni --plans {tmp}/plans --minutes 0.05 --out {tmp}/poni",
    ),
    "stubborn train semexp --plans runs/plans/train --minutes 90 --out runs/semexp": (
        *_PLANS,
        "stubborn train semexp --plans {tmp}/plans --minutes 0.05 --out {tmp}/semexp",
    ),
    f"{_RUN} --agent semexp --config agent.explorer.weights=runs/semexp/semexp.safetensors --episodes 5": (
        f"{_RUN} --agent semexp --config agent.explorer.weights=stubborn/exploration/weights/semexp.safetensors"
        f" {_SMALL} --semantics gt --episodes 1 --out {{tmp}}/run",
    ),
    "stubborn import furniture --source my_models --out runs/models": _MODELS,
    "stubborn import furniture infinigen --python infinigen/bin/python --out runs/infinigen": Only(
        "needs an installed Infinigen; tests/sim/app/commands/test_import_infinigen.py has a process in its place"
    ),
    "stubborn import furniture --source runs/infinigen my_models --out runs/models": _MODELS,
    "stubborn import procthor train.jsonl.gz --out runs/procthor": (
        _FOREIGN.replace("foreign", "procthor") + 'write_small_house(Path("{tmp}/source"))\'',
        "stubborn import procthor {tmp}/source/houses.jsonl.gz --out {tmp}/houses",
    ),
    "stubborn import molmospaces scenes --out runs/molmospaces": (
        _FOREIGN.replace("foreign", "molmospaces") + 'write_scene(Path("{tmp}/scenes"))\'',
        "stubborn import molmospaces {tmp}/scenes --out {tmp}/houses",
    ),
    "stubborn import robocasa kitchen.xml --root assets --out runs/kitchen": (
        _FOREIGN.replace("foreign", "robocasa") + 'write_kitchen(Path("{tmp}/source"))\'',
        "stubborn import robocasa {tmp}/source/scenes --root {tmp}/source --out {tmp}/houses --pictures 0",
    ),
    "stubborn import habitat hm3d/val --out runs/hm3d": (
        _FOREIGN.replace("foreign", "scanned") + 'write_hm3d(Path("{tmp}/source"), pictures=False)\'',
        "stubborn import habitat {tmp}/source --out {tmp}/houses --pictures 0",
    ),
    "stubborn import mesh flat.glb --out runs/flat_mesh": (
        _FOREIGN.replace("foreign", "scanned") + 'write_glb(Path("{tmp}/source"))\'',
        "stubborn import mesh {tmp}/source/flat.glb --out {tmp}/houses --pictures 0",
    ),
    "stubborn houses check --house runs/houses/house_00000.xml": (
        _HOUSES,
        "stubborn houses check --house {tmp}/houses/house_00000.xml --views 2",
    ),
    f"{_RUN} --agent habitat:my_agent:MyAgent --config agent.checkpoint=policy.pth": Only(
        "needs an agent of the reader's; tests/sim/app/bridges/test_habitat_agents.py writes one"
    ),
    # docs/ros.md
    "stubborn habitat dataset --split val --out data/datasets/objectnav/stubborn/v1/val": (
        "stubborn houses generate --split val --houses 1 --out {tmp}/one",
        "stubborn episodes --split {tmp}/one --episodes 2 --no-pictures",
        "stubborn habitat dataset --split {tmp}/one --out {tmp}/lab/one",
    ),
    f"{_RUN} --agent 'process:env/bin/python stubborn_client.py Stubborn/eval.py --evaluation local --timestep_limit"
    " 451' --config agent.interface=habitat": Only(_PUBLISHED),
    "stubborn traps report --split contact-val --agents oracle stubborn --out runs/contact": (
        "stubborn traps report --split contact-val --agents oracle --traps jam_easy_00 --no-pictures --out {tmp}/out",
    ),
}
"""Commands that need other files first, or more than `reduced`: what is run, at last the tool with the same options.

`{tmp}` is a scratch folder.
"""

STAND_INS = (
    "leaderboard",
    "shipped",
    "secret.txt",
    "my_traps",
    "my_models",
    "train.jsonl.gz",
    "val.jsonl.gz",
    "kitchen.xml",
    "assets",
    "hm3d/val",
    "flat.glb",
    "scenes",
    "/usr/share/sweethome3d/furniture",
    "infinigen/bin/python",
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
_FEWER = {
    "run": {"--episodes": "1", "--workers": "1"},
    "episodes": {"--episodes": "1"},
    "views": {"--views": "1", "--views-per-shard": "1", "--workers": "1"},
    "houses generate": {"--houses": "1"},
}
"""Options of commands with their values in a trial, where the command has them."""
_PLACES = {"--house", "--split", "--only", "--goal"}
"""Options of `stubborn run` that name its episodes."""


def trial_of(command: str) -> tuple[str, ...] | Only:
    """Returns the commands that try a documented one, or why it is not tried."""
    if command in TRIALS:
        return TRIALS[command]
    whys = [why for part, why in UNTRIED.items() if f" {part}" in f" {command}"]
    return Only(whys[0]) if whys else (reduced(command),)


def reduced(command: str) -> str:
    """Returns a command with one episode or view and one process, whose results go to `{tmp}`; agents get 3 steps."""
    program, words = program_of(command)
    head = shlex.split(command)[: -len(words)] if words else shlex.split(command)
    for option, value in {"--out": "{tmp}/out", **_FEWER.get(program, {})}.items():
        if option in words:
            words[words.index(option) + 1] = value
    if program == "run" and "--list-agents" not in words:
        words = [word for word in words if not word.startswith("task.max_steps=")]
        given = set(words)
        if "--config" not in given:
            words.append("--config")
        words.insert(words.index("--config") + 1, "task.max_steps=3")
        if not given & _PLACES:
            words += shlex.split(_SMALL)
        if not given & {"--episodes", "--only"}:
            words += ["--episodes", "1"]
        if "--out" not in given:
            words += ["--out", "{tmp}/out"]
    return shlex.join([*head, *words])
