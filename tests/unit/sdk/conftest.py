"""The cart-pole, really solved, once for all tests of the SDK."""

from typing import Any

import pytest

import examples
from footfall import local


@pytest.fixture(scope="session")
def problem() -> dict[str, Any]:
    return examples.load("cart_pole")


@pytest.fixture(scope="session")
def solved(problem: dict[str, Any]) -> dict[str, Any]:
    return local.solve(problem).document


@pytest.fixture(scope="session")
def infeasible() -> dict[str, Any]:
    return local.solve(infeasible_problem()).document


def infeasible_problem() -> dict[str, Any]:
    """A block of one kilogram that cannot be moved by a metre in a second with 3 N."""
    problem = examples.load("block_min_force")
    control = problem["phases"][0]["system"]["controls"][0]
    problem["phases"][0].setdefault("bounds", {})[control] = [-3, 3]
    return problem
