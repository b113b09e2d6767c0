"""Lists what users can choose on the page: the parts that ship, and those with which the server was started."""

from __future__ import annotations

import base64
import re
import threading
from collections import OrderedDict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Literal

import cv2
import msgspec

from sim.app.composition.agents import EXPLORERS, SPECS, find_agent, find_explorer, takes_explorer
from sim.app.composition.segmenters import KINDS, NetworkConfig, find_segmentation
from sim.app.evaluation.results import HUMAN_NAME, RunRecord, is_driven
from sim.app.options import RunOptions
from sim.app.viewers.house_pictures import draw_top_to_scale
from sim.app.web.controls import Driver, EpisodeRequest
from sim.core import invocation
from sim.core.configuration import assignments_of, with_fields
from sim.core.errors import ConfigError, HouseError
from sim.core.goals import NO_GOAL
from sim.core.interface import GOAL_CATEGORIES
from sim.core.option_types import meanings
from sim.core.pictures import jpeg_of
from sim.core.reading import convert
from sim.core.wishes import parse_wish
from sim.episodes.replicates import episode_of
from sim.episodes.splits import HOUSE_SUFFIXES, Split, absolute_split, load_split, one_house, shipped_splits
from sim.houses.labels import read_labels
from sim.task.result import EpisodeResult

NOT_OFFERED = (
    "test", "large-test", "hazards-test", "contact-test", "contact-heldout", "words-seen-test", "words-synonyms-test",
    "words-unseen-test",
)  # fmt: skip
"""Splits that are kept for a last measurement; the page offers them only if `--split` names them."""
FIRST = ("val", "large", "hazards", "traps", "contact-val")
"""The splits that the page lists first."""
Goals = Mapping[str, Mapping[str, list[str]]]
"""The ids of the episodes by house and goal; the lists of a house file are empty, because its episodes are drawn."""
MAX_PICTURES = 16
"""Pictures of houses that are kept."""
JPEG_QUALITY = 95
"""Of these pictures."""
_PLAIN_TEXT = re.compile(r"[\w-]*")


@dataclass(frozen=True, kw_only=True)
class Offer:
    """The parts with which the server was started, in addition to those that ship."""

    agents: tuple[str, ...] = ()
    explorers: tuple[str, ...] = ()
    semantics: tuple[str, ...] = ()
    splits: tuple[str, ...] = ()
    houses: tuple[Path, ...] = ()
    options: RunOptions = field(default_factory=RunOptions)
    """Options that every episode gets, for example weights, robot and noise."""


