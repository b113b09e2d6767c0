"""Fits how objects of each colour look and how pictures resemble views, and counts what rooms of each kind hold.

    python -m tools.training.fit_attributes --houses 100 --views 20

writes `stubborn/detection/attributes.json`, for goals in words and pictures, from houses of `train` in the profile
`fast`, which agents see.
"""

from __future__ import annotations

import json
import sys
from collections import Counter, defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sim.app import cli
from sim.core.colours import COLOUR_NAMES, colour_numbers
from sim.core.files import write_atomically
from sim.core.goals import GoalSpec
from sim.core.interface import GOAL_CATEGORIES, CameraModel
from sim.env.scene import Scene
from sim.episodes.drawing import draw_start
from sim.episodes.goal_pictures import GoalPictures
from sim.episodes.splits import load_split
from sim.robot.config import RobotConfig
from stubborn.detection.attributes import FILE
from stubborn.detection.pictured import CELLS, PictureGoal, colour_cells, one_hot, similarities

_MIN_PIXELS = 60
_STRIDE_PX = 4
_MIN_EXAMPLES = 60
"""Number of examples of each colour, drawn ones included."""
_PICTURES = 6
"""Pictures in each house."""
_MORE_CATEGORIES = ("appliances", "mirror", "shelving", "curtain")
"""Categories that tell rooms apart and are no goal categories."""


@dataclass(frozen=True, kw_only=True)
class Args:
    """Count colours and contents of rooms."""

    houses: cli.Count = 100
    """Number of houses of `train`."""
    views: cli.Count = 20
    """Random views in each."""
    out: Path = FILE
    """The file."""


def main(args: Args) -> int:
    """Writes the file; returns the exit status."""
    split, rng = load_split("train"), np.random.default_rng(0)
    shares: dict[str, list[np.ndarray]] = defaultdict(list)
    alike, same = list[tuple[float, float]](), list[bool]()
    rooms, held = Counter[str](), Counter[tuple[str, str]]()
    for number, house in enumerate(split.houses[: args.houses]):
        scene = Scene(split.load_house(house), robot=RobotConfig(), camera=CameraModel(), profile="fast")
        _count_rooms(scene, rooms, held)
        seen = _count_colours(scene, args.views, rng, shares)
        _compare_pictures(scene, np.random.default_rng(number), seen, alike, same)
        scene.close()
        print(f"\r{number + 1} of {args.houses} houses", end="", flush=True)
    colours = _fit_colours(shares)
    kinds = {
        kind: {
            category: round((held[kind, category] + 0.5) / (count + 1.0), 3)
            for category in (*GOAL_CATEGORIES, *_MORE_CATEGORIES)
        }
        for kind, count in sorted(rooms.items())
        if count >= 10
    }
    print(f"\n{ {name: len(of_colour) for name, of_colour in shares.items()} } views; rooms: {dict(rooms)}")
    write_atomically(
        args.out,
        json.dumps({"picture": _fit_pictures(alike, same), "colours": colours, "rooms": kinds}, indent=1) + "\n",
    )
    return 0


def _fit_colours(shares: dict[str, list[np.ndarray]]) -> dict[str, object]:
    """Returns the weights of a logistic regression from the shares of the pixels' colours to an object's colour.

    Colours that few objects have are joined by examples that are mostly seen as what they are.
    """
    from sklearn.linear_model import LogisticRegression

    rng, features, labels = np.random.default_rng(0), [], []
    for name in ("", *COLOUR_NAMES):
        examples = list(shares[name])
        if len(examples) < _MIN_EXAMPLES and name:
            weights = np.full(len(COLOUR_NAMES), 0.3)
            weights[COLOUR_NAMES.index(name)] = 4.0
            examples += list(rng.dirichlet(weights, _MIN_EXAMPLES - len(examples)))
        features += examples
        labels += [name] * len(examples)
    fitted = LogisticRegression(class_weight="balanced", max_iter=2000, C=10.0)
    fitted.fit(np.sqrt(np.array(features)), labels)
    right = np.asarray(fitted.predict(np.sqrt(np.array(features)))) == np.array(labels)
    print(f"\ncolours: {100 * right.mean():.0f} % of {len(labels)} examples")
    return {
        "names": list(fitted.classes_),
        "weights": np.round(fitted.coef_, 4).tolist(),
        "offsets": np.round(fitted.intercept_, 4).tolist(),
    }


