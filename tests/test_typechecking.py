"""Array types are checked under pytest and nowhere else."""

import subprocess
import sys

import numpy as np
import pytest
from jaxtyping import TypeCheckError

from sim.core.geometry.fast_marching import distances


@pytest.mark.parametrize(
    ("sources", "passable"),
    [
        (np.ones((2, 3), bool), np.ones((3, 2), bool)),
        (np.ones((2, 3), np.uint8), np.ones((2, 3), bool)),
        (np.ones(3, bool), np.ones(3, bool)),
    ],
    ids=["shapes differ", "dtype", "axes"],
)
def test_a_wrong_array_is_refused_under_pytest(sources: np.ndarray, passable: np.ndarray) -> None:
    with pytest.raises(TypeCheckError, match=r"Type-check error whilst checking the parameters of .*distances"):
        distances(sources, passable, 0.05)


def test_users_need_no_beartype() -> None:
    code = (
        "import sys, sim.core.geometry.fast_marching, stubborn.detection.verification; print('beartype' in sys.modules)"
    )
    answer = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert answer.stdout.strip() == "False"
