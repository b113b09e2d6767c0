"""For any content, the reader of a file gives a result or a message that names the file, never a traceback."""

from __future__ import annotations

import contextlib
import gzip
import io
import json
import struct
import tarfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from sim.app.evaluation.results import read_record, read_results
from sim.core.configuration import read_settings
from sim.core.errors import ConfigError, ObjectNavError
from sim.core.geometry.grid import GridFrame
from sim.core.geometry.pose import Pose
from sim.core.interface import GOAL_CATEGORIES
from sim.episodes import habitat
from sim.episodes.house_list import read_house_list, write_house_list
from sim.episodes.splits import read_unreachable
from sim.homes.housegen.imported.library import Model, read_index, read_shape
from sim.homes.housegen.splits.recipes import train_recipe
from sim.homes.plans.plan import Plan, read_plan, write_plan
from sim.houses.load import load_house, read_rules
from sim.houses.sidecar import Sidecar, read_sidecar, write_sidecar
from sim.robot.foreign import _read_sidecar
from sim.task.trajectory import read_trajectory, write_trajectory
from sim.training.cloned.demonstrations import Demonstration, read_demonstration, write_demonstration
from sim.training.poni.potential_files import SampleSet, write_samples
from sim.training.poni.potentials import Potentials, Sample, SampleConfig
from sim.training.segmentation.dataset import read_shard, stored_block_px
from sim.training.views.shards import ShardNote, read_note
from stubborn.detection.verification import FOLDER, FittedVerifier
from stubborn.exploration.patches import MapPatch
from stubborn.network_files import read_checkpoint
from stubborn.segmentation.checkpoints import load_network, save_network
from stubborn.segmentation.rednet import RedNet, RedNetConfig
from tests.helpers import wording
from tests.helpers.results import ENTRIES
from tests.helpers.worlds import room
from tests.sim.task.test_trajectory import walked

LISTED = [(train_recipe(1), "0" * 64)]
SIDECAR = Sidecar(start=Pose(0.0, 0.0, 0.0), goal="bed")
EPISODE = {
    "episode_id": "e1", "scene_id": "mjcf_houses/val/h.xml", "start_position": [0.0, 0.0, 1.0],
    "start_rotation": [0.0, 0.5, 0.0, 0.5], "object_category": "bed", "info": {"geodesic_distance": 3.0},
}  # fmt: skip
MODEL = Model(
    key="i01234567", ident="a", name="a", category="chair", uses=(), mount="floor", elevation_m=0.0,
    size_m=(1.0, 1.0, 1.0), author="", licence="", origin="", sha256="", split="train", triangles=1,
)  # fmt: skip
CELLS = np.zeros((2, 3))
PLAN = Plan(
    name="h", frame=GridFrame(origin_xy_m=(0.0, 0.0), shape=(2, 3), cell_m=0.05), floor_z_m=0.0, ceiling_m=2.5,
    radius_m=0.18, slack_m=CELLS.astype(np.float32), floor=CELLS.astype(np.bool_), room=CELLS.astype(np.int16),
    rooms=("room_bedroom_00",), succeeds=CELLS.astype(np.uint32), span_start=np.arange(7, dtype=np.int32),
    span_low_m=np.zeros(6, np.float32), span_high_m=np.ones(6, np.float32), span_instance=np.zeros(6, np.uint16),
    instances=("wall_00",), categories=np.ones(1, np.uint8),
)  # fmt: skip
SHOWN = Demonstration(
    depth_mm=np.zeros((2, 3, 4), np.uint16), semantic=np.zeros((2, 3, 4), np.uint8), poses=np.zeros((2, 3), np.float32),
    actions=np.zeros(2, np.uint8), goal="bed", house="h", success=True,
)  # fmt: skip
SAMPLES = SampleConfig(cells=4, map_cells=40)
SAMPLE = Sample(
    MapPatch(
        frame=GridFrame.around_start(4, 0.25), obstacle=np.zeros((4, 4), np.bool_), seen=np.zeros((4, 4), np.bool_),
        trail=np.zeros((4, 4), np.bool_), goals=np.eye(4, dtype=np.uint32), robot=(2, 2),
    ),
    seen_goals=1,
    potentials=Potentials(
        rows=np.arange(2), cols=np.arange(2), area=np.ones(2, np.float32), part=np.arange(2),
        objects=np.ones((2, len(GOAL_CATEGORIES)), np.float32), path_m=np.ones(2, np.float32),
    ),
)  # fmt: skip
SHAPE = {
    "rgba": np.ones((1, 4)), "v0": np.ones((3, 3)), "f0": np.ones((1, 3)), "boxes": np.ones((1, 6)), "top": np.ones(0),
}  # fmt: skip
TINY = RedNetConfig(width=4, encoder_blocks=(1, 1, 1, 1), bottleneck=False, decoder_blocks=(1, 1, 1, 1), final_blocks=1)


