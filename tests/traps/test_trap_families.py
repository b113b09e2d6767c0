"""Traps of families: they are reproducible, can be solved, need a detour, and have the parameters of their sidecars."""

from __future__ import annotations

import collections
from collections.abc import Iterator

import numpy as np
import pytest

from sim.app.commands.traps.make import Args, main, write_family_trap
from sim.app.commands.traps.report import make_agent
from sim.app.commands.traps.trial import run_trial
from sim.core.errors import ConfigError
from sim.core.interface import Action
from sim.core.paths import assets_dir
from sim.env.objectnav import ObjectNavEnv
from sim.episodes.splits import load_split
from sim.homes.housegen.splits.recipes import SPLIT_VERSION
from sim.homes.housegen.traps.families.catalogue import CONTACT_SPLITS, FAMILIES, HELD_OUT, TrapKey
from sim.homes.housegen.traps.families.draw import DETOUR_M, MARGIN_M, draw_trap
from sim.homes.housegen.traps.families.family import BLOCKING_M, CLIMBED_M, DIFFICULTIES, ROBOT_M, SPARE_M, Chance
from sim.houses.geoms import data_at_rest, geom_polytope
from sim.houses.labels import collidable_geoms, read_labels
from sim.task.objectnav import Task
from sim.world.world import World
from tests.helpers import wording
from tests.helpers.sampling import sample

SHIPPED = [(split, key) for split, keys in CONTACT_SPLITS.items() for key in keys]
every_split = pytest.mark.parametrize("split", CONTACT_SPLITS)


@pytest.fixture(scope="module")
def oracle_env() -> Iterator[ObjectNavEnv]:
    env = ObjectNavEnv(split="contact-val", sensors=())
    yield env
    env.close()


def name_of(key: TrapKey) -> str:
    return f"{key.family}_{key.difficulty}_{key.seed:02d}"


def test_there_are_twelve_families_of_which_two_are_held_out():
    assert len(FAMILIES) >= 12
    assert HELD_OUT == ("two_panes", "stool_ring")


@every_split
def test_a_split_has_as_many_traps_of_each_family_and_difficulty_and_no_other_families(split: str):
    keys = CONTACT_SPLITS[split]
    counts = collections.Counter((key.family, key.difficulty) for key in keys)
    families = HELD_OUT if split == "contact-heldout" else tuple(name for name in FAMILIES if name not in HELD_OUT)
    assert set(counts) == {(family, difficulty) for family in families for difficulty in DIFFICULTIES}
    assert set(counts.values()) == {10 if split == "contact-heldout" else 5}
    assert {key.family for key in keys[: len(families)]} == set(families)


def test_no_trap_is_in_two_splits():
    assert len({key for _, key in SHIPPED}) == len(SHIPPED) == 360


@every_split
def test_a_shipped_split_has_one_episode_for_each_of_its_traps_in_order(split: str):
    assert [episode.house for episode in load_split(split).episodes] == [name_of(key) for key in CONTACT_SPLITS[split]]


@pytest.mark.parametrize(("split", "key"), sample(SHIPPED, 1))
def test_a_shipped_trap_is_what_its_family_difficulty_and_seed_draw(split: str, key: TrapKey, tmp_path):
    if load_split(split).version != SPLIT_VERSION:
        pytest.skip("the shipped traps are those of another version")
    write_family_trap(tmp_path / "again" / split, key)
    for suffix in ("json", "xml"):
        again = (tmp_path / "again" / split / f"{name_of(key)}.{suffix}").read_text()
        shipped = (assets_dir() / split / f"{name_of(key)}.{suffix}").read_text()
        if suffix == "xml":
            again, shipped = (text[text.index("<default>") :] for text in (again, shipped))
        assert again == shipped


@pytest.mark.parametrize(("split", "key"), sample(SHIPPED, 2))
def test_the_paths_in_a_sidecar_are_those_of_the_scene(split: str, key: TrapKey):
    shipped = load_split(split)
    facts = shipped.sidecar(name_of(key)).trap
    episode = shipped.episode(f"{name_of(key)}_0")
    task = Task(World(shipped.load_house(name_of(key))))
    assert facts is not None
    assert (facts.family, facts.difficulty, facts.seed) == key
    assert task.distance_from(episode.goal, episode.start) == pytest.approx(facts.shortest_path_m, abs=0.002)
    assert facts.shortest_path_m >= facts.open_path_m + DETOUR_M
    assert 0 < facts.fewest_actions <= 200
    assert facts.gap_m >= ROBOT_M + SPARE_M


