"""What a solver takes of a step: derivatives without holes, and not too many operations."""

import casadi as ca
import numpy as np
import pytest

from benchmarks.instructions import biped
from schemas.mechanisms import Mechanism
from solver.expressions import SX
from tests.support import machines
from tests.support.steps import Steps
from tests.unit.discrete.linkages import four_bar, limited

AIMS = {"rows": 600, "Jacobian": 2600, "Hessian": 6200}
"""At most so many instructions of a floating biped with nine coordinates."""

MACHINES = {
    "springs": machines.chain(),
    "tendon": machines.crane(),
    "loop": four_bar(),
    "stops": limited(),
    "contacts": machines.rolling(height="0.2*sin(3*x)"),
}


def derivatives(mechanism: Mechanism) -> tuple[list[SX], dict[str, SX]]:
    """Rows, Jacobian and Hessian of a contraction, over everything that a step is made of."""
    steps = Steps(mechanism)
    inputs = [SX.sym("part", *steps.function.size_in(i)) for i in range(steps.function.n_in())]
    found = steps.function.call(inputs)
    rows = ca.cse(ca.vertcat(found[0], found[1]))
    weights = SX.sym("weights", rows.numel())
    every = ca.vertcat(*inputs)
    hessian = ca.hessian(ca.dot(weights, rows), every)[0]
    made = {"rows": rows, "Jacobian": ca.jacobian(rows, every), "Hessian": ca.triu(hessian)}
    return [every, weights], made


def test_a_biped_stays_within_its_counts() -> None:
    inputs, made = derivatives(Mechanism.model_validate(biped()))
    for what, most in AIMS.items():
        function = ca.Function("f", inputs, [ca.cse(made[what])])
        assert 50 < function.n_instructions() <= most, what


@pytest.mark.parametrize("name", MACHINES)
def test_steps_at_rest_and_of_no_length_have_derivatives(name: str) -> None:
    """Where guesses are: nothing moves, and before the first step there is none."""
    inputs, made = derivatives(MACHINES[name])
    function = ca.Function("f", inputs, [*made.values()])
    count = len(MACHINES[name].coordinates)
    rng = np.random.default_rng(0)
    q, zero = rng.normal(size=count), np.zeros(count)
    rest = inputs[0].numel() - 4 * count - 3
    for step in (0.0, 1e-9, 1e-4):
        for before in (0.0, 0.1):
            start = [*q, *zero, *(q + step), *(zero + step / 0.1), 0.1, before, 0.0, *np.ones(rest)]
            found = function(start, rng.normal(size=inputs[1].numel()))
            assert all(np.isfinite(np.array(one)).all() for one in found)
