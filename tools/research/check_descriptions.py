"""Checks descriptions of objects by code that shares nothing with the code that writes them.

    python -m tools.research.check_descriptions --split val --per-house 180 --workers 2 --out runs/descriptions.json

writes descriptions for the objects of each house (`sim.episodes.descriptions`), reads them with one regular expression
and judges them from the house file alone: names, colours and materials from its XML, rooms, gaps and sizes from
outlines drawn in plan, visibility from pictures of `mujoco.Renderer`.

- ambiguous: another object satisfies every condition, or may do so because the file does not say.
- false: the object itself fails a condition.
- invisible: none of 16 places around shows it with 400 pixels.
- another colour: the pixels that show it have mostly another colour, by hue, saturation and value.

`--pictures FOLDER` writes two pictures of each house, not aimed at the object, for a reader who sees only these and the
texts beside them, and says where (column, row) the described object is. `FOLDER/answers` has the pixels that are right.
"""

from __future__ import annotations

import functools
import json
import re
import sys
import xml.etree.ElementTree as ET
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from sim.app import cli
from sim.app.evaluation.parallel import ordered_map
from sim.core.files import write_atomically
from sim.core.interface import CameraModel
from sim.env.scene import Scene
from sim.episodes.descriptions import Descriptions
from sim.episodes.splits import load_split
from sim.gl import mujoco
from sim.houses.house import House
from sim.robot.config import RobotConfig

_PX_M = 0.02
_EYE_M, _SIDE_PX, _MIN_PIXELS, _ENOUGH_VIEWS = 0.88, 480, 400, 3
_NEXT_TO_M, _ON_M, _OVERHEAD_M, _MIN_SIZE_M = 0.6, 0.08, 1.8, 0.15
_LABEL = re.compile(r"[a-z_]+_\d+")
_STRUCTURES = ("wall", "door", "window")
_COLOURS = ("white", "grey", "black", "beige", "brown", "red", "orange", "yellow", "green", "blue", "purple", "pink")
_ROOMS = {"laundry room": ("laundry",), "hallway": ("hallway", "stair_hall"), "bedroom": ("bedroom", "studio"),
          "living room": ("living_room", "studio")}  # fmt: skip
_GRAMMAR = (
    r"^(?:find |go to |look for )?the (?:(?P<size>largest|biggest|smallest) )?(?:(?P<shape>round) )?"
    r"(?:(?P<colour>{colours}) )?"
    r"(?:(?P<material>wooden|{materials}) )?(?P<name>{names})"
    r"(?: (?P<place>next to|beside|near|on|under) the (?P<other>{names}|window))?(?: in the (?P<room>[a-z ]+))?$"
)
_LOOKS = {
    "white": "neutral orange yellow", "grey": "neutral blue orange green", "black": "neutral blue purple orange red",
    "beige": "neutral orange yellow", "brown": "orange red neutral yellow", "red": "red orange purple",
    "orange": "orange red yellow", "yellow": "yellow orange", "green": "green yellow neutral",
    "blue": "blue neutral green purple", "purple": "purple red blue neutral", "pink": "red purple neutral orange",
}  # fmt: skip
"""For each colour that is said, the rough colours that light and shadow may make of it."""


@dataclass(frozen=True, kw_only=True)
class Args:
    """Write descriptions and check them by other code."""

    split: str = "val"
    """The split whose houses are used."""
    per_house: cli.Count = 180
    """Largest number of descriptions of a house."""
    houses: cli.Count = 1000
    """Largest number of houses."""
    seed: cli.Seed = 0
    """Seed of the choice."""
    workers: cli.Count = 1
    """Number of processes."""
    out: cli.OutFile | None = None
    """A JSON file for all verdicts."""
    pictures: cli.OutFolder | None = None
    """A folder for pictures to be read by somebody."""


@dataclass
class _Seen:
    """What the file says of one object, and where it is."""

    name: str
    colour: str
    material: str
    category: str
    plan: np.ndarray  # (rows, cols) True: pixels of its outline
    z_m: tuple[float, float]
    size_m: float
    room: tuple[str, str]
    floor_z_m: float


