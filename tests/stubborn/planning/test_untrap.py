import math

import pytest

from sim.core.interface import Action, ConfigError
from stubborn.planning.untrap import Untrap, UntrapConfig

F, L, R = Action.MOVE_FORWARD, Action.TURN_LEFT, Action.TURN_RIGHT


def fail(untrap: Untrap, times: int) -> None:
    for _ in range(times):
        untrap.observe(F, True)


def actions_of(untrap: Untrap, steps: int) -> list[Action | None]:
    """Returns the actions of a robot that never gets free."""
    actions = []
    for _ in range(steps):
        action = untrap.next_action()
        actions.append(action)
        untrap.observe(action, action is F)
    return actions


def test_ten_failed_forwards_start_it_and_nine_do_not():
    untrap = Untrap(UntrapConfig().failed_forwards)
    fail(untrap, 9)
    assert untrap.next_action() is None
    fail(untrap, 1)
    assert untrap.next_action() is L


def test_only_consecutive_failed_forwards_count():
    untrap = Untrap(UntrapConfig().failed_forwards)
    fail(untrap, 9)
    untrap.observe(L, False)
    fail(untrap, 9)
    untrap.observe(L, True)  # a turn that a contact stops changes nothing
    assert not untrap.active
    fail(untrap, 1)
    assert untrap.active
    untrap.observe(L, False)  # the turns of the mode do not end it
    assert untrap.active


def test_turns_between_need_not_reset_the_count_but_a_forward_that_moves_does():
    untrap = Untrap(UntrapConfig().failed_forwards, turns_reset=False)
    for _ in range(9):
        untrap.observe(F, True)
        untrap.observe(L, False)
    assert not untrap.active
    untrap.observe(F, True)
    assert untrap.active
    untrap.observe(F, False)
    fail(untrap, 5)
    untrap.observe(F, False)
    fail(untrap, 9)
    assert not untrap.active
    fail(untrap, 1)
    assert untrap.active


def test_it_turns_and_pushes_until_a_forward_moves():
    untrap = Untrap(UntrapConfig().failed_forwards)
    fail(untrap, 10)
    assert actions_of(untrap, 7) == [L, F, L, F, L, F, L]
    assert untrap.next_action() is F
    untrap.observe(F, False)
    assert untrap.next_action() is None


def test_the_side_alternates_from_entry_to_entry_and_a_new_episode_begins_left():
    untrap = Untrap(UntrapConfig().failed_forwards)
    for side in (L, R, L):
        fail(untrap, 10)
        assert actions_of(untrap, 4) == [side, F, side, F]
        untrap.observe(F, False)
    fail(untrap, 5)
    untrap.reset()
    fail(untrap, 9)
    assert not untrap.active
    fail(untrap, 1)
    assert actions_of(untrap, 2) == [L, F]


def test_a_count_below_one_is_refused():
    with pytest.raises(ConfigError, match=">= 1, got 0"):
        UntrapConfig(failed_forwards=0)


@pytest.mark.parametrize(("blocked", "other"), [(L, R), (R, L)])
def test_two_blocked_turns_start_it_with_a_turn_to_the_other_side(blocked: Action, other: Action):
    untrap = Untrap(UntrapConfig().failed_forwards)
    for action, failed in ((blocked, True), (blocked, False), (blocked, True), (F, False), (blocked, True)):
        untrap.observe(action, failed)
        assert untrap.next_action() is None
    untrap.observe(blocked, True)
    assert [untrap.next_action(), untrap.next_action()] == [other, F]
    untrap.observe(F, False)
    assert untrap.next_action() is None


def test_without_the_mode_blocked_turns_start_nothing():
    untrap = Untrap(math.inf)
    for _ in range(5):
        untrap.observe(L, True)
    assert untrap.next_action() is None
