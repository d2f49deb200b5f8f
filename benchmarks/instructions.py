"""Operations of a floating biped's inverse dynamics and of its derivatives, against the aims.

Run: python -m benchmarks.instructions
"""

import time

import casadi as ca
import numpy as np

from schemas.reading import read_problem
from solver.expressions import evaluate
from solver.lowering import lower

AIMS = {"residual": 320, "stage Jacobian": 1300, "Hessian": 2000}
"""At most so many instructions, common ones counted once."""


def biped() -> dict[str, object]:
    """A trunk that floats, two legs of thigh, shank and foot: nine coordinates, absolute angles."""
    bodies = {"trunk": {"mass": 10, "inertia": 1.2, "com": [0, 0.3]}}
    joints: dict[str, object] = {"free": {"kind": "floating", "child": "trunk"}}
    for side in ("left", "right"):
        above = "trunk"
        for part, mass, at in (("thigh", 5, 0), ("shank", 3, -0.4), ("foot", 1, -0.4)):
            name = f"{part}_{side}"
            com = [0, -0.2] if part != "foot" else [0.05, -0.04]
            bodies[name] = {"mass": mass, "inertia": 0.1 * mass, "com": com}
            hinge = {"kind": "revolute", "parent": above, "child": name, "at": [0, at]}
            joints[f"{name}_hinge"] = hinge
            above = name
    motors = {name: {"joint": name} for name in joints if name != "free"}
    return {
        "kind": "mechanism",
        "angles": "absolute",
        "bodies": bodies,
        "joints": joints,
        "motors": motors,
    }


def functions() -> dict[str, ca.Function]:
    """The residual, its Jacobian, and the Hessian of a contraction."""
    phase = {"system": biped(), "time": {"final": 1}}
    problem = read_problem({"phases": [phase], "method": {"kind": "radau", "segments": 1}})
    form = lower(problem)[0]
    names = [*form.states, *form.algebraic, *form.controls]
    values = ca.SX.sym("values", len(names))
    scope = {name: values[i] for i, name in enumerate(names)}
    for name, tree in form.definitions.items():
        scope[name] = evaluate(tree, scope)
    rows = ca.cse(ca.vertcat(*(evaluate(tree, scope) for tree in form.unknowns[0].residuals)))
    weights = ca.SX.sym("weights", rows.numel())
    hessian, _ = ca.hessian(ca.dot(weights, rows), values)
    made = {
        "residual": rows,
        "stage Jacobian": ca.jacobian(rows, values),
        "Hessian": ca.triu(hessian),
    }
    return {what: ca.Function("f", [values, weights], [ca.cse(one)]) for what, one in made.items()}


def counted() -> dict[str, int]:
    """Instructions of each, with those that read arguments and write results."""
    return {what: function.n_instructions() for what, function in functions().items()}


def seconds(runs: int = 200_000) -> float:
    """Processor time of one evaluation of the residual, as its own buffers give it."""
    function = functions()["residual"]
    buffer, evaluate_it = function.buffer()
    arguments = [np.ones(function.numel_in(i)) for i in range(function.n_in())]
    result = np.zeros(function.numel_out(0))
    for i, argument in enumerate(arguments):
        buffer.set_arg(i, memoryview(argument))  # type: ignore[call-arg,arg-type]
    buffer.set_res(0, memoryview(result))  # type: ignore[call-arg,arg-type]
    began = time.process_time()
    for _ in range(runs):
        evaluate_it()
    return (time.process_time() - began) / runs


def main() -> None:
    """Print the table."""
    found = counted()
    print("\nnine coordinates of a floating biped, instructions")
    for what, most in AIMS.items():
        print(f"{what:20}{found[what]:6}  <= {most}")
    print(f"the residual alone, microseconds: {1e6 * seconds():.2f}  <= 2")


if __name__ == "__main__":
    main()