def main(args: Args) -> int:
    """Prints the counts; returns 1 if a description is ambiguous, false, invisible or not read."""
    split, counts, verdicts = load_split(args.split), Counter[str](), []
    work = list(enumerate(split.houses))[: args.houses]
    found = ordered_map(functools.partial(_check, args), work, workers=args.workers)
    for (_, house), of_house in zip(work, found, strict=True):
        verdicts += of_house
        counts.update(verdict["verdict"] for verdict in of_house)
        print(f"{house}: {sum(counts.values())} descriptions, {dict(counts)}", flush=True)
    if args.out is not None:
        write_atomically(args.out, json.dumps(verdicts, indent=1) + "\n")
    return int(any(counts[name] for name in ("ambiguous", "false", "invisible", "not read")))


def _check(args: Args, work: tuple[int, str]) -> list[dict[str, str]]:
    """Returns the verdicts on the descriptions of one house."""
    number, house = work
    split, rng = load_split(args.split), np.random.default_rng([args.seed, number])
    written = _written(split.load_house(house), args.per_house, rng)
    judge = _Judge(split.house_paths[house], None if args.pictures is None else rng)
    verdicts = [{"house": house, "text": text, "object": name, "verdict": judge(text, name)} for text, name in written]
    if args.pictures is not None:
        _write_pictures(args.pictures, house, judge, verdicts, rng)
    return verdicts


def _write_pictures(
    folder: Path, house: str, judge: _Judge, verdicts: list[dict[str, str]], rng: np.random.Generator
) -> None:
    """Writes pictures, texts and right pixels of two objects of a house."""
    (folder / "answers").mkdir(parents=True, exist_ok=True)
    good = [verdicts[i] for i in rng.permutation(len(verdicts)) if verdicts[i]["verdict"] == "good"]
    by_object = {verdict["object"]: verdict["text"] for verdict in good if verdict["object"] in judge.pictures}
    texts = {f"{house}_{number}.png": chosen for number, chosen in enumerate(list(by_object.items())[:2])}
    for name, (instance, _) in texts.items():
        rgb, mask = judge.pictures[instance]
        cv2.imwrite(str(folder / name), rgb[..., ::-1])
        cv2.imwrite(str(folder / "answers" / name), mask.astype(np.uint8) * 255)
    spoken = {name: text for name, (_, text) in texts.items()}
    write_atomically(folder / f"{house}.json", json.dumps(spoken, indent=1) + "\n")


def _written(house: House, most: int, rng: np.random.Generator) -> list[tuple[str, str]]:
    """Returns texts and objects of a house: those of some objects, until there are enough."""
    scene = Scene(house, robot=RobotConfig(), camera=CameraModel(), profile="fast")
    scene.world.restore()
    writer, written = Descriptions(scene.task, CameraModel()), list[tuple[str, str]]()
    objects = [item for item in scene.task.truth.meaning.objects if item.is_goal and item.size_m >= _MIN_SIZE_M]
    for number in rng.permutation(len(objects)).tolist():
        if objects[number].facts.name and len(written) < most:
            written += [(described.text, described.instance) for described in writer.of(objects[number], rng)]
    writer.close()
    scene.close()
    return written[:most]


