"""A mechanism is read twice, by recursion over trees and by body Jacobians: the two agree."""

from typing import Any

import numpy as np
import pytest

from schemas.expressions import Name, derivative
from schemas.mechanisms import Mechanism
from schemas.problem import Problem
from schemas.reading import read_problem
from solver.certificate.bodies import Bodies
from solver.lowering import Form, lower
from solver.numeric import along, dynamics
from tests.support.machines import cart_pole, chain, crane, double_pendulum, rolling

HEIGHT = "0.2*sin(x) + 0.05*x^2"
MODE = {"toe": "sticking", "rolls": "sliding_right", "bump": "frictionless"}
LOSSES = {"constant": 0.5, "coulomb": 0.1, "viscous": 0.02, "friction": 0.3}
LOOP = {"tie": {"between": [{"body": "first", "at": [0, 1]}, {"body": "third", "at": [0, -1]}]}}

MACHINES: dict[str, Mechanism] = {
    "double_pendulum": double_pendulum(),
    "losses": double_pendulum(
        motors={"m": {"joint": "elbow", "losses": {**LOSSES, "resistance": 1.3, "brush": 0.7}}}
    ),
    "cart_pole": cart_pole(),
    "chain": chain(),
    "crane": crane(),
    "rolling": rolling(),
    "hills": rolling(HEIGHT),
    "held": rolling(mode=MODE),
    "held on hills": rolling(HEIGHT, mode={"toe": "sticking", "rolls": "sliding"}),
    "poked": rolling(mode={"poke": "sliding_left", "rolls": "sticking"}),
    "flat foot": rolling(
        mode={"toe": "sticking", "heel": "sticking"}, loose=["contact.heel.tangential"]
    ),
    "loop": chain(loops=LOOP),
}


@pytest.mark.parametrize("angles", ["relative", "absolute"])
@pytest.mark.parametrize("machine", MACHINES.values(), ids=MACHINES.keys())
def test_rates_and_names_agree(machine: Mechanism, angles: str) -> None:
    system = machine.model_copy(update={"angles": angles})
    problem, names = _posted(system)
    form = lower(problem)[0]
    bodies = Bodies.of(form, problem.phases[0].system, {})  # type: ignore[arg-type]
    assert bodies is not None
    generator = np.random.default_rng(2)
    x, u = (generator.normal(size=(len(some), 6)) for some in (form.states, form.controls))
    t = np.linspace(0, 1, 6)
    found = bodies(t, x, u)
    assert np.all(np.isfinite(found))
    np.testing.assert_allclose(dynamics(form)(t, x, u), found, rtol=1e-7, atol=1e-7)
    trees = [Name(name) for name in names]
    by_form = along(form, trees)(t, x, u)
    by_bodies = bodies.expressions(trees, _refused)(t, x, u)
    for name, one, other in zip(names, by_form, by_bodies, strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-6, atol=1e-7, err_msg=name)


def _posted(system: Mechanism) -> tuple[Problem, list[str]]:
    """A problem in which every name of a mechanism is used, and these names."""
    names = [*system.defined]
    names += [derivative(name) for name in system.defined if name.endswith((".x", ".y", ".gap"))]
    twice = (".x", ".y", ".angle", ".gap")
    names += [derivative(name, 2) for name in system.defined if name.endswith(twice)]
    names += [derivative(name) for name in system.defined if name.endswith(".slip")]
    names = [name for name in names if not name.startswith("loop.") or "(" not in name]
    document: dict[str, Any] = {
        "phases": [
            {
                "system": system.model_dump(mode="json"),
                "time": {"final": 1},
                "integrals": {f"i{row}": name for row, name in enumerate(names[:90])},
                "path": [
                    {"name": f"p{row}", "expression": name, "lower": 0}
                    for row, name in enumerate(names[90:])
                ],
            }
        ],
        "objective": {"minimize": " + ".join(f"i{row}" for row in range(min(len(names), 90)))},
    }
    return read_problem(document), names


def _refused(trees: Any) -> Any:
    assert not trees, trees
    return lambda t, x, u: np.zeros((0, *np.shape(t)))


def test_the_form_is_that_of_the_solver() -> None:
    """What is compared here is what is solved: unknown accelerations and forces."""
    form: Form = lower(_posted(rolling(mode=MODE))[0])[0]
    assert "contact.toe.tangential" in form.algebraic


def test_what_its_bodies_cannot_tell_is_left_to_the_trees() -> None:
    drag = {"joint": "elbow", "value": "-0.1*dd(elbow)"}
    problem, _ = _posted(double_pendulum(torques={"drag": drag}))
    system = problem.phases[0].system
    assert isinstance(system, Mechanism)
    assert Bodies.of(lower(problem)[0], system, {}) is None
    plain, _ = _posted(double_pendulum())
    form = lower(plain)[0]
    bodies = Bodies.of(form, plain.phases[0].system, {})  # type: ignore[arg-type]
    assert bodies is not None
    asked: list[Any] = []

    def others(trees: Any) -> Any:
        asked.extend(trees)
        return along(form, trees)

    trees = [Name("elbow"), Name("d(energy.kinetic)"), Name("upper.dd(x)")]
    values = bodies.expressions(trees[::2], others)
    assert asked == []
    x = np.ones((4, 2))
    assert values(np.zeros(2), x, np.zeros((0, 2))).shape == (2, 2)
    with pytest.raises(KeyError):  # the form of this problem has not been asked for it
        bodies.expressions(trees, others)
    assert asked == [trees[1]]
