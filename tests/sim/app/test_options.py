"""The marks of the options agree with each other, and with what a run records."""

from __future__ import annotations

from sim.app.composition.record import record_of
from sim.app.composition.setup import RunConfig, resolve
from sim.app.options import RunOptions
from sim.core.option_types import meanings

OPTIONS = meanings(RunOptions)


def test_a_run_records_the_options_that_are_marked_so() -> None:
    record = record_of(resolve(RunOptions(agent="random", semantics="gt")), {"name": "val"})
    assert set(OPTIONS) & set(record) - {"config"} == {name for name, option in OPTIONS.items() if option.recorded}


def test_what_changes_no_result_is_not_published_except_for_the_key_of_the_agents_seeds() -> None:
    without_effect = {name for name, option in OPTIONS.items() if option.compared == "never"}
    assert {name for name in without_effect if OPTIONS[name].published} == {"seed_key"}
    assert {name for name, option in OPTIONS.items() if option.viewer} < without_effect


def test_an_option_that_names_a_file_has_a_field_of_the_configuration() -> None:
    parts = {option.file_field.partition(".")[0] for option in OPTIONS.values() if option.file_field}
    assert len(parts) == 3
    assert parts < set(meanings(RunConfig))
