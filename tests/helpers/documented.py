"""Code blocks of README and docs: what readers will copy, and how a test tries it without their hours.

Every command that stands in a `sh` block is tried as `TRIALS` says, or else as it stands, with other files (`INPUTS`)
and less to do (`reduced`). Those that cannot be tried have a reason in `UNTRIED`, or in `TRIALS`.
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
_HOUSES = "stubborn houses generate --houses 1 --kind flat --area-m2 90 --rooms gym --hazards glass --out {tmp}/houses"
_SEARCHES = (
    f"{PYTHON} -m tools.training.plan_demonstrations --first-seed 19 --houses 2 --kind studio --episodes 4 "
    "--out {tmp}/demonstrations/searches"
)
_CLONED = (
    "stubborn train cloned --demonstrations {tmp}/demonstrations --minutes 0.1 --threads 2 --streams 2"
    " --out {tmp}/cloned"
)
_PLANS = ("stubborn houses plans --pool train --kind studio --houses 4 --out {tmp}/plans",)
_MY_TRAPS = (
    f"{PYTHON} -c 'from tests.helpers.foreign import *; write_trap(Path(\"{{tmp}}/traps\"))'",
    "stubborn episodes --split {tmp}/traps --recipe traps",
)
_EPISODES = "stubborn episodes --split {tmp}/houses --episodes 3"
_VIEWS = (
    "stubborn views --split val --views 4 --views-per-shard 2 --shrink 4 --profile fast --extras instances"
    " --out {tmp}/views"
)
_FOREIGN = f"{PYTHON} -c 'from pathlib import Path; from tests.helpers.foreign import *; "
_SCENE = _FOREIGN + 'write_scene(Path("{tmp}/s"))\''
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

_ENTRY = (
    f"{_RUN} --agent 'process:{sys.executable} tests/helpers/client_agent.py' --split val --episodes 1 --record"
    " --out {tmp}/entry"
)
_SUBMIT = "stubborn submit {tmp}/entry --name 'My agent' --authors 'A. Author' --out {tmp}/my_agent.json.gz"
_SEAL = "stubborn seal make --out {tmp}/sealed2027 --secret-file {tmp}/secret --houses 1 --episodes 2"
_PPO = f"{PYTHON} -m examples.train_ppo --minutes 0.01 --envs 1 --steps 1 --max-steps 2 --trials 0 --out {{tmp}}/ppo"
_BEFORE = ("{tmp}/before", (f"{_RUN} --agent oracle --goal bed --episodes 1 --out {{tmp}}/before",))
_AFTER = ("{tmp}/mine", (f"{_RUN} --agent random --goal bed --episodes 1 --record --out {{tmp}}/mine",))
_NETWORK = (
    "{tmp}/my_network.pt",
    (
        f"{PYTHON} -c 'import torch; from examples.my_segmentation import MyNetwork; "
        'torch.save(MyNetwork().state_dict(), "{tmp}/my_network.pt")\'',
    ),
)
_MADE_VIEWS = ("{tmp}/views", (_VIEWS,))
_CLIENT = (f"process:{sys.executable} tests/helpers/client_agent.py", ())
INPUTS: dict[str, tuple[str, tuple[str, ...]]] = {
    **dict.fromkeys(("runs/before", "runs/default", "runs/first_seeing", "runs/pt_truth", "runs/random20"), _BEFORE),
    **dict.fromkeys(("runs/after", "runs/paper_way", "runs/pt_network", "runs/cloned20"), _AFTER),
    **dict.fromkeys(("runs/mine", "runs/me", "runs/first_map", "runs/harsh"), _AFTER),
    **dict.fromkeys(("runs/views_train", "runs/views_test", "runs/views_val", "runs/views_val_1"), _MADE_VIEWS),
    **dict.fromkeys(("views_val", "views_objects"), _MADE_VIEWS),
    **dict.fromkeys(("runs/plans/train", "runs/plans/unseen"), ("{tmp}/plans", _PLANS)),
    **dict.fromkeys(("runs/entry", "runs/walker"), ("{tmp}/entry", (_ENTRY,))),
    **dict.fromkeys(("my_agent.json.gz", "walker.json.gz"), ("{tmp}/my_agent.json.gz", (_ENTRY, _SUBMIT))),
    **dict.fromkeys(("my_network.pt", "runs/my_network.pt"), _NETWORK),
    **dict.fromkeys(("runs/rednet/rednet.safetensors", "runs/finer/rednet.safetensors"), (_SHIPPED, ())),
    **dict.fromkeys(("process:python my_agent.py", "process:old/bin/python my_agent.py"), _CLIENT),
    "my_agent:make": ("examples.my_agent:make", ()),
    "runs/verifier.json": ("stubborn/detection/verifiers/rednet.json", ()),
    "runs/fusion.json": ("stubborn/detection/fusions/rednet.json", ()),
    "runs/context.json": ("stubborn/detection/context.json", ()),
    "runs/semexp/semexp.safetensors": ("stubborn/exploration/weights/semexp.safetensors", ()),
    "runs/cloned/cloned.safetensors": ("{tmp}/cloned/cloned.safetensors", (_SEARCHES, _CLONED)),
    "runs/shown/oracle": (
        "{tmp}/shown/oracle",
        (f"{_RUN} --agent oracle --split val --episodes 2 --record --out {{tmp}}/shown/oracle",),
    ),
    "runs/ppo/run.toml": ("{tmp}/ppo/run.toml", (_PPO,)),
    "my_settings.toml": (
        "{tmp}/my.toml",
        (f'{PYTHON} -c \'from pathlib import Path; Path("{{tmp}}/my.toml").write_text("[task]\\nmax_steps = 3\\n")\'',),
    ),
    "runs/big": ("{tmp}/big", _SHARDS),
    "runs/flat_split": (
        "{tmp}/flat_split",
        ("stubborn episodes --house examples/my_flat.xml --episodes 2 --out {tmp}/flat_split",),
    ),
    "runs/houses": ("{tmp}/houses", (_HOUSES, _EPISODES)),
    "runs/rooms": ("val", ()),
    "runs/models": ("{tmp}/models", _MODELS),
    "runs/transfer": ("{tmp}/transfer", _TRANSFER),
    "runs/my_house.xml": ("{tmp}/my_house.xml", (f"{PYTHON} examples/my_furniture.py {{tmp}}/my_house.xml",)),
    "flat.xml": ("{tmp}/s/flat.xml", (_SCENE,)),
    "labels.json": ("{tmp}/s/labels.json", (_SCENE,)),
    "carrier.xml": ("{tmp}/r/carrier.xml", (_FOREIGN + 'write_robot(Path("{tmp}/r"))\'',)),
    "train.jsonl.gz": (
        "{tmp}/source/houses.jsonl.gz",
        (_FOREIGN.replace("foreign", "procthor") + 'write_small_house(Path("{tmp}/source"))\'',),
    ),
    "scenes": ("{tmp}/scenes", (_FOREIGN.replace("foreign", "molmospaces") + 'write_scene(Path("{tmp}/scenes"))\'',)),
}
"""What documented commands read and is not there: what a trial reads in its place, and the commands that write that."""
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
    f"{_RUN} --list-agents": (f"{_RUN} --list-agents",),
    f"{PYTHON} -m examples.train_ppo --minutes 30 --envs 2 --out runs/ppo": (_PPO,),
    "stubborn houses plans --split val --out runs/plans/val --workers 2": (
        "stubborn houses plans --split val --houses 1 --workers 1 --out {tmp}/plans",
    ),
    "stubborn houses plans --pool train --first-seed 0 --houses 240 --out runs/plans/train --workers 2": (
        "stubborn houses plans --pool train --first-seed 0 --kind studio --houses 1 --workers 1 --out {tmp}/plans",
    ),
    f"{PYTHON} -m tools.training.plan_demonstrations --houses 112 --episodes 40 --out runs/demonstrations/searches": (
        _SEARCHES,
    ),
    "stubborn train cloned --demonstrations runs/demonstrations --minutes 30 --threads 2 --out runs/cloned": (
        _SEARCHES,
        _CLONED,
    ),
    f"{PYTHON} -m tools.maintenance.split_report --workers 2 --published --out splits.md": (
        f"{PYTHON} -m tools.maintenance.split_report --splits hazards --episodes 2 --workers 1 --published --out "
        "{tmp}/splits.md",
    ),
    f"{PYTHON} -m tools.research.check_descriptions --split val --per-house 180 --workers 2"
    " --out runs/descriptions.json": (
        f"{PYTHON} -m tools.research.check_descriptions --split val --per-house 2 --houses 1 --workers 1"
        " --out {tmp}/descriptions.json",
    ),
    f"{_RUN} --agent random_agent:make --episodes 2 --video --out runs/random": Only(
        "tests/test_docs.py runs the agent"
    ),
    f"{PYTHON} -m examples.train_my_network --views runs/views_train --minutes 10 --out runs/my_network.pt": (
        _VIEWS.replace(" --shrink 4", ""),
        f"{PYTHON} -m examples.train_my_network --views {{tmp}}/views --minutes 0.01 --out {{tmp}}/my_network.pt",
    ),
    "stubborn train segmentation --init shipped --init-share 0.5 --views runs/views_finer --val-views views_val "
    "--rate 0.0003 --hours 1 --out runs/finer": Only("docs/segmentation.md has the same command, which is tried"),
    "stubborn episodes --split runs/houses --episodes 20": (_HOUSES, _EPISODES),
    f"{PYTHON} examples/my_furniture.py runs/my_house.xml": (
        f"{PYTHON} examples/my_furniture.py {{tmp}}/my_house.xml",
    ),
    "stubborn houses generate --furniture runs/models --transfer-test --out runs/transfer": _TRANSFER[:-1],
    "stubborn episodes --split runs/transfer --recipe val": _TRANSFER,
    "stubborn train segmentation --furniture runs/models --hours 1.5 --out runs/rednet": Only(
        "renders 800 views at least; test_views_mix.py and test_train_segmentation.py try its parts"
    ),
    "stubborn train segmentation --init shipped --init-share 0.5 --views views --val-views views_val "
    "--rate 0.0003 --hours 1 --out runs/finer": (
        _VIEWS,
        "stubborn train segmentation --init shipped --init-share 0.5 --views {tmp}/views --val-views {tmp}/views "
        "--rate 0.0003 --hours 0.003 --batch 2 --out {tmp}/finer",
    ),
    "stubborn train names --views views --val-views views_val --minutes 30 --out runs/names": (
        _VIEWS.replace("--views 4", "--views 40").replace("shard 2", "shard 40"),
        "stubborn train names --views {tmp}/views --val-views {tmp}/views --minutes 0.02 --batch 2 --val-count 4"
        " --out {tmp}/names",
    ),
    "stubborn evaluate --views views_val --calibrate --card card.md --weights runs/rednet/rednet.safetensors": (
        _VIEWS,
        f'{PYTHON} -c \'import shutil; shutil.copy("stubborn/segmentation/weights/rednet.safetensors", "{{tmp}}")\'',
        "stubborn evaluate --views {tmp}/views --calibrate --card {tmp}/card.md --weights {tmp}/rednet.safetensors",
    ),
    "stubborn evaluate mistakes runs/mine --out runs/false.png": (
        f"{_RUN} {_SMALL} --agent tests.helpers.runners:make_quitter --episodes 1 --record --out {{tmp}}/looked",
        "stubborn evaluate mistakes {tmp}/looked --out {tmp}/false.png",
    ),
    "stubborn seal make --out challenge/sealed2027 --secret-file secret.txt --houses 20 --episodes 400": (_SEAL,),
    "stubborn seal reveal challenge/sealed2027.sealed.json --secret-file secret.txt --out revealed/sealed2027": (
        _SEAL,
        "stubborn seal reveal {tmp}/sealed2027.sealed.json --secret-file {tmp}/secret --out {tmp}/revealed/sealed2027",
    ),
    "stubborn episodes --split my_traps --recipe traps": _MY_TRAPS,
    "stubborn traps report --split my_traps --out runs/my_traps": (
        *_MY_TRAPS,
        "stubborn traps report --split {tmp}/traps --agents oracle --headings 1 --out {tmp}/report",
    ),
    f"{_RUN} --root {_KITCHEN} --house {_KITCHEN}/kitchen_assets/kitchen_env_model.xml"
    " --labels examples/worlds/kitchen.json --goal counter --semantics gt --episodes 2": _PACKAGE,
    "stubborn reproduce motions --semantics gt --split val --episodes 100 --workers 2": (
        "stubborn reproduce motions --semantics gt --split val --agents oracle 'oracle --motion sliding' --episodes 1"
        " --workers 1 --out {tmp}/paper",
    ),
    "stubborn reproduce motions --semantics gt --split hazards --episodes 50 --workers 2": (
        "stubborn reproduce motions --semantics gt --split hazards --agents oracle --episodes 1 --workers 1"
        " --out {tmp}/paper",
    ),
    "stubborn reproduce splits --episodes 200 --agents stubborn stubborn-plus oracle": (
        "stubborn reproduce splits --agents random oracle --episodes 1 --out {tmp}/paper",
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
    "stubborn import furniture --source my_models --out runs/models": _MODELS,
    "stubborn import furniture infinigen --python infinigen/bin/python --out runs/infinigen": Only(
        "needs an installed Infinigen; tests/sim/app/commands/test_import_infinigen.py has a process in its place"
    ),
    "stubborn import furniture --source runs/infinigen my_models --out runs/models": _MODELS,
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
    f"{_RUN} --agent habitat:my_agent:MyAgent --config agent.checkpoint=policy.pth": Only(
        "needs an agent of the reader's; tests/sim/app/bridges/test_habitat_agents.py writes one"
    ),
    "stubborn habitat dataset --split val --out data/datasets/objectnav/stubborn/v1/val": (
        "stubborn houses generate --split val --houses 1 --out {tmp}/one",
        "stubborn episodes --split {tmp}/one --episodes 2 --no-pictures",
        "stubborn habitat dataset --split {tmp}/one --out {tmp}/lab/one",
    ),
    f"{_RUN} --agent 'process:env/bin/python stubborn_client.py Stubborn/eval.py --evaluation local --timestep_limit"
    " 451' --config agent.interface=habitat": Only("needs a repository of others, which is not part of this project"),
    "stubborn traps report --split contact-val --agents oracle stubborn --out runs/contact": (
        "stubborn traps report --split contact-val --agents oracle --traps jam_easy_00 --no-pictures --out {tmp}/out",
    ),
}
"""Commands for which `INPUTS` and `reduced` are not enough: what is run, at last the tool with the same options.

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
    "train poni": {"--minutes": "0.05"},
    "train semexp": {"--minutes": "0.05"},
}
"""Options of commands with their values in a trial, where the command has them."""
_PLACES = {"--house", "--split", "--only", "--goal"}
"""Options of `stubborn run` that name its episodes."""


