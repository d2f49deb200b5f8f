"""Results made from functions of time, as a perfect engine would publish them."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from footfall.curves import Curves
from schemas.problem import Problem
from schemas.reading import read_problem
from schemas.results import Certificate, CurveGroup, PhaseResult

Array = NDArray[np.float64]
Functions = Mapping[str, Callable[[Array], Array]]

BLOCK: dict[str, Any] = {
    "name": "block",
    "phases": [
        {
            "name": "move",
            "system": {
                "kind": "ode",
                "states": ["x", "v"],
                "controls": ["u"],
                "derivatives": {"x": "v", "v": "u"},
            },
            "time": {"initial": 0, "final": 1},
            "initial": {"x": 0, "v": 0},
            "final": {"x": 1, "v": 0},
            "integrals": {"effort": "u^2"},
        }
    ],
    "objective": {"minimize": "effort"},
}
"""A unit mass moves one metre in a second, at least effort: x = 3 t^2 - 2 t^3, J = 12."""

BLOCK_STATES: Functions = {"x": lambda t: 3 * t**2 - 2 * t**3, "v": lambda t: 6 * t - 6 * t**2}
BLOCK_CONTROLS: Functions = {"u": lambda t: 6 - 12 * t}


def curves(functions: Functions, breaks: Array, degree: int) -> CurveGroup:
    """The interpolants of smooth functions on each segment."""
    nodes = chebyshev.chebpts1(degree + 1)
    times = breaks[:-1, None] + np.diff(breaks)[:, None] * (nodes + 1) / 2
    values = np.stack([np.broadcast_to(f(times), times.shape) for f in functions.values()], axis=2)
    group = Curves.through(list(functions), breaks, nodes, values).to_dict()
    return CurveGroup.model_validate(group)


def result(
    states: Functions, controls: Functions, breaks: Array, degree: int = 3, name: str = "phase"
) -> PhaseResult:
    """The published curves of one phase."""
    groups = {"states": states, "controls": controls}
    return PhaseResult(
        name=name,
        knots=breaks.tolist(),
        groups={},
        curves={
            label: curves(functions, breaks, degree)
            for label, functions in groups.items()
            if functions
        },
    )


def block_problem(**changes: Any) -> Problem:
    """The block's problem, with some fields of its phase replaced; top-level ones by name."""
    top = {key: changes.pop(key) for key in list(changes) if key in Problem.model_fields}
    return read_problem({**BLOCK, "phases": [{**BLOCK["phases"][0], **changes}], **top})


def block_result(segments: int = 4, degree: int = 3) -> PhaseResult:
    """The block's optimal motion."""
    breaks = np.linspace(0.0, 1.0, segments + 1)
    return result(BLOCK_STATES, BLOCK_CONTROLS, breaks, degree, "move")


def altered(
    published: PhaseResult, group: str, name: str, change: Callable[[Array], Array]
) -> PhaseResult:
    """The same result with the coefficients (segments, terms) of one series changed."""
    curve = published.curves[group]
    rows = change(np.array(curve.coefficients[name]))
    coefficients = {**curve.coefficients, name: rows.tolist()}
    curves_ = {**published.curves, group: curve.model_copy(update={"coefficients": coefficients})}
    return published.model_copy(update={"curves": curves_})


def failures(certificate: Certificate) -> dict[str, str | None]:
    """The judged checks that failed, and where; there are some."""
    assert certificate.verdict == "not_certified"
    return {row.name: row.where for row in certificate.checks if row.judged and not row.passed}
