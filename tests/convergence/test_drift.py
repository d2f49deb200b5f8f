"""Contacts that are held keep the order of a method."""

import numpy as np
import pytest

from schemas.reading import read_problem
from solver import solve
from tests.unit.hybrid.documents import pendulum


def objective(method: str, segments: int, *, pinned: bool) -> float:
    document = pendulum(pinned=pinned, method={"kind": method, "segments": segments})
    return solve(read_problem(document)).objective or float("nan")


@pytest.mark.parametrize(
    ("method", "order", "meshes"),
    [("hermite_simpson", 4, (5, 10, 20)), ("trapezoidal", 2, (20, 40, 80))],
)
def test_order_of_a_rod_that_is_held(method: str, order: int, meshes: tuple[int, ...]) -> None:
    """Against a fine mesh of the same rod on a hinge."""
    truth = objective("radau", 30, pinned=True)
    errors = [abs(objective(method, n, pinned=False) - truth) for n in meshes]
    slope = -np.polyfit(np.log(meshes), np.log(errors), 1)[0]
    assert slope == pytest.approx(order, abs=0.2)
