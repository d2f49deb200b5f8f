"""What a result says in words: the message, the advice, the warnings."""

from collections.abc import Iterator, Sequence

from schemas.expressions import Expression, warnings_in
from schemas.problem import Problem
from schemas.results import Certificate, Residual, SolutionStatus
from solver.nlp.redundancy import Redundancy
from solver.solve_mesh import SolvedMesh

_MESSAGES = {
    SolutionStatus.CONVERGED: "Optimal (a local minimum), within the mesh tolerance, certified.",
    SolutionStatus.ACCEPTABLE: "The solver stopped close to an optimum, short of its tolerance.",
    SolutionStatus.CERTIFICATE_FAILED: "The solver reports an optimum, but its certificate fails.",
    SolutionStatus.LOCALLY_INFEASIBLE: "No motion near the last iterate meets all constraints.",
    SolutionStatus.DIVERGED: "The iterates diverged.",
    SolutionStatus.UNBOUNDED: "The objective has no lower end: it falls without limit.",
    SolutionStatus.ITERATION_LIMIT: "The iteration limit was reached; this is the best iterate.",
    SolutionStatus.TIME_LIMIT: "The time limit was reached; this is the best iterate.",
    SolutionStatus.CANCELLED: "The solve was stopped; this is the best iterate.",
    SolutionStatus.INVALID_NUMBER: "The model gave no finite number during the solve.",
    SolutionStatus.MESH_LIMIT: "The mesh error is still above the tolerance at the finest mesh.",
}

_ADVICE = {
    SolutionStatus.ACCEPTABLE: [
        "Check units and bounds for numbers of very different sizes, or raise solver.tolerance."
    ],
    SolutionStatus.LOCALLY_INFEASIBLE: [
        "Check whether the limits of the controls and the time allow the motion at all.",
        "Another guess may lead to a feasible motion: infeasibility is local, too.",
    ],
    SolutionStatus.DIVERGED: ["Bound the states and controls, or give a better guess."],
    SolutionStatus.UNBOUNDED: ["Bound what the objective rewards, or add a cost to it."],
    SolutionStatus.ITERATION_LIMIT: ["Raise solver.max_iterations, or give a better guess."],
    SolutionStatus.TIME_LIMIT: ["Raise limits.seconds, or start on fewer segments."],
    SolutionStatus.INVALID_NUMBER: [
        "Bound the states and controls to where every expression has a value."
    ],
    SolutionStatus.MESH_LIMIT: [
        "Raise refinement.max_iterations or max_segments, or its tolerance.",
        "Where a control jumps, the error falls slowly: it is the mesh that has to find the jump.",
    ],
}

_OVERSHOOT = (
    "The control passes its bounds between nodes: use method.control 'linear', or the "
    "trapezoidal method, where a control saturates."
)


def message(status: SolutionStatus, solved: Sequence[SolvedMesh], certificate: Certificate) -> str:
    """One or two sentences on how the solve ended."""
    text = _MESSAGES[status]
    if status is SolutionStatus.CERTIFICATE_FAILED:
        names = ", ".join(row.name for row in certificate.checks if row.judged and not row.passed)
        text += f" Failed: {names}."
    if len(solved) > 1 and not solved[-1].optimal:
        segments = sum(len(errors) for errors in solved[-2].errors)
        text += f" The mesh before, of {segments} segments, was solved to an optimum."
    return text


def advice(
    status: SolutionStatus, residuals: Sequence[Residual], certificate: Certificate
) -> list[str]:
    """What to try next."""
    lines = list(_ADVICE.get(status, []))
    if status is SolutionStatus.LOCALLY_INFEASIBLE and residuals:
        lines.insert(0, f"The constraint violated most is {_place(residuals[0])}.")
    failed = {row.name for row in certificate.checks if row.judged and not row.passed}
    if status is SolutionStatus.CERTIFICATE_FAILED and "control overshoot" in failed:
        lines.append(_OVERSHOOT)
    return lines


def _place(residual: Residual) -> str:
    phase = f" in phase {residual.phase}" if residual.phase else ""
    time = "" if residual.time is None else f" at t = {residual.time:.4g} s"
    return f"'{residual.name}'{phase}{time}, by {residual.value:.3g}"


def warnings(problem: Problem, redundancy: Redundancy) -> list[str]:
    """What works but deserves a look: dropped equalities, functions with kinks."""
    lines = [
        f"'{name}' follows from the other equalities and was dropped." for name in redundancy.names
    ]
    lines += [
        f"'{name}' depends on other equalities but asks for another value: they contradict."
        for name in redundancy.contradictions
    ]
    for place, expression in _expressions(problem):
        lines += [f"{place}: {note}" for note in warnings_in(expression.tree)]
    return lines


def _expressions(problem: Problem) -> Iterator[tuple[str, Expression]]:
    for phase in problem.phases:
        for name, expression in phase.system.define.items():
            yield name, expression
        for name, expression in phase.system.derivatives.items():
            yield f"derivative of {name}", expression
        for name, expression in phase.integrals.items():
            yield f"integral {name}", expression
        for row in [*phase.path, *phase.boundary]:
            yield row.name, row.expression
    if problem.objective is not None:
        yield "objective", problem.objective.minimize
