"""What a house file says about an instance beyond its category: everyday name, colour, material (docs/houses.md).

The file has one MJCF text element for each instance, under `custom`, with the name of the instance:

    <text name="chair_03" data="name: dining chair; colour: red; material: wood"/>

All three are optional, and so is the element: a house without them still works. The text says what most of the visible
surface is; a colour or a material that no one word describes is left out.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import get_args

from sim.core.colours import ColourName
from sim.core.errors import HouseError
from sim.gl import mujoco
from sim.houses.labels import Labels

MATERIAL_NAMES = (
    "wood", "lacquer", "fabric", "leather", "metal", "glass", "stone", "brick", "ceramic", "plastic", "wicker",
    "cardboard", "paper", "rubber",
)  # fmt: skip
"""The words for materials."""
_KEYS = ("name", "colour", "material")


@dataclass(frozen=True)
class InstanceFacts:
    """The everyday name, colour and material of one instance; "" and None: the file does not say."""

    name: str = ""
    """A singular noun in lower case, such as `fridge`."""
    colour: ColourName | None = None
    material: str | None = None
    """One of `MATERIAL_NAMES`."""

    def text(self) -> str:
        """Returns the content of the text element; "" if nothing is known."""
        return "; ".join(f"{key}: {value}" for key in _KEYS if (value := getattr(self, key)))


def read_instance_facts(model: mujoco.MjModel, labels: Labels) -> Mapping[str, InstanceFacts]:
    """Returns the facts of the instances of a compiled house by the names of the instances.

    Args:
        model: the compiled house.
        labels: its labels. Text elements that do not have the name of an instance are ignored.

    Raises:
        HouseError: the text of an instance does not have the form above.
    """
    instances = {instance.name for instance in labels.instances}
    facts = {}
    for number in range(model.ntext):
        name = mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_TEXT, number)
        if name in instances:
            start = int(model.text_adr[number])
            raw = bytes(model.text_data[start : start + int(model.text_size[number])])
            facts[name] = parse_facts(raw.rstrip(b"\0").decode("utf-8", "replace"), name)
    return facts


def parse_facts(text: str, instance: str) -> InstanceFacts:
    """Returns the facts that the text of an instance states.

    Raises:
        HouseError: it has another form, an unknown key, colour or material.
    """
    values: dict[str, str] = {}
    for part in text.split(";"):
        key, colon, value = (piece.strip() for piece in part.partition(":"))
        if not colon or key not in _KEYS or not value or key in values:
            raise HouseError(
                f"the text of instance '{instance}' must look like 'name: dining chair; colour: red; material: wood', "
                f"got '{text[:80]}'."
            )
        values[key] = value
    for key, allowed in (("colour", get_args(ColourName)), ("material", MATERIAL_NAMES)):
        if key in values and values[key] not in allowed:
            raise HouseError(
                f"the text of instance '{instance}' has {key} '{values[key]}'. Available: {', '.join(allowed)}."
            )
    return InstanceFacts(**values)  # type: ignore[arg-type]
