"""The smooth simulations of the gallery say of themselves what comes out."""

import math

import examples
from schemas.simulated import SimulationResult, SimulationStatus
from schemas.simulations import read_simulation
from solver.simulation import simulate


def outcome(name: str) -> SimulationResult:
    result = simulate(read_simulation(examples.load(name)))
    assert result.status is SimulationStatus.FINISHED
    return result


def test_the_balanced_pole_comes_to_rest() -> None:
    states = outcome("cart_pole_balance").phases[0].groups["states"].values
    first, last = ({name: row[end] for name, row in states.items()} for end in (0, -1))
    assert math.isclose(float(first["q2"] or 0), math.pi - 0.5)
    assert abs(float(last["q2"] or 0) - math.pi) < 1e-4
    assert abs(float(last["q1"] or 0)) < 1e-3


def test_the_chain_keeps_its_energy_in_flight() -> None:
    result = outcome("chain_in_flight")
    assert result.energy is not None
    assert result.energy.drift is not None
    assert result.energy.drift < 1e-9
    assert result.phases[0].frames is not None
