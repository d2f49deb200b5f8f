"""One small job of each kind before the first, so that no fork loads or builds what all need.

What a fork touches first, it pays for: modules imported on first use, the plugins of the NLP
solver, validators built late. Done here once, it is shared by all forks.
"""

import json
import math
from typing import Any

from schemas.reading import read_problem
from schemas.simulations import read_simulation
from worker.attempt import Engines

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

_SWING: dict[str, Any] = {
    "name": "warming up",
    "system": _PENDULUM["phases"][0]["system"],
    "initial": {"q": 1},
    "duration": 0.5,
}


def warm_up(engines: Engines) -> None:
    """Solve a small problem, simulate a small system, and draw the reports."""
    solution = engines.solve(
        read_problem(json.dumps(_PENDULUM)),
        on_event=lambda _: None,
        deadline=None,
        should_stop=lambda: False,
        on_snapshot=lambda _: None,
    )
    engines.render(json.loads(solution.model_dump_json()), _PENDULUM)
    simulated = engines.simulate(
        read_simulation(json.dumps(_SWING)),
        on_event=lambda _: None,
        deadline=math.inf,
        should_stop=lambda: False,
    )
    engines.render(json.loads(simulated.model_dump_json()), _SWING)
