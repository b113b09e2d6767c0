"""Hazard sites, and paths that lead past them."""

from __future__ import annotations

import numpy as np

from sim.core.geometry.descent_kernels import descend
from sim.gl import mujoco
from sim.houses.hazards import Hazard, read_hazards

XML = """
<mujoco><worldbody>
  <site name="hazard_glass_03" type="box" group="4" pos="1 2 1" size="0.5 0.1 1"/>
  <site name="room_office_00" type="box" group="4" pos="0 0 1" size="3 3 1"/>
</worldbody></mujoco>
"""


def test_hazard_sites_are_read_and_other_sites_are_not() -> None:
    hazards = read_hazards(mujoco.MjModel.from_xml_string(XML))
    assert [(h.name, h.kind) for h in hazards] == [("hazard_glass_03", "glass")]
    assert np.allclose(hazards[0].low_m, (0.5, 1.9, 0.0))
    assert np.allclose(hazards[0].high_m, (1.5, 2.1, 2.0))


def test_the_distance_to_a_hazard_is_measured_in_plan() -> None:
    hazard = Hazard("hazard_slab_00", "slab", (0.0, 0.0, 0.0), (1.0, 1.0, 2.0))
    assert hazard.distance_m(np.array([[5.0, 0.5], [4.0, 5.0], [0.5, 3.0], [0.5, 0.5]])).tolist() == [
        4.0,
        5.0,
        2.0,
        0.0,
    ]


def test_the_steepest_path_leads_around_a_wall_to_the_source() -> None:
    field = np.array([[3, 2, 1], [4, np.inf, 0], [5, np.inf, np.inf]], dtype=np.float32)
    assert descend(field, 2, 0).tolist() == [[2, 0], [1, 0], [0, 1], [1, 2]]
    assert descend(field, 1, 2).tolist() == [[1, 2]]