def _count_rooms(scene: Scene, rooms: Counter[str], held: Counter[tuple[str, str]]) -> None:
    for room in scene.world.rooms:
        rooms[room.kind] += 1
    inside: dict[tuple[str, str], set[str]] = defaultdict(set)
    for item in scene.task.truth.meaning.objects:
        if item.is_goal and item.room:
            inside[item.room.name, item.room_kind].add(item.instance.category)
    for (_, kind), categories in inside.items():
        held.update((kind, category) for category in categories)


def _fit_pictures(alike: Sequence[tuple[float, float]], same: Sequence[bool]) -> dict[str, object]:
    """Returns the weights of a logistic regression from two similarities to the probability of the same object."""
    from sklearn.linear_model import LogisticRegression
    from sklearn.model_selection import cross_val_predict

    fitted = LogisticRegression(C=10.0).fit(alike, same)
    right = np.mean(np.asarray(cross_val_predict(fitted, alike, same, cv=5)) == np.array(same))
    print(f"pictures: {100 * right:.0f} % of {len(same)} pairs, {sum(same)} of the same object, cross-validated")
    return {"weights": np.round(fitted.coef_[0], 4).tolist(), "offset": round(float(fitted.intercept_[0]), 4)}


def _compare_pictures(
    scene: Scene,
    rng: np.random.Generator,
    seen: Mapping[str, tuple[np.ndarray, np.ndarray]],
    alike: list[tuple[float, float]],
    same: list[bool],
) -> None:
    """Compares pictures of some objects with what random views show of all objects of their category."""
    pictures, drawn = GoalPictures(scene.task), 0
    scene.world.restore()
    for item in rng.permutation(np.array(scene.task.truth.meaning.objects, object)).tolist():
        rivals = [other.name for other in scene.world.labels.of_category(item.instance.category) if other.name in seen]
        asked = item.is_goal and item.instance.category in GOAL_CATEGORIES and item.instance.name in seen
        camera = pictures.of(item, rng) if asked and len(rivals) > 1 else None
        if camera is None:
            continue
        goal = GoalSpec(item.instance.name, "picture", camera)
        picture, categories = scene.picture_of(goal), scene.picture_of(goal, "semantic")
        assert picture is not None
        assert categories is not None
        shown = PictureGoal.of(picture, one_hot(categories))
        for name in rivals:
            alike.append(similarities(shown, *seen[name]))
            same.append(name == item.instance.name)
        drawn += 1
        if drawn == _PICTURES:
            break
    pictures.close()


def _count_colours(
    scene: Scene, views: int, rng: np.random.Generator, shares: dict[str, list[np.ndarray]]
) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Adds the shares of the colours of each object in some random views; returns those of it and around it."""
    seen: dict[str, np.ndarray] = {}
    facts = {item.instance.name: item for item in scene.task.truth.meaning.objects}
    labels, goal = scene.world.labels, scene.task.truth.goals()[0]
    for _ in range(views):
        scene.world.reset(draw_start(scene.task, goal, rng))
        images = scene.camera.render(scene.world.data, scene.world.camera_pose, ("rgb", "geom"))
        middle = slice(_STRIDE_PX // 2, None, _STRIDE_PX)
        rgb, geoms = images["rgb"][middle, middle], images["geom"][middle, middle]
        objects = np.append(labels.geom_instance, np.int32(-1))[geoms]
        numbers, cells = colour_numbers(rgb.astype(np.float32) / 255.0), colour_cells(rgb)
        frame = np.bincount(cells.ravel(), minlength=CELLS)
        for number, pixels in zip(*np.unique(objects, return_counts=True), strict=True):
            item = facts[labels.instances[number].name] if number >= 0 else None
            if item is None or pixels < _MIN_PIXELS or not item.is_goal:
                continue
            counts = np.bincount(numbers[objects == number], minlength=len(COLOUR_NAMES))
            shares[item.facts.colour or ""].append(counts / counts.sum())
            own = np.bincount(cells[objects == number], minlength=CELLS)
            seen[item.instance.name] = seen.get(item.instance.name, 0) + np.stack([own, frame - own])
    return {name: (own / own.sum(), around / max(around.sum(), 1)) for name, (own, around) in seen.items()}


if __name__ == "__main__":
    sys.exit(cli.run(Args, main))
