"""Submissions that are damaged, or contradict themselves or their split, are refused by one sentence."""

from __future__ import annotations

import copy
import gzip
import os
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from sim.app.submissions.contents import MAX_FILE_BYTES, read_submission
from sim.core.configuration import as_json
from sim.core.errors import ConfigError
from sim.sensors.noise import NOISE_PRESETS
from tests.helpers import wording
from tests.helpers.submissions import (
    Edit,
    checked,
    content_of,
    in_actions,
    in_all_results,
    in_config,
    in_first_result,
    in_inputs,
    in_manifest,
    in_split,
    in_tree,
    together,
    written,
)

REFUSED: dict[str, tuple[Edit, str]] = {
    "other format": (lambda c: c.update(format="stubborn-submission-9"), "field 'format'"),
    "unknown field": (in_manifest(rank=1), "unknown field 'rank'|unknown field rank"),
    "no episodes": (lambda c: c.update(episodes=[]), "field 'episodes'"),
    "an episode twice": (lambda c: c["episodes"].append(copy.deepcopy(c["episodes"][0])), "2 times; each counts once"),
    "an episode of no split": (in_first_result(episode_id="tiny_9999"), "the split 'tiny' has no such episode"),
    "another goal": (in_first_result(goal="bed"), "its result has goal 'bed', the split has 'sofa'"),
    "another house": (in_first_result(house="palace"), "its result has house 'palace'"),
    "another split": (in_split(sha256="0" * 64), "was made on the split 'tiny' 1 with sha256 000000000000"),
    "another version of the split": (in_split(version="2"), "was made on the split 'tiny' 2 with sha256"),
    "a version of the split that is markup": (in_split(version="=1**\n\n<img src=//evil>"), "version"),
    "a split without a hash": (in_split(sha256="x"), "sha256"),
    "a cause of failure with control characters": (in_first_result(success=0.0, failure="a\x1b[2J"), "failure"),
    "a part of a noise": (
        together(in_inputs(noise="harsh"), in_tree("", noise={"depth": as_json(NOISE_PRESETS["harsh"])["depth"]})),
        "declares noise 'harsh', and its configuration has 'own'",
    ),
    "an action that does not exist": (in_actions(lambda a: "7" + a[1:]), "actions'"),
    "actions after STOP": (in_actions(lambda a: a + "11", counted=True), "has actions after STOP"),
    "too many actions": (in_actions(lambda a: "1" * 26, counted=True), "has 26 actions; the task allows 25"),
    "fewer actions than counted": (in_actions(lambda a: a[1:]), "actions, and its result counts"),
    "a success without STOP": (in_first_result(success=1.0, spl=1.0, failure=None, end_reason="max_steps"), "STOP"),
    "another end": (in_first_result(end_reason="max_steps"), "ended with 'max_steps', and its last action is STOP"),
    "no STOP": (in_actions(lambda a: a[:-1], counted=True), "ended with 'stop', and its last action is not STOP"),
    "a success that failed": (in_first_result(failure="trapped"), "has success 1 and the cause of failure 'trapped'"),
    "a higher SPL": (in_first_result(spl=0.999), r"has spl 0\.999; its success, shortest_path and path_length give 0"),
    "another version of the physics": (in_manifest(physics=0), "physics of version 0, this is version"),
    "no version of the physics": (lambda c: c["manifest"].pop("physics"), "missing required field physics"),
    "a script as link": (in_manifest(links=["javascript:alert(1)"]), "links"),
    "a link that ends a Markdown link": (in_manifest(links=["https://x.org/a)<b>"]), "links"),
    "a name with control characters": (in_manifest(name="a\x1b[2J"), "name"),
    "a name that is a formula": (in_manifest(name="=1+1"), "name"),
    "an agent that is a formula": (
        together(in_inputs(agent="=1+1"), in_all_results(agent="=1+1"), in_config(agent="=1+1")),
        "agent",
    ),
    "a long description": (in_manifest(description="a" * 3000), "description"),
    "truth in the lines only": (in_inputs(uses_ground_truth=False), "uses_ground_truth True, the manifest has False"),
    "an agent that knows the truth": (
        together(
            in_inputs(uses_ground_truth=False, semantics="rednet"),
            in_all_results(uses_ground_truth=False, semantics="rednet"),
            in_config(semantics="rednet"),
        ),
        "declares no ground truth, and its agent 'oracle' uses it",
    ),
    "a true image among the sensors": (
        together(
            in_inputs(uses_ground_truth=False, semantics="rednet", agent="mine:NAME", sensors=["semantic"]),
            in_all_results(uses_ground_truth=False, semantics="rednet", agent="mine:NAME"),
            in_config(semantics="rednet", agent="mine:NAME"),
            in_tree("", sensors=["semantic"]),
        ),
        "declares no ground truth, and its configuration gives the agent 'semantic'",
    ),
    "a true segmentation": (
        together(
            in_inputs(uses_ground_truth=False, semantics="mine:NAME", agent="mine:NAME"),
            in_all_results(uses_ground_truth=False, semantics="mine:NAME", agent="mine:NAME"),
            in_config(semantics="mine:NAME", agent="mine:NAME", segmentation={"name": "mine", "truth": ["semantic"]}),
        ),
        "gives the agent 'semantic'",
    ),
    "another segmentation": (
        in_inputs(semantics="rednet"),
        "declares semantics 'rednet', and its configuration has 'gt'",
    ),
    "other sensors": (in_inputs(sensors=["rgb"]), r"declares sensors \('rgb',\)"),
    "noise that was not there": (in_inputs(noise="harsh"), "declares noise 'harsh', and its configuration has 'none'"),
    "a process that was not there": (in_inputs(isolated=True), "declares isolated True for the agent 'oracle'"),
    "another seed": (together(in_manifest(seed=5), in_all_results(seed=5)), "the seed is 5, in its configuration 0"),
    "a robot of a file": (in_tree("robot", file={"path": "/etc/passwd"}), "the robot is that of a file"),
    "a robot with an unknown field": (in_tree("robot.drive", turbo=True), "There is no field"),
    "a robot that cannot be": (in_tree("robot.body", radius_m=-1.0), "radius_m"),
    "a time step for days": (in_tree("robot.physics", timestep_s=1e-5), "timestep_s is below"),
    "no task": (lambda c: c["config"]["config"].pop("task"), "has no field 'config.task'"),
    "no configuration": (lambda c: c["config"].pop("config"), "has no field 'config'"),
    "a configuration that is a list": (lambda c: c.update(config=[1]), "field 'config',"),
    "a configuration that is too large": (in_config(extra="x" * (2 << 20)), "at most 1048576"),
    "an infinite number": (in_first_result(path_length=float("inf")), "not JSON"),
    "a success of 2": (in_first_result(success=2.0), "success"),
    "a success without SPL": (in_first_result(spl=0.0), "has spl 0; its success"),
    "sensors that are a number": (in_tree("", sensors=5), "sensors"),
    "a segmentation that is a text": (in_config(segmentation="a"), "segmentation"),
    "true images in a list of lists": (in_config(segmentation={"name": "mine", "truth": [[1]]}), "truth"),
    "an error with actions": (
        in_first_result(end_reason="error", success=0.0, spl=0.0, soft_spl=0.0),
        "it cannot have actions",
    ),
    "an error that succeeds": (in_first_result(end_reason="error"), "ended with an error and cannot be a success"),
    "too few places": (lambda c: c["episodes"][0].update(places_m=[]), "has 0 positions; "),
    "too many places": (lambda c: c["episodes"][0]["places_m"].append([0.0, 0.0]), " positions; "),
    "a segmentation whose sensors were not there": (
        in_config(segmentation={"name": "mine", "sensors": ["rgb"]}),
        "its segmentation reads 'rgb', which is not among the sensors",
    ),
    "a name that is written backwards": (in_manifest(name="our \u202e agent"), "has an invisible character"),
    "a name with a space of no width": (in_manifest(name="stub\u200bborn"), "has an invisible character"),
    "an author with a Cyrillic letter": (in_manifest(authors=["\u0410nn Smith"]), "letters of Cyrillic and Latin"),
    "a name in letters of formulas": (in_manifest(name="\U0001d42c\U0001d42d"), "variants of characters; write 'st'"),
    "a place on the moon": (lambda c: c["episodes"][0].update(places_m=[[4e8, 0.0]]), "places_m"),
}


