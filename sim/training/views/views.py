"""Labelled views for training a segmentation network: sampling of poses, rejection of bare walls, metadata.

Half of the views are from random free positions in random directions; the other half are along shortest paths between
two positions of the house, on the 30 deg grid of headings of an exploring robot. Sequences are all views along such a
path, in their order. `EXTRAS` are members that a view has only where they are asked for.
"""

from __future__ import annotations

import contextlib
import zlib
from collections.abc import Collection, Iterator, Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any, Literal, get_args

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.core.errors import EpisodeError, HouseError
from sim.core.geometry.pose import Pose, as_body_pose
from sim.core.interface import MPCAT40_ID, CameraModel
from sim.env.scene import Scene
from sim.episodes.descriptions import Descriptions
from sim.houses.labels import Labels
from sim.training.views.aimed import RARE, Aim, aimed_poses, shows
from sim.training.views.coco import annotate
from sim.training.views.normals import encode_normals, surface_normals
from sim.training.views.poses import MAX_TRIES, any_pose, mixed_poses, sequence_poses
from sim.training.views.variation import leaning
from sim.world.freespace import FreeSpace

BARE_SHARE = 0.97
"""A view is rejected if wall, floor, ceiling and void cover more than this share and its median depth is small."""
BARE_DEPTH_M = 1.2
"""Median depth below which such a view is rejected: a near wall holds no information."""
Extra = Literal["instances", "normals", "poses"]
"""A member of a view in addition to colour, depth and categories."""
EXTRAS: tuple[Extra, ...] = get_args(Extra)
_COLOUR_CAMERA = CameraModel(width_px=160, height_px=120)
"""Camera of the pictures in which the colours of descriptions are measured; small, because they cost the most time."""
_VIEWS_PER_OBJECT = 12
"""Views for each object that is described: the proof of a description takes about as long as half a view."""
_STRUCTURE = np.isin(np.arange(256), [MPCAT40_ID[name] for name in ("void", "wall", "floor", "ceiling")])


@dataclass(frozen=True)
class View:
    """One labelled view."""

    key: str
    rgb: NDArray[np.uint8]
    """(h, w, 3)"""
    depth_mm: NDArray[np.uint16]
    """(h, w) millimetres along the optical axis; 0: no return or below the camera's range; its maximum: beyond it."""
    semantic: NDArray[np.uint8]
    """(h, w) mpcat40 id"""
    record: dict[str, Any]
    """House, pose, intrinsics, profile and versions; JSON types."""
    instances: NDArray[np.uint16] | None = None
    """(h, w) number of the instance, from 1, the same in all views of a house; 0: none."""
    annotations: list[dict[str, Any]] | None = None
    """Boxes and masks of the objects (`sim.training.views.coco.annotate`)."""
    normals: NDArray[np.uint8] | None = None
    """(h, w, 3) surface normals (`sim.training.views.normals.encode_normals`)."""


