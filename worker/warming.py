"""One small solve before the first job, so that no fork has to load or build what all need.

What a fork touches first, it pays for: modules imported on first use, the plugins of the NLP
solver, validators built late. Solved here once, it is shared by all forks.
"""

import json
from typing import Any

from schemas.reading import read_problem
from worker.attempt import Engine, Render

_PENDULUM: dict[str, Any] = {
    "name": "warming up",
    "phases": [
        {
            "name": "swing",
            "system": {
                "kind": "ode",
                "states": ["q", "v"],
                "controls": ["u"],
                "derivatives": {"q": "v", "v": "u - sin(q)"},
            },
            "time": {"initial": 0, "final": [0.5, 2]},
            "bounds": {"u": [-5, 5]},
            "path": [{"name": "speed", "expression": "v^2", "upper": 100}],
            "initial": {"q": 0, "v": 0},
            "final": {"q": 1, "v": 0},
            "integrals": {"effort": "u^2"},
        }
    ],
    "objective": {"minimize": "effort"},
    "method": {"kind": "hermite_simpson", "segments": 4},
    "refinement": {"tolerance": 1e-4, "max_iterations": 2},
}


def warm_up(engine: Engine, render: Render) -> None:
    """Solve a small problem and draw its report."""
    solution = engine(
        read_problem(json.dumps(_PENDULUM)),
        on_event=lambda _: None,
        deadline=None,
        should_stop=lambda: False,
        on_snapshot=lambda _: None,
    )
    render(json.loads(solution.model_dump_json()), _PENDULUM)