@pytest.mark.parametrize("forgery", REFUSED)
def test_a_contradiction_is_refused_by_one_sentence(folder: Path, tmp_path: Path, forgery: str) -> None:
    edit, sentence = REFUSED[forgery]
    content = content_of(folder / "oracle.json.gz")
    edit(content)
    with pytest.raises(ConfigError, match=sentence) as refused:
        checked(folder, written(tmp_path / "forged.json.gz", content))
    assert "\n" not in str(refused.value)


def _bomb(good: bytes) -> bytes:
    return gzip.compress(b" " * (65 << 20), 1)


def _deep(good: bytes) -> bytes:
    nested = b'"config":{"deep":' + b"[" * 5000 + b"]" * 5000 + b","
    return gzip.compress(gzip.decompress(good).replace(b'"config":{', nested, 1))


def _deep_robot(good: bytes) -> bytes:
    """Nested less than msgspec refuses, and more than functions can call themselves."""
    nested = b'"robot":{"deep":' + b'{"a":' * 980 + b"1" + b"}" * 980 + b","
    changed = gzip.decompress(good).replace(b'"robot": {', nested, 1)
    assert nested in changed
    return gzip.compress(changed)


DAMAGED: dict[str, tuple[Callable[[bytes], bytes], str]] = {
    "truncated": (lambda good: good[: len(good) // 2], "cannot be read"),
    "empty": (lambda good: b"", "cannot be read|is empty"),
    "not gzip": (lambda good: b"PK\x03\x04" + good, "cannot be read"),
    "a changed byte": (lambda good: good[:-6] + bytes([good[-6] ^ 1]) + good[-5:], "cannot be read"),
    "no JSON": (lambda good: gzip.compress(b"{'a': 1}"), "is not JSON"),
    "a deep configuration": (_deep, "is nested too deeply"),
    "a deep robot": (_deep_robot, "is nested too deeply"),
    "a bomb": (_bomb, "expands to more than 64 MB"),
    "too large": (lambda good: bytes(MAX_FILE_BYTES + 1), "is too large"),
    "a list": (lambda good: gzip.compress(b"[]"), "expected object"),
}


@pytest.mark.parametrize("damage", DAMAGED)
def test_a_damaged_file_is_refused_by_one_sentence(
    folder: Path, tmp_path: Path, damage: str, capsys: pytest.CaptureFixture[str]
) -> None:
    change, sentence = DAMAGED[damage]
    file = tmp_path / "damaged.json.gz"
    file.write_bytes(change((folder / "oracle.json.gz").read_bytes()))
    with pytest.raises(ConfigError, match=sentence):
        checked(folder, file)


def test_a_pipe_and_a_folder_are_refused_without_waiting(folder: Path, tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.json.gz")
    for name in ("pipe.json.gz", "."):
        with pytest.raises(ConfigError, match=wording.CANNOT_BE_READ):
            checked(folder, tmp_path / name)


def test_bytes_changed_at_random_give_an_error_of_ours_or_a_submission(folder: Path, tmp_path: Path) -> None:
    good = gzip.decompress((folder / "random.json.gz").read_bytes())
    rng = np.random.default_rng(0)
    for _ in range(150):
        changed = bytearray(good)
        for place in rng.integers(len(good), size=int(rng.integers(1, 5))).tolist():
            changed[place] = int(rng.integers(256))
        file = tmp_path / "changed.json.gz"
        file.write_bytes(gzip.compress(bytes(changed), 1))
        try:
            submission = read_submission(file)
            submission.config_tree(where="x")
        except ConfigError:
            continue


def test_a_split_that_does_not_ship_is_never_a_path_of_the_file(folder: Path, tmp_path: Path) -> None:
    content = content_of(folder / "oracle.json.gz")
    for name in ("tiny", str(folder / "tiny"), "../../etc"):
        in_split(name=name)(content)
        with pytest.raises(ConfigError, match="--split"):
            checked(folder, written(tmp_path / "forged.json.gz", content), split=None)


def test_another_robot_or_camera_is_refused_unless_asked_for(folder: Path) -> None:
    with pytest.raises(ConfigError, match=r"camera.width_px.*96.*640"):
        checked(folder, folder / "oracle.json.gz", nonstandard=False)
