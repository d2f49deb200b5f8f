"""In steps of vanishing length the balance is the equations of motion."""

import numpy as np
import pytest

from schemas.expressions import derivative
from schemas.mechanisms import Mechanism
from solver.numeric.tape import Array
from tests.support import machines
from tests.support.lowered import Lowered
from tests.support.steps import Instance, Steps
from tests.unit.discrete.linkages import four_bar, limited

PAIRS = dict.fromkeys(["rolls", "toe", "heel", "bump", "poke"], "sticking")

MACHINES = {
    "pendulum": machines.double_pendulum(angles="absolute"),
    "springs": machines.chain(),
    "sliders, tendon, motors, forces": machines.crane(),
    "absolute crane": machines.crane(angles="absolute"),
    "loop, losses": four_bar(),
    "stops": limited(),
    "contacts": machines.rolling(mode=PAIRS),
}


def left_out(force: str) -> bool:
    """Far from its edge an egg does not push as its equations do, which have unit normals."""
    return force == "contact.poke.normal"


@pytest.mark.parametrize("name", MACHINES)
def test_small_steps_agree_with_the_equations_to_first_order(name: str) -> None:
    mechanism = MACHINES[name]
    errors = [np.abs(_error(mechanism, h)).max() for h in (1e-3, 1e-4)]
    assert errors[0] < 0.5
    assert errors[1] < 0.12 * errors[0]


def _error(mechanism: Mechanism, h: float) -> Array:
    """Of the balance over h, against the residuals at the end of the step."""
    steps, low = Steps(mechanism), Lowered(mechanism)
    rng = np.random.default_rng(3)
    q, v, a = rng.normal(size=(3, len(mechanism.coordinates)))
    knots = np.array([q + t * v + 0.5 * t * t * a for t in (-2 * h, -h, 0.0)])
    controls = {
        name: 0.0 if left_out(name) else one for name, one in steps.random(7).controls.items()
    }
    one = Instance(knots, h, h, controls)
    found = steps.rows(one)[0] / h
    given = {name: np.array([value]) for name, value in controls.items()} | {"t": np.array([one.t])}
    for i, coordinate in enumerate(mechanism.coordinates):
        for order, values in enumerate((q, v, a)):
            given[derivative(coordinate, order)] = values[[i]]
    for pair in mechanism.touching:
        pulls = (given[f"contact.{pair}#{side}"] for side in ("right", "left"))
        given[f"contact.{pair}.tangential"] = np.subtract(*pulls)
    expected = low([f"#dynamics {name}" for name in mechanism.coordinates], given)[:, 0]
    return np.asarray(found - expected)
