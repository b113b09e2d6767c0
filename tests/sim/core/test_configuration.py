"""Settings are set by their path and checked by their dataclass, and an unknown name lists the valid ones."""

from __future__ import annotations

import codecs
import json
import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

import pytest

from sim.core.configuration import as_json, assignments_of, field_paths, parse_assignments, read_settings, with_fields
from sim.core.errors import ConfigError


@dataclass(frozen=True, kw_only=True)
class Leg:
    length_m: float = 1.0
    count: int = 4
    shape: Literal["round", "square"] = "round"

    def __post_init__(self) -> None:
        if self.length_m <= 0:
            raise ConfigError(f"Leg.length_m must be > 0 m, got {self.length_m}.")


@dataclass(frozen=True, kw_only=True)
class Table:
    legs: Leg = field(default_factory=Leg)
    sizes_m: tuple[float, ...] = (0.5, 1.0)
    cost: float = math.inf
    top: str | None = None


def test_a_field_is_set_by_its_path_and_the_tree_it_came_from_is_unchanged() -> None:
    table = Table()
    changed = with_fields(table, {"legs.length_m": "0.5", "legs.count": 3, "sizes_m": [1, 2], "top": "oak"})
    assert changed == Table(legs=Leg(length_m=0.5, count=3), sizes_m=(1.0, 2.0), top="oak")
    assert table == Table()


def test_all_fields_have_a_path_and_each_can_be_set_to_its_own_value() -> None:
    table = Table()
    assert field_paths(table) == ["legs.length_m", "legs.count", "legs.shape", "sizes_m", "cost", "top"]
    content = as_json(table)
    assert content["cost"] == "inf"
    json.dumps(content, allow_nan=False)
    values = {"legs.length_m": 1.0, "legs.count": 4, "legs.shape": "round", "sizes_m": [0.5, 1.0], "cost": "inf"}
    assert with_fields(table, values | {"top": None}) == table


@pytest.mark.parametrize(
    ("values", "message"),
    [
        (
            {"legs.lenght_m": 1},
            r"no field 'legs.lenght_m'. Did you mean 'length_m'\? 'legs' has: length_m, count, shape",
        ),
        ({"chair": 1}, r"'chair'.*sizes_m"),
        ({"length_m": 1}, r"no field 'length_m'. Did you mean 'legs.length_m'\? The configuration has: legs"),
        ({"legs.length_m": -1}, r"legs.length_m: Leg.length_m must be > 0 m, got -1"),
        ({"legs.count": "many"}, "'legs.count' cannot be 'many'"),
        ({"legs.shape": "oval"}, "'legs.shape' cannot be 'oval'"),
        ({"legs": 3}, r"'legs'.*length_m"),
        ({"sizes_m.first": 3}, "'sizes_m' cannot be"),
        ({"legs.length_m": "nan"}, r"'legs.length_m'.*'nan'.*1e[+]09"),
        ({"legs.length_m": "inf"}, "'legs.length_m' cannot be 'inf'"),
        ({"legs.length_m": 1e308}, "'legs.length_m' cannot be 1e[+]308"),
        ({"sizes_m": [0.5, float("nan")]}, "'sizes_m' cannot be"),
        ({"legs.count": 3, "legs": 3}, "'legs' is set, and so is a field in it"),
        ({"legs": 3, "legs.count": 3}, "'legs.count' is set, and so is a field that contains it"),
    ],
)
def test_a_field_that_cannot_be_set_is_refused_by_name(values: dict[str, object], message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        with_fields(Table(), values)


def test_a_group_and_a_field_in_it_are_both_set_in_any_order() -> None:
    given = {"count": 3}
    expected = Table(legs=Leg(length_m=0.5, count=3))
    assert with_fields(Table(), {"legs": given, "legs.length_m": 0.5}) == expected
    assert with_fields(Table(), {"legs.length_m": 0.5, "legs": given}) == expected
    assert given == {"count": 3}
    assert with_fields(Table(), {"legs.count": 2, "legs": given}).legs.count == 3  # the later one counts


def test_assignments_are_read_as_json_where_they_are_json() -> None:
    assert parse_assignments(["a.b=0.5", "c=[1, 2]", "d=text", "e=null", "f=x=y"]) == {
        "a.b": 0.5,
        "c": [1, 2],
        "d": "text",
        "e": None,
        "f": "x=y",
    }
    for wrong, message in ((["a"], "FIELD=VALUE"), (["=3"], "FIELD=VALUE"), (["a=1", "a=2"], "'a' twice")):
        with pytest.raises(ConfigError, match=message):
            parse_assignments(wrong)


@pytest.mark.parametrize("value", ["text", "a b=c", "7", "true", '"quoted"', "[1", "", 0.5, None, [1, "a"], {"b": 1}])
def test_assignments_give_their_values_back(value: object) -> None:
    assert parse_assignments(assignments_of({"a.b": value})) == {"a.b": value}


def test_a_file_of_settings_may_be_toml_or_json(tmp_path: Path) -> None:
    toml, nested = tmp_path / "a.toml", tmp_path / "a.json"
    toml.write_text('top = "oak"\n[legs]\nlength_m = 0.5\n')
    nested.write_text('{"legs": {"length_m": 0.5}, "top": "oak"}')
    assert read_settings(toml) == read_settings(nested) == {"legs.length_m": 0.5, "top": "oak"}
    marked = tmp_path / "b.TOML"  # as Windows programs write it
    marked.write_bytes(codecs.BOM_UTF8 + toml.read_bytes())
    assert read_settings(marked) == read_settings(toml)
    for content in ("[1]", "{", "\x00", "[" * 9999, '{"a": ' * 9999, '{"a": NaN}'):
        nested.write_text(content)
        with pytest.raises(ConfigError, match=r"a\.json"):
            read_settings(nested)
    toml.write_text(f"a = {'[' * 9999}")
    with pytest.raises(ConfigError, match=r"a\.toml"):
        read_settings(toml)
    with pytest.raises(ConfigError, match="No such file"):
        read_settings(tmp_path / "none.toml")