def sample_views(
    scene: Scene,
    rng: np.random.Generator,
    count: int,
    *,
    stem: str,
    record: dict[str, Any],
    block_px: int = 1,
    extras: Collection[Extra] = (),
    sequence: int | None = None,
    aim: Aim | None = None,
    styles: Mapping[str, str] | None = None,
    lean: bool = False,
) -> Iterator[View]:
    """Yields views of one house; the same generator state gives the same views.

    Args:
        scene: the house; the robot is not rendered.
        rng: generator of the poses.
        count: number of views.
        stem: the keys are `<stem>_<number>`.
        record: entries of each view's record.
        block_px: factor by which views are reduced: colour is averaged, all else takes the middle pixel.
        extras: names of `EXTRAS`.
        sequence: number of views of a sequence along one path; bare walls in it are not rejected. None: no sequences.
        aim: `rare`: the camera is aimed at objects that are rare in other views. None: it is not.
        styles: style of each instance of the house by its name, for the annotations; None: they are not known.
        lean: in a share of the views, the body and its camera lean (`sim.training.views.variation`).

    Raises:
        HouseError: the house has no free position, shows only bare walls, has no path of that many views, or no object
            to aim at.
    """
    space = scene.task.truth.space(0.0)
    cells = np.argwhere(space.largest_part())
    name = scene.world.house.name
    if len(cells) == 0:
        raise HouseError(f"House '{name}': the robot fits nowhere, so it cannot be viewed.")
    start_world(scene, space, cells, rng)
    if aim is not None:
        poses = aimed_poses(scene.world, space, cells, rng, RARE)
    elif sequence is not None:
        poses = sequence_poses(space, cells, rng, sequence, name)
    else:
        poses = mixed_poses(space, cells, rng)
    labels = ("depth", "semantic", *(("geom",) if aim or {"instances", "normals"} & set(extras) else ()))
    taken = tries = 0
    with (
        contextlib.closing(_Describer(scene, -(-count // _VIEWS_PER_OBJECT)))
        if "instances" in extras
        else contextlib.nullcontext()
    ) as describe:
        while taken < count:
            if tries >= MAX_TRIES * count:
                raise HouseError(f"House '{name}': {taken} of {count} views after {tries} tries; it shows too little.")
            tries += 1
            pose, how = next(poses)
            pose = leaning(pose, rng) if lean else pose
            images = scene.camera.render(scene.world.data, pose, labels)
            if sequence is None and is_bare(images["semantic"], images["depth"]):
                continue
            camera = scene.camera.camera
            if aim is not None and not shows(images["geom"], scene.world.labels, how["aim"]["instance"], camera):
                continue
            images |= scene.camera.render(scene.world.data, pose, ("rgb",))
            yield _view(f"{stem}_{taken:05d}", images, pose, scene, block_px, record | how, extras, styles, describe)
            taken += 1


class _Describer:
    """Describes objects of a house by texts that fit no other one; each object is described once, when it is seen.

    Args:
        scene: the house.
        limit: number of objects that are described, the first ones that are asked for.
    """

    def __init__(self, scene: Scene, limit: int) -> None:
        self._remaining = limit
        self._descriptions = Descriptions(scene.task, _COLOUR_CAMERA, scene.camera.profile)
        self._objects = {item.instance.name: item for item in scene.task.truth.meaning.objects if item.facts.name}
        self._texts: dict[str, str | None] = {}
        self.names = {name: item.facts.name for name, item in self._objects.items()}
        """The everyday names that the house file says."""

    def __call__(self, name: str) -> str | None:
        """Returns the shortest text that fits the instance with a name, always the same; None: none is proved."""
        if self._remaining and name not in self._texts:
            item, rng = self._objects.get(name), np.random.default_rng(zlib.crc32(name.encode()))
            self._texts[name] = None
            if item is not None and item.is_goal:
                described = next(self._descriptions.of(item, rng), None)
                self._texts[name] = None if described is None else described.text
                self._remaining -= 1
        return self._texts.get(name)

    def close(self) -> None:
        """Frees the renderer."""
        self._descriptions.close()


def is_bare(semantic: NDArray[np.uint8], depth: NDArray[np.float32]) -> bool:
    """Returns whether a view shows only near bare walls; it tests every fourth pixel in each direction.

    A pixel without return counts as near, as a surface right in front of the camera has no return.
    """
    structure = _STRUCTURE[semantic[::4, ::4]].mean()
    return bool(structure > BARE_SHARE and np.median(depth[::4, ::4]) < BARE_DEPTH_M)


def intrinsics(camera: CameraModel, block_px: int) -> dict[str, float]:
    """Returns the pinhole intrinsics of a reduced view; pixel centres are at half pixels."""
    focal_px = camera.focal_px / block_px
    return {
        "width_px": camera.width_px // block_px,
        "height_px": camera.height_px // block_px,
        "fx_px": focal_px,
        "fy_px": focal_px,
        "cx_px": 0.5 * camera.width_px / block_px,
        "cy_px": 0.5 * camera.height_px / block_px,
    }


def reduce_image(image: NDArray, block_px: int) -> NDArray:
    """Returns an image with one pixel for each block: the mean of colour (h, w, 3), else the middle pixel (h, w)."""
    if block_px == 1:
        return image
    height, width = image.shape[:2]
    if image.ndim == 3:
        return cv2.resize(image, (width // block_px, height // block_px), interpolation=cv2.INTER_AREA)
    return _middle_pixels(image, block_px)


def camera_to_world(pose: Pose, camera: CameraModel) -> NDArray[np.float64]:
    """Returns the transform `T_world_cam` (4, 4) from the camera's frame to the world's, in metres.

    The camera's axes are those of OpenCV: x to the right, y down, z along the optical axis.
    """
    body = as_body_pose(pose)
    ahead, left, up = body.axes
    view = np.column_stack([-left, -up, ahead, body.point(0.0, 0.0, camera.height_m)])
    return np.vstack([view, [0.0, 0.0, 0.0, 1.0]])


def _middle_pixels(image: NDArray, block_px: int) -> NDArray:
    """Returns the middle pixel of each block of an image (h, w, ...)."""
    middle = block_px // 2
    return np.ascontiguousarray(image[middle::block_px, middle::block_px])


def _view(
    key: str,
    images: dict[str, NDArray],
    pose: Pose,
    scene: Scene,
    block_px: int,
    record: dict[str, Any],
    extras: Collection[str],
    styles: Mapping[str, str] | None,
    describe: _Describer | None,
) -> View:
    camera = scene.camera.camera
    depth_mm = np.rint(reduce_image(images["depth"], block_px) * 1000.0).astype(np.uint16)
    camera_entry = {"intrinsics": intrinsics(camera, block_px), "camera_height_m": camera.height_m}
    pose_entry: dict[str, Any] = {name: round(value, 4) for name, value in asdict(pose).items()}
    if "poses" in extras:
        record = record | {"T_world_cam": camera_to_world(type(pose)(**pose_entry), camera).round(6).tolist()}
    view = View(
        key,
        reduce_image(images["rgb"], block_px),
        depth_mm,
        reduce_image(images["semantic"], block_px),
        {"key": key, "pose": pose_entry, **camera_entry, **record},
    )
    if "normals" in extras:
        normals = surface_normals(images["depth"], images["geom"], camera)
        view = replace(view, normals=_middle_pixels(encode_normals(normals), block_px))
    if "instances" in extras:
        labels = scene.world.labels
        ids = _instance_ids(_middle_pixels(images["geom"], block_px), labels)
        names = None if describe is None else describe.names
        view = replace(view, instances=ids, annotations=annotate(ids, labels.instances, styles, names, describe))
    return view


def _instance_ids(geom: NDArray[np.int32], labels: Labels) -> NDArray[np.uint16]:
    """Returns the number of the instance of each pixel (h, w), from 1; 0: none."""
    numbers = np.append(labels.geom_instance, -1) + 1  # geom -1 takes the last
    return numbers[geom].astype(np.uint16)


def start_world(scene: Scene, space: FreeSpace, cells: NDArray[np.intp], rng: np.random.Generator) -> None:
    """Starts the world at a random free position where the body fits, so that movable objects come to rest."""
    for _ in range(MAX_TRIES):
        try:
            scene.world.reset(any_pose(space, cells, rng))
        except EpisodeError:
            continue
        return
    raise HouseError(f"House '{scene.world.house.name}': the robot did not fit at {MAX_TRIES} free places.")