@pytest.mark.parametrize(("split", "key"), sample(SHIPPED, 6))
def test_no_solid_of_a_trap_is_between_what_is_climbed_and_what_blocks(split: str, key: TrapKey):
    shipped = load_split(split)
    model, goal = shipped.load_house(name_of(key)).spec.compile(), shipped.sidecar(name_of(key)).goal
    data = data_at_rest(model)
    labels = read_labels(model, ignore_prefix="")
    for geom in np.flatnonzero(collidable_geoms(model)).tolist():
        if labels.instances[labels.geom_instance[geom]].category == goal:
            continue  # its feet are farther away than a STOP needs
        heights_m = geom_polytope(model, data, geom).vertices_m[:, 2]
        if heights_m.min() < BLOCKING_M:  # it stands on the floor, or is a floor
            assert not CLIMBED_M + 1e-6 < heights_m.max() < BLOCKING_M, model.geom(geom).name


@pytest.mark.parametrize("family", sample(list(FAMILIES), 1))
def test_the_route_of_a_drawn_trap_leads_through_free_places_to_its_goal(family: str):
    made = draw_trap(family, "hard", 77)
    task = Task(World(made.trap.site.house))
    space, (x_m, y_m) = task.truth.space(), made.route.places_m[-1].tolist()
    assert task.truth.target(made.trap.goal).region.succeeds(x_m, y_m)
    assert len(made.route.actions) == made.facts.fewest_actions
    middles_m = 0.5 * (made.route.places_m[1:] + made.route.places_m[:-1])
    for x, y in (*made.route.places_m.tolist(), *middles_m.tolist()):
        assert space.clearance(x, y) >= space.radius_m + MARGIN_M - 0.001
    assert made.route.actions.count(Action.MOVE_FORWARD) >= made.facts.shortest_path_m / 0.25 - 2


def test_a_harder_trap_has_a_narrower_gap():
    for family, parameters in FAMILIES.items():
        gaps_m = [
            np.mean([parameters.draw(Chance(family, difficulty, seed, 0)).gap_m for seed in range(8)])
            for difficulty in DIFFICULTIES
        ]
        assert gaps_m[0] > gaps_m[1] > gaps_m[2], family


@pytest.mark.parametrize("key", sample(CONTACT_SPLITS["contact-val"], 1))
def test_the_oracle_solves_a_trap(oracle_env: ObjectNavEnv, key: TrapKey):
    episode = oracle_env.split.episode(f"{name_of(key)}_0")
    trial = run_trial(oracle_env, make_agent("oracle", oracle_env), "oracle", episode)
    assert trial.escaped


def test_the_command_writes_the_traps_of_a_family_as_a_split(tmp_path, capsys):
    out = tmp_path / "mine"
    assert main(Args(out=out, family="two_panes", difficulty="easy", seed=30)) == 0
    split = load_split(out)
    assert [episode.episode_id for episode in split.episodes] == ["two_panes_easy_30_0"]
    assert "'two_panes' is held out" in capsys.readouterr().out


def test_an_unknown_family_or_difficulty_is_an_error(tmp_path):
    with pytest.raises(ConfigError, match=r"'glass'\. Available: pane_gap"):
        main(Args(out=tmp_path / "mine", family="glass"))
    with pytest.raises(ConfigError, match=wording.EASY_MEDIUM_HARD):
        draw_trap("pane_gap", "harder", 0)  # pyright: ignore[reportArgumentType]


def test_without_what_is_hidden_a_scene_is_another_one_and_the_scene_is_unchanged():
    made = draw_trap("ledge", "easy", 40)
    before = made.trap.site.spec.to_xml()
    assert made.trap.site.without_hidden().to_xml() != before
    assert made.trap.site.spec.to_xml() == before
