import pytest

from sim.core.errors import ConfigError
from stubborn.planning.standstill import Standstill, StandstillConfig


def steps_until(standstill: Standstill, seen_m2: float) -> int:
    return next(step for step in range(1, 1000) if standstill.observe(seen_m2, felt=False))


def test_it_is_noticed_after_60_steps_without_news_and_then_again():
    standstill = Standstill(StandstillConfig())
    assert not standstill.observe(5.0, felt=False)
    assert [steps_until(standstill, 5.2) for _ in range(2)] == [60, 60]


@pytest.mark.parametrize(("seen_m2", "felt"), [(5.6, False), (5.0, True)])
def test_new_ground_and_a_collision_that_changes_the_map_are_news(seen_m2: float, felt: bool):
    standstill = Standstill(StandstillConfig(patience_steps=10))
    standstill.observe(5.0, felt=False)
    for _ in range(8):
        assert not standstill.observe(5.0, felt=False)
    assert not standstill.observe(seen_m2, felt)
    assert steps_until(standstill, seen_m2) == 10


def test_an_episode_forgets_the_last_one():
    standstill = Standstill(StandstillConfig(patience_steps=2))
    standstill.observe(9.0, felt=False)
    standstill.observe(9.0, felt=False)
    standstill.reset()
    assert [standstill.observe(0.0, felt=False) for _ in range(2)] == [False, True]


def test_patience_is_at_least_one_step():
    with pytest.raises(ConfigError, match="patience_steps"):
        StandstillConfig(patience_steps=0)
