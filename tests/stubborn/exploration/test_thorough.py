import math

import numpy as np
import pytest

from sim.geometry.pose import Pose
from sim.interface import Action, CameraModel
from stubborn.exploration.corners import CornerConfig
from stubborn.exploration.explorer import run_explorer
from stubborn.exploration.glance import GlanceConfig
from stubborn.exploration.thorough import ThoroughConfig, ThoroughExplorer
from stubborn.mapping.navmap import NavMap
from tests.helpers.boxed import FRAME, all_seen, box_in, close_quarter, empty
from tests.helpers.ground import ground, route_of


def explorer(**options: object) -> ThoroughExplorer:
    """Returns an explorer that never looks aside and looks around only on request."""
    given = {"look_around_turns": 0, "glance": GlanceConfig(gain_per_turn_m2=math.inf)} | options
    return ThoroughConfig(**given).make(CameraModel())  # type: ignore[arg-type]


def closed_with_a_patch() -> tuple[NavMap, tuple[slice, slice]]:
    """Returns a closed square of seen ground, and a patch in it that was not seen."""
    navmap = empty()
    box_in(navmap.seen_obstacle, 1.5)
    all_seen(navmap)
    row, col = FRAME.cell(-0.8, 0.3)
    patch = slice(row - 10, row + 11), slice(col - 10, col + 11)
    navmap.frames_in_view[patch] = 0
    return navmap, patch


def test_corners_come_first():
    explore, navmap = explorer(), empty()
    close_quarter(navmap.seen_obstacle, 0)
    route_of(explore, ground(navmap))
    assert explore.corners.corner == 1
    assert explore.destination is None


def test_when_all_four_are_infeasible_ground_that_was_never_in_view_comes_first():
    navmap, patch = closed_with_a_patch()
    route = route_of(explorer(), ground(navmap))
    rows, cols = np.nonzero(route.goal.cells)
    assert np.hypot(rows - patch[0].start - 10, cols - patch[1].start - 10).max() < 12
    patch_too_small = route_of(explorer(unseen_area_m2=(2.0,), unvisited_m=()), ground(navmap))
    assert patch_too_small.goal.cells.sum() == 1


def test_an_unseen_area_is_visited_to_the_end_even_when_a_corner_opens_meanwhile():
    navmap, patch = closed_with_a_patch()
    explore = explorer(corners=CornerConfig(regain_m2=0.5))
    first = route_of(explore, ground(navmap))
    navmap.seen_obstacle[:] = False
    second = route_of(explore, ground(navmap))
    np.testing.assert_array_equal(
        np.argwhere(first.goal.cells).mean(axis=0) - first.frame.cell(0.0, 0.0),
        np.argwhere(second.goal.cells).mean(axis=0) - second.frame.cell(0.0, 0.0),
    )
    navmap.frames_in_view[patch] = 1
    run_explorer(explore, ground(navmap))
    assert explore.destination is None


def test_when_all_was_seen_it_goes_where_it_has_never_been_and_looks_around_there():
    explore, navmap = explorer(look_around_turns=3), empty()
    box_in(navmap.seen_obstacle, 2.0)
    all_seen(navmap)
    (right, behind), (left, ahead) = FRAME.cell(-1.6, -1.6), FRAME.cell(1.6, 0.5)
    navmap.trail[right:left, behind:ahead] = True
    assert [run_explorer(explore, ground(navmap)) for _ in range(3)] == [Action.TURN_LEFT] * 3
    route = route_of(explore, ground(navmap))
    assert explore.destination is not None
    rows, cols = np.nonzero(route.goal.cells)
    x_m, y_m = route.frame.centres(rows, cols)
    assert x_m.min() > 1.6  # the far side from the trail
    there = Pose(float(x_m[0]), float(y_m[0]), 0.0)
    route_of(explore, ground(navmap, there))
    assert run_explorer(explore, ground(navmap, there)) is Action.TURN_LEFT


def test_it_looks_around_at_the_substitute_place_of_a_corner_too():
    explore, navmap = explorer(look_around_turns=1, unvisited_m=()), empty()
    box_in(navmap.seen_obstacle, 1.5)
    all_seen(navmap)
    assert run_explorer(explore, ground(navmap)) is Action.TURN_LEFT
    x_m, y_m = FRAME.centres(*np.argwhere(route_of(explore, ground(navmap)).goal.cells)[0])
    there = Pose(float(x_m), float(y_m), 0.0)
    route_of(explore, ground(navmap, there))
    assert run_explorer(explore, ground(navmap, there)) is Action.TURN_LEFT


@pytest.mark.parametrize("gain_m2", [0.75, math.inf])
def test_it_looks_aside_where_a_turn_shows_much(gain_m2: float):
    explore, navmap = explorer(glance=GlanceConfig(gain_per_turn_m2=gain_m2)), empty()
    choice = run_explorer(explore, ground(navmap))
    assert isinstance(choice, Action) == math.isfinite(gain_m2)


def test_reset_forgets_the_destination_and_the_corner():
    navmap, _ = closed_with_a_patch()
    explore = explorer()
    route_of(explore, ground(navmap))
    assert explore.destination is not None
    explore.reset()
    assert explore.destination is None
    assert explore.corners.corner == 0