class _Judge:
    """Judges descriptions of the objects of one house file."""

    def __init__(self, path: Path, turns: np.random.Generator | None = None) -> None:
        facts = {
            element.get("name"): dict(part.split(": ") for part in str(element.get("data")).split("; "))
            for element in ET.parse(path).getroot().iter("text")
            if ": " in str(element.get("data"))
        }
        self._model = mujoco.MjModel.from_xml_path(str(path))
        self._data = mujoco.MjData(self._model)
        mujoco.mj_forward(self._model, self._data)
        self._model.vis.global_.fovy = 60.0
        self._renderer = mujoco.Renderer(self._model, _SIDE_PX, _SIDE_PX)
        self._geoms = self._geoms_by_object()
        corners = np.concatenate([self._points(geom) for geoms in self._geoms.values() for geom in geoms])
        self._origin = corners[:, :2].min(axis=0) - 1.0
        self._shape = tuple(np.ceil((corners[:, 1::-1].max(axis=0) - self._origin[::-1] + 1.0) / _PX_M).astype(int))
        self._rooms = self._read_rooms()
        self.objects = {name: self._see(name, facts.get(name, {})) for name in self._geoms}
        names = sorted({seen.name for seen in self.objects.values()}, key=len, reverse=True)
        materials = sorted({seen.material for seen in self.objects.values()} - {""})
        self._grammar = re.compile(
            _GRAMMAR.format(
                colours="|".join(_COLOURS), materials="|".join(materials), names="|".join(map(re.escape, names))
            )
        )
        self._away: dict[str, np.ndarray] = {}
        self._pictured: dict[str, tuple[bool, str]] = {}
        self.turns = turns
        """Draws by how much the camera of a picture for a reader looks past the object; None: no such pictures."""
        self.pictures: dict[str, tuple[np.ndarray, np.ndarray]] = {}

    def __call__(self, text: str, name: str) -> str:
        """Returns the verdict on a text for an object."""
        said = self._grammar.match(text)
        if said is None:
            return "not read"
        fitting = {other: fits for other in self.objects if (fits := self._fits(other, said)) is not False}
        if said["size"] and fitting:
            extreme = min if said["size"] == "smallest" else max
            best = extreme(fitting, key=lambda other: self.objects[other].size_m)
            fitting = {best: fitting[best]}
        if fitting.get(name) is not True:
            return "false"
        if len(fitting) > 1:
            return "ambiguous"
        if name not in self._pictured:
            self._pictured[name] = self._take_pictures(name)
        shown, colour = self._pictured[name]
        if not shown:
            return "invisible"
        return "another colour" if said["colour"] and colour not in _LOOKS[said["colour"]].split() else "good"

    def _fits(self, name: str, said: re.Match[str]) -> bool | None:
        """Returns whether an object satisfies a text but for its size; None: the file does not say."""
        seen, results = self.objects[name], list[bool | None]()
        if seen.name != said["name"] or seen.z_m[0] - seen.floor_z_m > _OVERHEAD_M:
            return False
        if said["colour"]:
            results.append(seen.colour == said["colour"] if seen.colour else None)
        if said["material"]:
            material = "wood" if said["material"] == "wooden" else said["material"]
            results.append(seen.material == material if seen.material else None)
        if said["shape"]:
            results.append(_is_round(seen.plan))
        if said["room"]:
            results.append(seen.room[1] in _ROOMS.get(said["room"], (said["room"].replace(" ", "_"),)))
        if said["place"]:
            landmarks = self._landmarks(name, said["other"])
            results.append(any(self._is_at(name, other, said["place"]) for other in landmarks))
        return False if False in results else None if None in results else True

    def _landmarks(self, name: str, wanted: str) -> Iterator[str]:
        seen = self.objects[name]
        for other, landmark in self.objects.items():
            if other == name or wanted not in (landmark.name, landmark.category):
                continue
            belongs = landmark.category in _STRUCTURES or landmark.room == seen.room
            if belongs and abs(landmark.floor_z_m - seen.floor_z_m) <= 1.0:
                yield other

    def _is_at(self, name: str, other: str, place: str) -> bool:
        a, b = self.objects[name], self.objects[other]
        if place in ("next to", "beside", "near"):
            return self._gap_m(name, other) <= _NEXT_TO_M
        if not (a.plan & b.plan).any():
            return False
        raised = b.z_m[0] < a.z_m[0] < b.z_m[1] and a.z_m[0] > a.floor_z_m + _ON_M
        lies_on = raised or abs(a.z_m[0] - b.z_m[1]) <= _ON_M
        return lies_on if place == "on" else a.z_m[1] < b.z_m[1] and not lies_on

    def _gap_m(self, name: str, other: str) -> float:
        if name not in self._away:
            free = 1 - self.objects[name].plan.astype(np.uint8)
            self._away[name] = cv2.distanceTransform(free, cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
        return float(self._away[name][self.objects[other].plan].min(initial=np.inf)) * _PX_M

    def _geoms_by_object(self) -> dict[str, list[int]]:
        """Returns the rendered geoms of each object: the first label among the names of geom, body and ancestors."""
        model, result = self._model, dict[str, list[int]]()
        for geom in range(model.ngeom):
            if model.geom_group[geom] > 2 or model.geom_rgba[geom, 3] == 0.0:
                continue
            name, body = model.geom(geom).name, int(model.geom_bodyid[geom])
            while not _LABEL.fullmatch(name) and body:
                name, body = model.body(body).name, int(model.body_parentid[body])
            if _LABEL.fullmatch(name):
                result.setdefault(name, []).append(geom)
        return result

    def _points(self, geom: int) -> np.ndarray:
        """Returns points (n, 3) in the world whose hull is about that of a geom."""
        model, size, kind = self._model, self._model.geom_size[geom], self._model.geom_type[geom]
        turn, rise = np.meshgrid(np.linspace(0.0, 2.0 * np.pi, 24), np.linspace(-0.5, 0.5, 9) * np.pi)
        ball = np.stack([np.cos(turn) * np.cos(rise), np.sin(turn) * np.cos(rise), np.sin(rise)], -1).reshape(-1, 3)
        ends = np.sign(ball) * (0.0, 0.0, 1.0)
        if kind == mujoco.mjtGeom.mjGEOM_MESH:
            mesh = int(model.geom_dataid[geom])
            first = int(model.mesh_vertadr[mesh])
            points = model.mesh_vert[first : first + int(model.mesh_vertnum[mesh])]
        elif kind == mujoco.mjtGeom.mjGEOM_CYLINDER:
            ring = np.stack([np.cos(turn), np.sin(turn), 0.0 * turn], -1).reshape(-1, 3)
            points = ring * size[0] + ends * size[1]
        elif kind == mujoco.mjtGeom.mjGEOM_CAPSULE:
            points = ball * size[0] + ends * size[1]
        elif kind in (mujoco.mjtGeom.mjGEOM_SPHERE, mujoco.mjtGeom.mjGEOM_ELLIPSOID):
            points = ball * (size[0] if kind == mujoco.mjtGeom.mjGEOM_SPHERE else size)
        else:
            flat = kind == mujoco.mjtGeom.mjGEOM_PLANE
            points = np.array(np.meshgrid(*[(-s, s) for s in (*size[:2], 0.0 if flat else size[2])])).reshape(3, -1).T
        return points @ self._data.geom_xmat[geom].reshape(3, 3).T + self._data.geom_xpos[geom]

    def _read_rooms(self) -> list[tuple[str, str, np.ndarray, float]]:
        """Returns name, kind, box in plan (x0, y0, x1, y1) and height of the floor of the boxes of all rooms."""
        rooms = []
        for site in range(self._model.nsite):
            if found := re.match(r"room_(?P<kind>[a-z_]+)_\d+", self._model.site(site).name):
                middle, half = self._data.site_xpos[site], self._model.site_size[site]
                box = np.concatenate([middle[:2] - half[:2], middle[:2] + half[:2]])
                rooms.append((found[0], found["kind"], box, float(middle[2] - half[2])))
        return rooms

    def _see(self, name: str, facts: dict[str, str]) -> _Seen:
        plan, every = np.zeros(self._shape, np.uint8), [self._points(geom) for geom in self._geoms[name]]
        for points in every:
            pixels = np.round((points[:, :2] - self._origin) / _PX_M).astype(np.int32)
            cv2.fillConvexPoly(plan, cv2.convexHull(pixels), 1)
        low, high = np.concatenate(every).min(axis=0), np.concatenate(every).max(axis=0)
        floors = [floor for _, _, _, floor in self._rooms]
        floor = max((floor for floor in floors if floor <= low[2] + 0.15), default=min(floors, default=0.0))
        middle = 0.5 * (low[:2] + high[:2])
        inside = (
            (room, kind) for room, kind, box, base in self._rooms if abs(base - floor) < 1.0 and _holds(box, middle)
        )
        category = name.rsplit("_", 1)[0]
        size_m = float(np.cbrt(np.prod(np.maximum(high - low, 0.05))))
        said = facts.get("name", category.replace("_", " ")), facts.get("colour", ""), facts.get("material", "")
        z_m = float(low[2]), float(high[2])
        return _Seen(*said, category, plan.astype(np.bool_), z_m, size_m, next(inside, ("", "")), floor)

    def _take_pictures(self, name: str) -> tuple[bool, str]:
        """Returns whether a picture shows an object, and the rough colour of most of its pixels."""
        seen, colours, shown = self.objects[name], Counter[str](), 0
        rows, cols = np.nonzero(seen.plan)
        middle = self._origin + _PX_M * np.array([cols.mean(), rows.mean()])
        reach = 0.5 * _PX_M * max(np.ptp(rows), np.ptp(cols))
        camera = mujoco.MjvCamera()
        for number in range(16):
            angle, away = np.pi * number / 4.0, reach + (0.8 if number < 8 else 1.8)
            xy = middle + away * np.array([np.cos(angle), np.sin(angle)])
            if not any(
                (not seen.room[0] or room == seen.room[0]) and _holds(box, xy) for room, _, box, _ in self._rooms
            ):
                continue
            eye = np.array([*xy, seen.floor_z_m + _EYE_M])
            target = np.array([*middle, np.clip(0.5 * sum(seen.z_m), eye[2] - 0.7, eye[2] + 0.7)])
            ahead, camera.lookat[:] = target - eye, target
            camera.distance = float(np.linalg.norm(ahead))
            camera.azimuth = float(np.degrees(np.arctan2(ahead[1], ahead[0])))
            camera.elevation = float(np.degrees(np.arcsin(ahead[2] / camera.distance)))
            mask = self._mask(camera, name)
            if np.count_nonzero(mask) < _MIN_PIXELS:
                continue
            shown += 1
            colours.update(_rough_colours(self._render(camera)[mask]))
            if self.turns is None and shown == _ENOUGH_VIEWS:
                break
            # More is seen from farther away.
            if self.turns is not None and (number >= 8 or name not in self.pictures):
                camera.azimuth += self.turns.uniform(-18.0, 18.0)
                camera.elevation += self.turns.uniform(-12.0, 12.0)
                yaw, rise = np.radians((camera.azimuth, camera.elevation))
                gaze = np.array([np.cos(rise) * np.cos(yaw), np.cos(rise) * np.sin(yaw), np.sin(rise)])
                camera.lookat[:] = eye + camera.distance * gaze
                mask = self._mask(camera, name)
                if np.count_nonzero(mask) >= _MIN_PIXELS:
                    self.pictures[name] = self._render(camera), mask
        return shown > 0, colours.most_common(1)[0][0] if colours else ""

    def _render(self, camera: mujoco.MjvCamera) -> np.ndarray:
        """Returns a picture (rows, cols, 3); only those for a reader have shadows and reflections, which take time."""
        self._renderer.update_scene(self._data, camera)
        for effect in (mujoco.mjtRndFlag.mjRND_SHADOW, mujoco.mjtRndFlag.mjRND_REFLECTION):
            self._renderer.scene.flags[effect] = self.turns is not None
        return self._renderer.render()

    def _mask(self, camera: mujoco.MjvCamera, name: str) -> np.ndarray:
        """Returns the pixels (rows, cols) of an object."""
        self._renderer.enable_segmentation_rendering()
        ids = self._render(camera)
        self._renderer.disable_segmentation_rendering()
        return np.isin(ids[..., 0], self._geoms[name]) & (ids[..., 1] == mujoco.mjtObj.mjOBJ_GEOM)


def _is_round(plan: np.ndarray) -> bool:
    """Returns whether an outline fills the disc around its middle that holds the middles of its pixels."""
    rows, cols = np.nonzero(plan)
    radius = np.hypot(rows - rows.mean(), cols - cols.mean()).max()
    return len(rows) >= 0.88 * np.pi * radius**2


def _holds(box: np.ndarray, xy: np.ndarray) -> bool:
    """Returns whether a box (x0, y0, x1, y1) holds a place."""
    return bool((xy >= box[:2]).all() and (xy <= box[2:]).all())


def _rough_colours(rgb: np.ndarray) -> Counter[str]:
    """Returns how many pixels (n, 3) have each rough colour, by hue, saturation and value."""
    hsv = cv2.cvtColor(rgb.reshape(-1, 1, 3), cv2.COLOR_RGB2HSV).reshape(-1, 3).astype(int)
    limits = ((20, "red"), (45, "orange"), (70, "yellow"), (165, "green"), (260, "blue"), (330, "purple"), (361, "red"))
    names = np.array([name for _, name in limits])
    names = names[np.searchsorted([limit for limit, _ in limits], 2 * hsv[:, 0], side="right")]
    return Counter(np.where((hsv[:, 1] < 40) | (hsv[:, 2] < 45), "neutral", names).tolist())


if __name__ == "__main__":
    sys.exit(cli.run(Args, main))