_OUTPUTS = ("--out", "--picture")


def trial_of(command: str) -> tuple[str, ...] | Only:
    """Returns the commands that try a documented one, or why it is not tried."""
    if command in TRIALS:
        return TRIALS[command]
    whys = [why for part, why in UNTRIED.items() if f" {part}" in f" {command}"]
    if whys:
        return Only(whys[0])
    program, words = program_of(command)
    first = shlex.split(command)[: -len(words)] if words else shlex.split(command)
    makers: dict[str, None] = {}
    for at, word in enumerate(words):
        option, equals, value = word.rpartition("=")
        name = next((name for name in INPUTS if value == name or value.startswith(f"{name}/")), None)
        if name is not None and words[at - 1] not in _OUTPUTS:
            file, written_by = INPUTS[name]
            words[at] = option + equals + file + value.removeprefix(name)
            makers |= dict.fromkeys(written_by)
    return (*makers, shlex.join([*first, *reduced(program, words)]))


def reduced(program: str, words: Sequence[str]) -> list[str]:
    """Returns the options of a command with less to do: one episode or view, and one process; agents get 3 steps.

    What it writes goes to `{tmp}`.
    """
    less = [word for word in words if not word.startswith("task.max_steps=")]
    given = set(words)
    for at, option in enumerate(less[:-1]):
        if option in _OUTPUTS:
            less[at + 1] = f"{{tmp}}/{Path(less[at + 1]).name}"
        elif option in _FEWER.get(program, {}):
            less[at + 1] = _FEWER[program][option]
    if program == "run":
        if "--config" not in given:
            less.append("--config")
        less.insert(less.index("--config") + 1, "task.max_steps=3")
        if not given & _PLACES:
            less += shlex.split(_SMALL)
        if not given & {"--episodes", "--only"}:
            less += ["--episodes", "1"]
        if "--out" not in given:
            less += ["--out", "{tmp}/run"]
    return less
