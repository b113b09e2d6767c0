"""A segmentation of a user's runs beside the shipped ones: checked, recorded, and true about what it reads."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from sim.app.commands.run import entry
from sim.app.composition.own_segmentation import OwnSegmenter
from sim.app.composition.perception import StatedByAgent, seen_by
from sim.app.composition.segmenters import find_segmentation
from sim.app.composition.setup import resolve
from sim.app.options import RunOptions
from sim.core.errors import AgentError, ConfigError
from sim.core.interface import MPCAT40_ID, AgentSpec, CameraModel, Observation, Perceived, Scores, SegmenterSpec
from sim.env.objectnav import ObjectNavEnv
from stubborn.detection.wished import WishedSegmenter
from tests.helpers import segmentations, wording
from tests.helpers.agents import Ahead

SMALL = ("camera.width_px=64", "camera.height_px=48", "task.max_steps=2")
FLAT = "tests.helpers.segmentations:FLAT"


def run(house: Path, out: Path, *options: str) -> int:
    command = ["--house", str(house), "--goal", "sofa", "--episodes", "1", "--out", str(out), *options]
    return entry([*command, "--config", *SMALL])


def test_a_segmentation_of_ones_own_is_run_recorded_and_named(
    house: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    segmentations.ASKED.clear()
    command = ["--house", str(house), "--goal", "sofa", "--episodes", "1", "--out", str(tmp_path), "--semantics", FLAT]
    command += ["--step-timeout", "0"]  # in this process
    assert entry([*command, "--config", *SMALL, "detector.level=0.125"]) == 0
    printed = " ".join(capsys.readouterr().out.split())
    assert f"segmentation: {FLAT};" in printed
    assert "No parameters are fitted to segmentation of kind 'flat'" in printed
    assert "`--verification none` accepts every candidate" in printed
    record = json.loads((tmp_path / "config.json").read_text())
    assert record["config"]["detector"] == {"level": 0.125}
    assert record["segmentation"]["kind"] == "flat"
    assert record["segmentation"]["has_fitted_parameters"] is False
    assert "+" in record["versions"]["code"]  # the hash of the user's code follows
    line = json.loads((tmp_path / "results.jsonl").read_text())
    assert (line["semantics"], line["uses_ground_truth"], line["num_steps"]) == (FLAT, False, 2)
    assert len(segmentations.ASKED) == 2  # each frame once
    assert set.union(*segmentations.ASKED) == {"rgb", "depth", "gps", "compass", "objectgoal"}


@pytest.mark.costly
def test_a_segmentation_that_reads_the_truth_is_marked(house: Path, tmp_path: Path) -> None:
    assert run(house, tmp_path, "--semantics", "tests.helpers.segmentations:Truth") == 0
    assert json.loads((tmp_path / "results.jsonl").read_text())["uses_ground_truth"] is True


@pytest.mark.parametrize(
    ("returned", "message"),
    [
        (Scores(np.zeros((7, 7), np.float32), np.zeros((7, 7), np.float32)), "an array of shape"),
        (Scores(np.full((48, 64), 2.0, np.float32), np.zeros((48, 64), np.float32)), "probabilities in"),
        (Scores(np.full((48, 64), np.nan, np.float32), np.zeros((48, 64), np.float32)), "probabilities in"),
        ((np.zeros((48, 64), np.float32),), "it returns Scores"),
        (ValueError("no weights"), "ValueError: no weights"),
    ],
)
def test_a_result_that_is_not_allowed_is_named_with_the_segmentation(
    returned: object, message: str, house: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(segmentations.Wrong, "returned", returned)
    name = "tests.helpers.segmentations:Wrong"
    env = ObjectNavEnv(house=house, sensors=("rgb", "depth"), camera=CameraModel(width_px=64, height_px=48))
    segmenter = find_segmentation(name, None).make(env, None)
    observation, _ = env.reset(seed=0)
    with pytest.raises(AgentError, match=f"Segmentation '{name}'.*{message}"):
        segmenter.scores(observation, "sofa")
    env.close()


@pytest.mark.parametrize(
    "agent", [("stubborn-plus",), ("cloned",), ("stubborn", "--explorer", "informed-tour")], ids=lambda words: words[-1]
)
def test_a_segmentation_without_posteriors_is_refused_before_the_run_of_an_agent_that_reads_them(
    agent: tuple[str, ...], house: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    name = "tests.helpers.segmentations:Wrong"
    assert run(house, tmp_path, "--semantics", name, "--step-timeout", "0", "--agent", *agent) == 2
    captured = capsys.readouterr()
    said = " ".join(captured.err.split())
    assert f"Segmentation '{name}' has no method posteriors, which agent '{agent[0]}' reads" in said
    assert said.count("posteriors") == 1
    results = tmp_path / "results.jsonl"
    assert not results.exists() or not results.read_text()


@pytest.mark.parametrize("returned", [np.zeros((5, 7), int), np.zeros((0, 0), int), np.full((48, 64), 41)])
def test_categories_of_a_wrong_size_or_number_are_named(
    returned: object, house: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(segmentations.Wrong, "returned", returned)
    env = ObjectNavEnv(house=house, sensors=("rgb", "depth"), camera=CameraModel(width_px=64, height_px=48))
    segmenter = find_segmentation("tests.helpers.segmentations:WrongNames", None).make(env, None)
    observation, _ = env.reset(seed=0)
    with pytest.raises(AgentError, match=wording.CATEGORIES_RETURNED_AN_ARRAY_OF):
        segmenter.categories(observation)  # pyright: ignore[reportAttributeAccessIssue]
    env.close()


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("redmet", "Did you mean 'rednet'"),
        ("nowhere_at_all:X", "no module 'nowhere_at_all'"),
        ("tests.helpers.segmentations:ASKED", "SegmentationSpec"),
    ],
)
def test_a_segmentation_that_does_not_exist_is_refused(name: str, message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        find_segmentation(name, None)
    with pytest.raises(ConfigError, match=r"detector\.FIELD=VALUE"):
        find_segmentation(FLAT, Path("weights.pt"))


def test_a_sensor_of_the_segmentation_reaches_the_observation_and_its_truth_is_marked(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    class Bearing(Ahead):
        name, images, reads = "bearing", (), ("pose",)

    for sensor, marked in ((Ahead(), False), (Bearing(), True)):
        spec = SegmenterSpec(sensors=("rgb", sensor), kind="flat")
        monkeypatch.setattr(segmentations.Wrong, "spec", spec, raising=False)
        setup = resolve(RunOptions(semantics="tests.helpers.segmentations:Wrong"))
        assert sensor in setup.sensors
        assert setup.uses_ground_truth is marked


def test_the_segmentation_that_an_agent_brings_is_shown_and_no_other() -> None:
    options = RunOptions(agent="tests.helpers.segmentations:Stating", semantics="gt")
    spec = AgentSpec(make=segmentations.Stating, own_segmentation="my network")
    setup, agent = resolve(options, spec), segmentations.Stating()
    assert not spec.uses_segmentation
    assert setup.segmentation_name == "my network"
    seen = seen_by(setup, agent, None)
    assert isinstance(seen, StatedByAgent)
    agent.reset("sofa", 0)
    assert seen.perceived({}, "sofa") is None
    agent.act({})
    stated = seen.perceived({}, "sofa")
    assert stated is not None
    assert stated.categories is not None
    assert (stated.categories == 3).all()
    agent.seen = Perceived(None, np.full((2, 2), 99, np.uint8))
    with pytest.raises(AgentError, match="mpcat40 ids 0 to 40"):
        seen.perceived({}, "sofa")


class Named:
    """Takes the word of the goal, and sees one object with that name on the left."""

    def __init__(self, returned: object = None) -> None:
        self.returned, self.asked = returned, ("", frozenset[str]())

    def ask(self, word: str, names: frozenset[str]) -> None:
        self.asked = word, names

    def posteriors(self, observation: Observation) -> np.ndarray:
        posteriors = np.zeros((40, 12, 16), np.float32)
        posteriors[MPCAT40_ID["chair"] - 1] = 0.9
        return posteriors

    def objects(self, observation: Observation) -> object:
        if self.returned is not None:
            return self.returned
        return np.where(np.arange(16) < 8, 0, -1)[None].repeat(12, axis=0), [min(self.asked[1], default="chair")]


def own_of(inner: object) -> OwnSegmenter:
    return OwnSegmenter("mine:SEG", inner, SegmenterSpec(), CameraModel(width_px=64, height_px=48))


FRAME = {"rgb": np.zeros((48, 64, 3), np.uint8), "depth": np.ones((48, 64), np.float32)}


def test_the_words_of_the_goal_and_named_objects_pass_a_segmentation_of_ones_own() -> None:
    inner = Named()
    wished = WishedSegmenter(own_of(inner), CameraModel(width_px=64, height_px=48))
    wished.ask("the red rocking chair")
    assert inner.asked == ("rocking chair", frozenset({"rocking chair"}))
    target = wished.scores(FRAME, wished.category).target
    np.testing.assert_allclose(target[:, :8], 0.9)
    assert (target[:, 8:] == 0.0).all()
    wished.ask("chair")
    assert inner.asked == ("", frozenset())
    plain = own_of(segmentations.Flat(segmentations.FlatConfig()))
    assert plain.objects(FRAME) is None


@pytest.mark.parametrize("returned", [(np.zeros((5, 5), int), ["a"]), (np.ones((12, 16), int), ["a"]), (7, 8)])
def test_objects_in_another_form_are_named_with_the_segmentation(returned: object) -> None:
    with pytest.raises(AgentError, match=r"Segmentation 'mine:SEG'.*objects"):
        own_of(Named(returned)).objects(FRAME)


@pytest.mark.parametrize("returned", [(np.zeros((2, 5, 5)), ["a", "b"]), (np.zeros((1, 12, 16)), ["a", "b"]), 7])
def test_guessed_names_in_another_form_are_named_with_the_segmentation(returned: object) -> None:
    class Guesses(Named):
        def named(self, observation: Observation) -> object:
            return self.returned

    with pytest.raises(AgentError, match=r"Segmentation 'mine:SEG'.*named"):
        own_of(Guesses(returned)).named(FRAME)
    guessed = own_of(Guesses((np.full((2, 12, 16), 0.5), ["fridge", "hob"]))).named(FRAME)
    assert guessed is not None
    image, names = guessed
    assert (image.shape, image.dtype, names) == ((2, 12, 16), np.float32, ["fridge", "hob"])
    assert own_of(Guesses(None)).named(FRAME) is None
