"""Users' segmentations (`--semantics package.module:NAME`): each result is checked, so that errors name their cause."""

from __future__ import annotations

import inspect
import operator
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, NoReturn, TypeVar

import numpy as np
from numpy.typing import NDArray

from sim.app.composition.imports import import_attribute
from sim.app.evaluation.own_code import described
from sim.app.evaluation.watch import is_stop
from sim.core.errors import AgentError, ConfigError, ObjectNavError
from sim.core.interface import (
    MPCAT40,
    POSE_SENSORS,
    CameraModel,
    Observation,
    ReadsPosteriors,
    Scores,
    SegmentationSpec,
    SegmenterSpec,
    scores_of,
)

if TYPE_CHECKING:
    from sim.env.objectnav import ObjectNavEnv

T = TypeVar("T")
_METHODS = ("scores", "posteriors", "categories")


def load_specification(name: str) -> SegmentationSpec:
    """Returns the specification of a user's segmentation.

    Args:
        name: `package.module:NAME`, where NAME is a `SegmentationSpec` or a factory. A factory, such as a class, may
            have an attribute `spec`, a `SegmenterSpec`, which is its declaration; without it, it reads `rgb` and
            `depth`.

    Raises:
        ConfigError: there is no such module or name, or its object has another type.
    """
    own = import_attribute(name)
    if isinstance(own, SegmentationSpec):
        return own
    if not callable(own):
        raise ConfigError(f"--semantics '{name}' must be a SegmentationSpec or a factory, got {type(own).__name__}.")
    declared = getattr(own, "spec", None)
    description = (inspect.getdoc(own) or "").partition("\n")[0]
    if isinstance(declared, SegmenterSpec):
        return SegmentationSpec(make=own, spec=declared, description=description)
    return SegmentationSpec(make=own, description=description)


def make_own(name: str, own: SegmentationSpec, env: ObjectNavEnv, config: object) -> OwnSegmenter:
    """Returns the segmenter of a specification for an environment.

    Raises:
        ConfigError: the factory failed, or its object has neither `scores` nor `posteriors`.
    """
    truth = {"truth": env} if own.spec.truth else {}
    return built(name, own, camera=env.camera_model, config=config, **truth)


def built(name: str, own: SegmentationSpec, *, camera: CameraModel, **others: object) -> OwnSegmenter:
    """Returns the segmenter that a factory builds; it gets those of the given arguments that it takes.

    Raises:
        ConfigError: as `make_own`.
    """
    try:
        parts, parameters = {"camera": camera, **others}, inspect.signature(own.make).parameters
        takes_all = any(parameter.kind is inspect.Parameter.VAR_KEYWORD for parameter in parameters.values())
        segmenter = own.make(**{key: value for key, value in parts.items() if takes_all or key in parameters})
    except BaseException as error:
        if is_stop(error) or (isinstance(error, ObjectNavError) and not isinstance(error, AgentError)):
            raise
        raise ConfigError(f"Segmentation '{name}' cannot be built: {described(error, below=__file__)}") from error
    if not any(callable(getattr(segmenter, method, None)) for method in _METHODS[:2]):
        raise ConfigError(f"Segmentation '{name}': {type(segmenter).__name__} has no method scores or posteriors.")
    return OwnSegmenter(name, segmenter, own.spec, camera)