def zipped(content: Any) -> bytes:
    return gzip.compress(json.dumps(content).encode())


def written(write: Callable[[Path], Any], name: str = "file") -> Callable[[Path], bytes]:
    def make(folder: Path) -> bytes:
        write(folder / name)
        return (folder / name).read_bytes()

    return make


def shard(folder: Path) -> bytes:
    stream = io.BytesIO()
    with tarfile.open(fileobj=stream, mode="w") as archive:
        for suffix in ("rgb.png", "depth.png", "semantic.png", "json"):
            archive.addfile(entry := tarfile.TarInfo(f"v.{suffix}"))
            entry.size = 0
    return stream.getvalue()


@dataclass(frozen=True)
class Reader:
    """A kind of file: its name, valid content, and its reader."""

    name: str
    valid: Callable[[Path], bytes]
    read: Callable[[Path], Any]


READERS = (
    Reader(
        "results.jsonl",
        lambda _: "".join(json.dumps(ENTRIES | {"episode_id": i}) + "\n" for i in "ab").encode(),
        read_results,
    ),
    Reader(
        "config.json", lambda _: json.dumps({"seed": 0, "versions": {"code": "a"}, "config": {}}).encode(), read_record
    ),
    Reader("h.json.gz", lambda _: zipped({"episodes": [EPISODE]}), habitat.read_episodes),
    Reader("val.json.gz", lambda _: zipped({"version": "1", "order": ["e1"]}), habitat.read_index),
    Reader(
        "h.json",
        written(lambda f: write_sidecar(f.with_suffix(".xml"), SIDECAR), "h.json"),
        lambda file: read_sidecar(file.with_suffix(".xml")),
    ),
    Reader("rules.json", lambda _: b'{"^sofa": "sofa", "wand": "wall"}', read_rules),
    Reader(
        "robot.json", lambda _: b'{"wheel_joints": ["l", "r"], "wheel_radius_m": 0.1, "casters": ["c"]}', _read_sidecar
    ),
    Reader("verifier.json", lambda _: (FOLDER / "noisy.json").read_bytes(), FittedVerifier.read),
    Reader(
        "houses.json",
        written(lambda f: write_house_list(f.parent, LISTED, version="1"), "houses.json"),
        lambda file: read_house_list(file.parent),
    ),
    Reader("unreachable.json", lambda _: b'{"h": ["bed_00"]}', lambda file: read_unreachable(file.parent)),
    Reader(
        "views-0.json",
        lambda _: json.dumps(ShardNote("views-0", "h", 1, "a", 1, {}, {}).__dict__).encode(),
        lambda file: (read_note(file.parent, "views-0", verify=False), stored_block_px([file.with_suffix(".tar")])),
    ),
    Reader(
        "models.json",
        lambda _: json.dumps({"version": 1, "models": [MODEL.__dict__]}).encode(),
        lambda file: read_index(file.parent),
    ),
    Reader(
        "meshes/i01234567.npz",
        written(lambda f: np.savez(f, **SHAPE), "a.npz"),
        lambda file: read_shape(file.parent.parent, MODEL),
    ),
    Reader("e.npz", written(lambda f: write_trajectory(f, walked(3), None), "b.npz"), read_trajectory),
    Reader("a.toml", lambda _: b'[agent.planning]\ndilation_m = 0.1\nnames = ["a"]\n', read_settings),
    Reader("a.json", lambda _: b'{"agent": {"planning": {"dilation_m": 0.1}}}', read_settings),
    Reader(
        "a.safetensors",
        written(lambda f: save_network(f, RedNet(TINY), {"block_px": 2}), "b.safetensors"),
        load_network,
    ),
    Reader("a.pth", written(lambda f: torch.save({"model_state": {"a": torch.zeros(3)}}, f), "b.pth"), read_checkpoint),
    Reader("a.tar", shard, lambda file: list(read_shard(file))),
    Reader("plan.npz", written(lambda f: write_plan(f, PLAN), "p.npz"), read_plan),
    Reader("shown.npz", written(lambda f: write_demonstration(f, SHOWN), "s.npz"), read_demonstration),
    Reader(
        "samples.npz",
        written(lambda f: write_samples(f, [SAMPLE, SAMPLE], SAMPLES, {}), "t.npz"),
        lambda file: SampleSet.read([file]).batch([0]),
    ),
    Reader("a.xml", lambda _: room(3, 3).spec.to_xml().encode(), load_house),
)
JUNK: tuple[Any, ...] = (
    None, True, -1, 7, 10**30, 1e308, "", "nan", "../../x", "\x1b[31m", "a" * 5000, [], {}, [[]], {"a": {"a": 1}},
)  # fmt: skip


