"""How far curves leave their limits between the nodes."""

from typing import Any

import numpy as np
import pytest

from footfall.curves import Curves
from schemas.reading import read_problem
from schemas.results import CurveGroup, PhaseResult
from solver.lowering import lower
from solver.refinement.excess import excess

KNOTS = np.array([0.0, 1.0, 2.0])


def found(limits: dict[str, Any], segments: int = 2) -> list[float]:
    """Of x = 1 - (t - 0.5)^2 and u = t over two seconds."""
    phase = {
        "name": "move",
        "system": {
            "kind": "ode",
            "states": ["x"],
            "controls": ["u"],
            "derivatives": {"x": "u"},
            "parameters": {"most": 0.5},
        },
        "time": {"final": 2},
        **limits,
    }
    problem = read_problem({"phases": [phase], "method": {"kind": "trapezoidal"}})
    nodes = np.array([-1.0, 0.0, 1.0])
    times = KNOTS[:-1, None] + (nodes + 1) / 2
    curves = {}
    for group, name, values in (
        ("states", "x", 1 - (times - 0.5) ** 2),
        ("controls", "u", times),
    ):
        made = Curves.through([name], KNOTS, nodes, values[:, :, None])
        curves[group] = CurveGroup.model_validate(made.to_dict())
    result = PhaseResult(name="move", knots=KNOTS.tolist(), groups={}, curves=curves)
    (form,) = lower(problem)
    return excess(problem.phases[0], form, result, {}, segments).tolist()


def test_without_limits_nothing_is_left() -> None:
    assert found({}) == [0, 0]


def test_a_state_that_keeps_its_bound_at_the_knots_alone() -> None:
    """0.75 at both knots of the first segment, 1 between them."""
    np.testing.assert_allclose(found({"bounds": {"x": [None, 0.75]}}), [0.25 / 1.75, 0], atol=1e-12)


def test_controls_and_path_constraints_count_and_the_worst_is_told() -> None:
    limits = {
        "bounds": {"u": [0, "most"]},
        "path": [{"name": "sum", "expression": "x + u", "upper": 2}],
    }
    np.testing.assert_allclose(found(limits), [0.5 / 1.5, 1.5 / 1.5], atol=1e-12)


@pytest.mark.parametrize(("segments", "expected"), [(2, [0, 1 / 2]), (1, [1 / 2])])
def test_pieces_of_one_segment_are_its_own(segments: int, expected: list[float]) -> None:
    assert found({"bounds": {"u": [0, 1]}}, segments) == pytest.approx(expected)
