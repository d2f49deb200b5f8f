"""Published curves made by hand: a double integrator with any control."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from footfall.curves import Curves
from schemas.problem import Problem
from schemas.reading import read_problem
from schemas.results import CurveGroup, Group, PhaseResult

Array = NDArray[np.float64]


def problem(**phase: Any) -> Problem:
    """A mass on a line, pushed for two seconds; ``phase`` adds to it."""
    return read_problem(
        {
            "phases": [
                {
                    "name": "move",
                    "system": {
                        "kind": "ode",
                        "parameters": {"most": 1.0},
                        "states": ["x", "v"],
                        "controls": ["u"],
                        "derivatives": {"x": "v", "v": "u"},
                    },
                    "time": {"initial": 0, "final": [0.1, 10]},
                    "bounds": {"u": ["-most", "most"]},
                    "initial": {"x": 0, "v": 0},
                    "final": {"x": 1, "v": 0},
                }
                | phase
            ],
            "objective": {"minimize": "duration"},
        }
    )


def published(
    control: Callable[[Array], Array],
    segments: int = 20,
    state: Callable[[Array], Array] = np.sin,
    name: str = "move",
    span: tuple[float, float] = (0.0, 2.0),
    points: int = 3,
) -> PhaseResult:
    """Polynomials through ``points`` places of each segment, its ends included."""
    knots = np.linspace(*span, segments + 1)
    nodes = np.linspace(-1, 1, points)
    times = knots[:-1, None] + np.diff(knots)[:, None] * (nodes + 1) / 2
    x, u = state(times), control(times)
    series = {"states": {"x": x, "v": 2 * x}, "controls": {"u": u}}
    return PhaseResult(
        name=name,
        knots=knots.tolist(),
        groups={
            group: Group.model_validate(
                {
                    "time": times.ravel().tolist(),
                    "values": {key: values.ravel().tolist() for key, values in columns.items()},
                }
            )
            for group, columns in series.items()
        },
        curves={
            group: CurveGroup.model_validate(
                Curves.through(
                    list(columns), knots, nodes, np.stack(list(columns.values()), axis=2)
                ).to_dict()
            )
            for group, columns in series.items()
        },
        integrals={"effort": float(name == "move")},
    )