def with_junk(content: bytes, path: int, junk: Any) -> bytes:
    """Returns JSON, zipped or not, in which one value is replaced; the content itself if it is not JSON."""
    packed = content[:2] == b"\x1f\x8b"
    try:
        tree = json.loads(gzip.decompress(content) if packed else content.splitlines()[0])
    except ValueError:
        return content
    node, keys = tree, list(tree)
    while keys:
        path, choice = divmod(path, len(keys))
        key = keys[choice] if isinstance(node, dict) else choice
        inner = node[key]
        if not inner or not isinstance(inner, dict | list) or path % 3 == 0:
            node[key] = junk
            break
        node, keys = inner, list(inner)
    text = json.dumps(tree).encode()
    return gzip.compress(text) if packed else text + b"\n"


def flipped(content: bytes, place: int, value: int) -> bytes:
    place %= max(1, len(content))
    return content[:place] + bytes([value]) + content[place + 1 :]


BROKEN = st.one_of(
    st.binary(max_size=64).map(lambda new: lambda _: new),
    st.integers(0, 10**6).map(lambda end: lambda content: content[: end % (len(content) + 1)]),
    st.tuples(st.integers(0, 10**6), st.integers(0, 255)).map(lambda at: lambda content: flipped(content, *at)),
    st.tuples(st.integers(0, 10**6), st.sampled_from(JUNK)).map(lambda at: lambda content: with_junk(content, *at)),
    st.sampled_from((b"[" * 5000, b'{"a":' * 5000, b"\0" * 100, "\ufeff{}".encode(), "{}".encode("utf-16"))).map(
        lambda new: lambda _: new
    ),
)


@pytest.mark.parametrize("reader", READERS, ids=lambda reader: reader.name)
def test_any_content_gives_a_result_or_a_message(reader: Reader, tmp_path: Path) -> None:
    content, file = reader.valid(tmp_path), tmp_path / "in" / reader.name
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_bytes(content)
    if reader.name != "a.tar":  # whose images are empty
        reader.read(file)

    examples = 4 if reader.name == "a.safetensors" else 30  # it builds networks

    @settings(
        max_examples=examples,
        database=None,
        suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large, HealthCheck.filter_too_much],
    )
    @given(broken=BROKEN)
    def check(broken: Callable[[bytes], bytes]) -> None:
        file.write_bytes(broken(content))
        with contextlib.suppress(ObjectNavError):
            reader.read(file)

    check()


BAD_ARRAYS = (
    np.array(7), np.array("a"), np.full((2, 2), "a"), np.zeros(0), np.full((3, 4, 4), -1), np.full(3, np.nan),
    np.full((2, 5), 1 << 60), np.array(["2020-01-01"], "datetime64[D]"), np.zeros(2, [("a", "u1")]),
    np.ones(2, np.complex64),
)  # fmt: skip


@pytest.mark.costly
@pytest.mark.parametrize(
    "reader", [reader for reader in READERS if reader.name.endswith(".npz")], ids=lambda reader: reader.name
)
def test_an_array_of_another_type_or_shape_gives_a_result_or_a_message(reader: Reader, tmp_path: Path) -> None:
    content, file = reader.valid(tmp_path), tmp_path / "in" / reader.name
    file.parent.mkdir(parents=True)
    with np.load(io.BytesIO(content)) as loaded:
        arrays = dict(loaded)
    messages = []
    for name in arrays:
        without = {key: value for key, value in arrays.items() if key != name}
        for changed in (without, *({**arrays, name: bad} for bad in BAD_ARRAYS)):
            np.savez(file, **changed)
            try:
                reader.read(file)
            except ObjectNavError as error:
                messages.append(str(error))
    assert len(messages) > len(arrays) * len(BAD_ARRAYS) // 2
    assert all(str(file) in message for message in messages)


def test_weights_in_a_zip_of_several_parts_are_refused(tmp_path: Path) -> None:
    file = tmp_path / "a.pth"
    file.write_bytes(struct.pack("<4sLQL", b"PK\x06\x07", 1, 0, 2) + struct.pack("<4s4H2LH", b"PK\x05\x06", *7 * [0]))
    with pytest.raises(ConfigError, match=wording.SPAN_MULTIPLE_DISKS):
        read_checkpoint(file)
