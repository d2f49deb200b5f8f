"""What ends a simulation before its time, and what it keeps."""

import sys
from dataclasses import replace
from typing import Any

import pytest

from schemas.limits import MODEL_LIMITS
from schemas.simulated import SimulationStatus
from schemas.simulations import read_simulation
from solver.simulation import simulate

STEPS = 50
SPRING: dict[str, Any] = {
    "system": {"kind": "ode", "states": ["x", "v"], "derivatives": {"x": "v", "v": "-1e4*x"}},
    "initial": {"x": 1},
    "duration": 100,
}


def test_there_are_only_so_many_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    few = replace(MODEL_LIMITS, simulation_steps=STEPS)
    monkeypatch.setattr(sys.modules[simulate.__module__], "MODEL_LIMITS", few)
    found = simulate(read_simulation(SPRING))
    assert found.status is SimulationStatus.STEP_LIMIT
    assert found.timing.steps == STEPS
    assert f"{STEPS} steps" in found.message
    assert 0 < found.phases[0].knots[-1] < 100