class Choices:
    """The houses with their goals and episodes, and the agents, explorers and segmentations that users can choose."""

    def __init__(self, offer: Offer) -> None:
        """Reads everything that can be chosen, once.

        Raises:
            ConfigError, HouseError: an agent, explorer, segmentation, split or house cannot be found or read.
        """
        self._options = offer.options
        self._agents = {**SPECS, **{name: find_agent(name) for name in offer.agents}}
        self._explorers = {**EXPLORERS, **{name: find_explorer(name) for name in offer.explorers}}
        self._semantics = {**KINDS, **{name: find_segmentation(name, None) for name in offer.semantics}}
        self._splits: dict[str, Goals] = {absolute_split(name): _goals_of_split(name) for name in offer.splits}
        self._houses = {str(file): file for file in offer.houses}
        self._splits |= {name: _goals_of_house(file, offer.options) for name, file in self._houses.items()}
        others = [name for name in shipped_splits() if name not in (*NOT_OFFERED, *self._splits)]
        others.sort(key=lambda name: (FIRST.index(name) if name in FIRST else len(FIRST), name))
        self._splits |= {name: _goals_of_split(name) for name in others}
        self._pictures: OrderedDict[tuple[str, str], dict[str, object]] = OrderedDict()
        self._drawing = threading.Lock()
        self._first = {
            "split": next(iter(self._splits)),
            "agent": (*offer.agents, offer.options.agent)[0],
            "explorer": (*offer.explorers, "")[0],
            "semantics": (*offer.semantics, offer.options.semantics)[0],
        }

    def as_json(self) -> dict[str, object]:
        """Returns everything that can be chosen, as JSON types."""
        return {
            "splits": self._splits,
            "agents": {
                name: {
                    "description": spec.description,
                    "segmentation": spec.uses_segmentation,
                    "explorer": takes_explorer(spec),
                }
                for name, spec in self._agents.items()
            },
            "explorers": list(self._explorers),
            "semantics": {name: kind.description for name, kind in self._semantics.items()},
            "first": self._first,
            "run_command": invocation.command("run", "--video"),
        }

    def house_from_above(self, split: str, house: str) -> dict[str, object]:
        """Returns the picture of a house before its start: JPEG in Base64, the place in its middle, metres per pixel.

        Raises:
            ConfigError: the page does not offer this house.
            HouseError: the house cannot be read.
        """
        self._require("split", split, self._splits)
        if house not in self._splits[split]:
            raise ConfigError(f"There is no house '{house}' in '{split}'.")
        with self._drawing:
            if (split, house) not in self._pictures:
                top = draw_top_to_scale(self._split_of(split).load_house(house))
                picture = cv2.resize(top.picture, None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA)
                if len(self._pictures) >= MAX_PICTURES:
                    self._pictures.popitem(last=False)
                jpeg = base64.b64encode(jpeg_of(picture, JPEG_QUALITY)).decode()
                about = {"jpeg": jpeg, "middle_m": top.middle_m, "m_per_px": 2.0 * top.m_per_px}
                self._pictures[split, house] = about
            return self._pictures[split, house]

    def _split_of(self, split: str) -> Split:
        if split in self._houses:
            return one_house(self._houses[split], labels=self._options.labels, root=self._options.root)
        return load_split(split)

    def request(self, message: Mapping[str, object]) -> EpisodeRequest:
        """Returns the request that a message of the page describes.

        Raises:
            ConfigError: a part of it cannot be chosen.
        """
        return self._request(convert(message, _Start, where="The message"))

    def again(self, record: RunRecord, result: EpisodeResult, driver: Driver) -> EpisodeRequest:
        """Returns a request for an episode of a finished run, with the agent, seed and settings of that run.

        Args:
            record: the run's `config.json`.
            result: of the episode.
            driver: the agent or a person, who drives the robot first.

        Raises:
            ConfigError: the server was started without a part of the run, or a field of the record is missing.
        """
        file = record.get("house")
        asked = {
            "split": str(Path(str(file)).absolute()) if file else absolute_split(str(record.get("split"))),
            "house": result.house,
            "goal": result.goal,
            "agent": "stubborn" if is_driven(record) else record.get("agent"),
            "semantics": record.get("semantics"),
            "explorer": record.get("explorer") or "",
            "episode": result.episode_id,
            "driver": driver,
        }
        request = self._request(convert(asked, _Start, where="The run's config.json"))
        if file and "episodes" not in record:  # the episodes are drawn again, as the run drew them
            raise ConfigError("The run's config.json does not contain the number of episodes.")
        meaning = meanings(RunOptions).items()
        plain = {name for name, option in meaning if option.plain and (file or not option.of_episodes)}
        options = with_fields(request.options, {name: record[name] for name in plain if name in record})
        options = replace(options, episodes=options.episodes // options.replicates)  # config.json counts each replicate
        options = replace(options, config=_settings(record, self._options.config), config_file=None)
        return replace(request, record=record, options=options)

    def _request(self, asked: _Start) -> EpisodeRequest:
        """Returns a request; raises ConfigError if a part of it is not offered."""
        is_house = Path(asked.split).suffix.lower() in HOUSE_SUFFIXES
        self._require("house" if is_house else "split", asked.split, self._splits)
        self._require("agent", asked.agent, self._agents)
        self._require("semantics", asked.semantics, self._semantics)
        if asked.explorer:
            self._require("explorer", asked.explorer, self._explorers)
        houses = self._splits[asked.split]
        house, goal = asked.house, asked.goal
        is_wish = number_of_wish(asked.episode, asked.house) is not None
        if asked.episode and asked.split not in self._houses and not is_wish:
            house, goal = _place_of(asked.episode, houses, asked.split)
        in_words = goal not in houses.get(house, {})
        if in_words:
            self._require_words(house, goal, asked, houses)
        options = replace(self._options, agent=asked.agent, semantics=asked.semantics, explorer=asked.explorer or None)
        if not goal:
            options = self._without_agent(options, asked)
        if asked.split in self._houses:
            options = replace(options, house=self._houses[asked.split], goal=goal or None)
        else:
            root = options.root if options.robot is not None else None
            options = replace(options, split=asked.split, labels=None, root=root, goal=goal if in_words else None)
        if asked.start is not None:
            options = self._with_start(options, asked, house, goal or None)
        if not isinstance(self._semantics[asked.semantics].config, NetworkConfig):
            options = replace(options, weights=None)
        return EpisodeRequest(
            split=asked.split,
            house=house,
            goal=goal,
            episode_id=None if asked.start is not None else asked.episode or None,
            driver=asked.driver,
            options=options,
        )

    @staticmethod
    def _without_agent(options: RunOptions, asked: _Start) -> RunOptions:
        """Returns the options of an episode without a goal; raises ConfigError if an agent shall search in it."""
        if asked.driver == "agent":
            raise ConfigError(f"House '{asked.house}' has no goal for an agent; you can drive in it yourself.")
        return replace(options, agent=HUMAN_NAME, semantics="gt", explorer=None, weights=None)

    def _with_start(self, options: RunOptions, asked: _Start, house: str, goal: str | None) -> RunOptions:
        """Returns options with a chosen start: those of an episode in the house's file."""
        assert asked.start is not None
        split = self._split_of(asked.split)
        start_deg = " ".join(f"{number:.4f}" for number in asked.start)
        return replace(
            options,
            house=split.house_file(house),
            labels=split.labels_path,
            root=split.root or options.root,
            goal=goal,
            start_deg=start_deg,
        )

    def _require_words(self, house: str, goal: str, asked: _Start, houses: Goals) -> None:
        """Raises ConfigError if a goal that is not listed is not in words that can be read and that the agent takes."""
        if house not in houses:
            raise ConfigError(f"There is no house '{house}' in '{asked.split}'.")
        if goal in GOAL_CATEGORIES:
            raise ConfigError(f"There is no '{goal}' in house '{house}' of '{asked.split}'.")
        parse_wish(goal)
        if self._agents[asked.agent].words is None:
            raise ConfigError(
                f"The agent '{asked.agent}' takes the listed goals only, no goals in words; an agent declares them "
                "with AgentSpec.words (docs/words.md#agents)."
            )

    @staticmethod
    def _require(option: str, name: str, offered: Mapping[str, object]) -> None:
        if name not in offered:
            command = invocation.command("web", f"--{option}", name)
            raise ConfigError(f"This page does not offer --{option} '{name}'. Start the server with it: {command}")


Coordinate = Annotated[float, msgspec.Meta(ge=-1000.0, le=1000.0)]


class _Start(msgspec.Struct):
    """A message of the page that requests an episode."""

    split: str
    house: str
    goal: str
    agent: str
    semantics: str
    explorer: str = ""
    episode: str = ""
    driver: Literal["agent", "person"] = "agent"
    start: tuple[Coordinate, Coordinate, Coordinate] | None = None
    """Metres, metres and degrees; None: that of an episode."""


def _goals_of_split(name: str) -> Goals:
    goals: dict[str, dict[str, list[str]]] = {}
    for episode in load_split(name).episodes:
        goals.setdefault(episode.house, {}).setdefault(episode.goal, []).append(episode.episode_id)
    return {house: dict(sorted(of_house.items())) for house, of_house in sorted(goals.items())}


def _goals_of_house(file: Path, options: RunOptions) -> Goals:
    """Returns the goals in a house file: the one that its sidecar fixes, else all categories that the house has.

    A house without any has the goal "": a person can drive in it.
    """
    split = one_house(file, labels=options.labels, root=options.root)
    house = split.load_house(file.stem)
    fixed = split.sidecar(file.stem).goal
    categories = read_labels(house.spec.copy().compile(), rules=house.rules).categories()
    goals = [goal for goal in GOAL_CATEGORIES if goal in categories and fixed in (None, goal)]
    if fixed is not None and not goals:
        there_is = ", ".join(categories) or "no labels"
        raise HouseError(f"The sidecar of house '{file}' asks for '{fixed}', and it has: {there_is}.")
    return {file.stem: {goal: [] for goal in sorted(goals) or [NO_GOAL.text]}}


def _place_of(episode_id: str, houses: Goals, split: str) -> tuple[str, str]:
    """Returns house and goal of an episode."""
    for house, goals in houses.items():
        for goal, ids in goals.items():
            if episode_of(episode_id) in ids:
                return house, goal
    raise ConfigError(f"Split '{split}' has no episode '{episode_id}'.")


WISH = "_wish_"
"""Part of the id of an episode that the page drew for a goal in words."""


def number_of_wish(episode_id: str | None, house: str) -> int | None:
    """Returns the number of an episode that the page drew for a goal in words; None if the id is of another one."""
    found = re.fullmatch(rf"{re.escape(house)}{WISH}(\d{{4,9}})", episode_id or "")
    return None if found is None else int(found[1])


def _settings(record: RunRecord, own: Iterable[str]) -> tuple[str, ...]:
    """Returns the settings of a run in the form of `--config`.

    Args:
        record: the run's `config.json`.
        own: the server's assignments. They replace those settings of the run that may name files, because a record
            must not choose files.
    """
    settings = record.get("settings")
    settings = settings if isinstance(settings, dict) else {}
    plain = {path: value for path, value in settings.items() if _is_plain(value)}
    files = settings.keys() - plain.keys()
    return (*assignments_of(plain), *(assignment for assignment in own if assignment.partition("=")[0] in files))


def _is_plain(value: object) -> bool:
    if isinstance(value, list):
        return all(map(_is_plain, value))
    return not isinstance(value, dict) and (not isinstance(value, str) or _PLAIN_TEXT.fullmatch(value) is not None)