class OwnSegmenter:
    """A user's segmenter with its declaration: it gets only the sensors that it declares, and its results are checked.

    Each result of a frame is computed once, so that viewers change nothing. If the segmenter has no methods of its own
    for scores or categories, they are computed from the posteriors.
    """

    def __init__(self, name: str, segmenter: Any, spec: SegmenterSpec, camera: CameraModel) -> None:
        self.spec = spec
        self._name, self.inner = name, segmenter
        self._methods = {name for name in _METHODS if callable(getattr(segmenter, name, None))}
        self._shape = camera.height_px, camera.width_px
        names = [sensor if isinstance(sensor, str) else sensor.name for sensor in spec.sensors]
        self._reads = frozenset(("depth", *names, *POSE_SENSORS))
        self._arrays: tuple[NDArray, ...] = ()
        """Arrays of the present frame: they identify it, because an agent may put them into another dictionary."""
        self._done: dict[str, Any] = {}
        """Results of the present frame by method and goal."""

    @property
    def names(self) -> bool:
        """True: it names the category of each pixel."""
        return not self._methods.isdisjoint(_METHODS[1:])

    def require_read_by(self, agent: object, name: str) -> None:
        """Raises ConfigError if an agent with this name states that it reads posteriors, and there are none."""
        if isinstance(agent, ReadsPosteriors) and agent.reads_posteriors and "posteriors" not in self._methods:
            raise ConfigError(
                f"Segmentation '{self._name}' has no method posteriors, which agent '{name}' reads in addition to "
                "scores: add it, or run an agent that reads only scores, such as --agent stubborn."
            )

    def scores(self, observation: Observation, goal: str) -> Scores:
        """Returns the scores of one frame, float32 (h, w) at any whole fraction of the image's resolution.

        Raises:
            AgentError: the user's code failed, or returned another type, shape or range.
        """
        return self._once(observation, f"scores {goal}", lambda seen: self._scores(observation, seen, goal))

    def posteriors(self, observation: Observation) -> NDArray[np.float32]:
        """Returns the posteriors of one frame, float32 (40, h, w), at any whole fraction of the image's resolution.

        Raises:
            AgentError: the user's code failed, returned another type, shape or range, or has no method `posteriors`.
        """
        return self._once(observation, "posteriors", self._posteriors)

    def categories(self, observation: Observation) -> NDArray[np.uint8] | None:
        """Returns the mpcat40 id of each pixel, uint8 (h, w); None: the user's segmenter does not compute them.

        Raises:
            AgentError: as `posteriors`.
        """
        return self._once(observation, "categories", lambda seen: self._categories(observation, seen))

    def objects(self, observation: Observation) -> tuple[NDArray[np.int32], Sequence[str]] | None:
        """Returns the objects that the user's segmenter tells apart; None: it has no such method, or sees none.

        Raises:
            AgentError: the user's code failed, or returned other types or numbers.
        """
        if not callable(getattr(self.inner, "objects", None)):
            return None
        return self._once(observation, "objects", self._objects)

    def named(self, observation: Observation) -> tuple[NDArray[np.float32], Sequence[str]] | None:
        """Returns the probabilities of everyday names; None: the user's segmenter has no such method, or knows none.

        Raises:
            AgentError: the user's code failed, or returned another type, shape or range.
        """
        if not callable(getattr(self.inner, "named", None)):
            return None
        return self._once(observation, "named", self._named)

    def ask(self, word: str, names: frozenset[str]) -> None:
        """Gives the words of the goal to a segmenter that takes them; see `sim.core.interface.TakesWords`.

        Raises:
            AgentError: the user's code failed.
        """
        if callable(getattr(self.inner, "ask", None)):
            self._arrays = ()  # the same frame may look different now
            self._ask("ask", lambda: self.inner.ask(word, names))

    def _once(self, observation: Observation, key: str, compute: Callable[[Observation], T]) -> T:
        """Returns a result of a frame; it is computed at the first request, from the sensors that are declared."""
        arrays = tuple(observation.values())
        if len(arrays) != len(self._arrays) or any(map(operator.is_not, arrays, self._arrays)):
            self._arrays, self._done = arrays, {}
        if key not in self._done:
            seen = {name: value for name, value in observation.items() if name in self._reads}
            self._done[key] = compute(seen)
        return self._done[key]

    def _scores(self, observation: Observation, seen: Observation, goal: str) -> Scores:
        if "scores" not in self._methods:
            return scores_of(self.posteriors(observation), goal)
        scores = self._ask("scores", lambda: tuple(np.asarray(score) for score in self.inner.scores(seen, goal)))
        if len(scores) != 2 or scores[0].shape != scores[1].shape:
            shapes = ", ".join(str(score.shape) for score in scores)
            self._refuse("scores", f"arrays of shapes {shapes}; it returns Scores(target, best_other), both (h, w)")
        target, best_other = (self._checked("scores", score, ()) for score in scores)
        return Scores(target, best_other)

    def _posteriors(self, seen: Observation) -> NDArray[np.float32]:
        if "posteriors" not in self._methods:
            raise AgentError(
                f"Segmentation '{self._name}' has no method posteriors, which this agent reads in addition to scores."
            )
        posteriors = self._ask("posteriors", lambda: np.asarray(self.inner.posteriors(seen)))
        return self._checked("posteriors", posteriors, (len(MPCAT40) - 1,))

    def _categories(self, observation: Observation, seen: Observation) -> NDArray[np.uint8] | None:
        if "categories" not in self._methods:
            if "posteriors" not in self._methods:
                return None
            posteriors = self.posteriors(observation)
            named = (posteriors.argmax(axis=0) + 1).astype(np.uint8)
            return np.where(posteriors.max(axis=0) > 0.0, named, np.uint8(0))
        categories = self._ask("categories", lambda: np.asarray(self.inner.categories(seen)))
        self._require_shape("categories", categories, ())
        if categories.dtype.kind not in "iu" or not 0 <= categories.min() <= categories.max() < len(MPCAT40):
            self._refuse("categories", f"an array of {categories.dtype}; it holds mpcat40 ids, integers from 0 to 40")
        return categories.astype(np.uint8)

    def _objects(self, seen: Observation) -> tuple[NDArray[np.int32], Sequence[str]] | None:
        found = self._ask("objects", lambda: self.inner.objects(seen))
        if found is None:
            return None
        image, names = self._ask("objects", lambda: (np.asarray(found[0]), [str(name) for name in found[1]]))
        self._require_shape("objects", image, ())
        if image.dtype.kind not in "iu" or not -1 <= int(image.min()) <= int(image.max()) < len(names):
            self._refuse("objects", f"an array of {image.dtype}; it holds numbers of the {len(names)} names, -1: none")
        return image.astype(np.int32), names

    def _named(self, seen: Observation) -> tuple[NDArray[np.float32], Sequence[str]] | None:
        found = self._ask("named", lambda: self.inner.named(seen))
        if found is None:
            return None
        image, names = self._ask("named", lambda: (np.asarray(found[0]), [str(name) for name in found[1]]))
        return self._checked("named", image, (len(names),)), names

    def _checked(self, method: str, array: NDArray, before: tuple[int, ...]) -> NDArray[np.float32]:
        """Returns an array (*before, h, w) as float32 after a check of shape and range."""
        self._require_shape(method, array, before)
        if array.dtype.kind not in "fiub":
            self._refuse(method, f"an array of {array.dtype}; it is float32")
        low, high = float(array.min()), float(array.max())
        if not (low >= -1e-3 and high <= 1.001):  # also for nan
            self._refuse(method, f"numbers from {low:g} to {high:g}; they are probabilities in [0, 1]")
        return np.clip(array, 0.0, 1.0).astype(np.float32, copy=False)

    def _require_shape(self, method: str, array: NDArray, before: tuple[int, ...]) -> None:
        """Raises AgentError unless an array is (*before, h, w), with h x w the image's or a whole fraction of it."""
        height, width = self._shape
        rows, cols = array.shape[-2:] if array.ndim >= 2 else (0, 0)
        if array.shape[:-2] != before or not rows or not cols or height % rows or height // rows * cols != width:
            expected = ", ".join(map(str, (*before, "h", "w")))
            self._refuse(
                method,
                f"an array of shape {array.shape}; it is ({expected}) with h x w the image's {height} x {width} or a "
                "whole fraction of it",
            )

    def _ask(self, method: str, call: Callable[[], T]) -> T:
        try:
            return call()
        except BaseException as error:
            if is_stop(error):
                raise
            reason = described(error, below=__file__)
            raise AgentError(f"Segmentation '{self._name}', {method}: {reason}") from error

    def _refuse(self, method: str, what: str) -> NoReturn:
        raise AgentError(f"Segmentation '{self._name}': {method} returned {what}.")
