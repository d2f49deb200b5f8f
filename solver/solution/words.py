"""What a result says in words: the message, the advice, the warnings."""

from collections.abc import Iterator, Sequence

import numpy as np

from schemas import resolve
from schemas.corners import corners
from schemas.methods import ContactImplicit
from schemas.problem import Problem
from schemas.remarks import doubtful, folding, untied
from schemas.results import Certificate, PhaseResult, Residual, SolutionStatus
from schemas.stepping import stepping
from solver.meshes import SolvedMesh
from solver.model.build import START
from solver.nlp.redundancy import Redundancy
from solver.solution.choose import choose
from solver.solution.friction import friction_advice

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
    SolutionStatus.COMPLEMENTARITY_STALLED: (
        "Contacts were not brought to strict complementarity; this is the last relaxed solution."
    ),
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
    SolutionStatus.ITERATION_LIMIT: [
        "Raise solver.max_iterations, or give a better guess.",
        "If the objective only keeps falling, something that it rewards lacks a bound.",
    ],
    SolutionStatus.TIME_LIMIT: ["Raise limits.seconds, or start on fewer segments."],
    SolutionStatus.INVALID_NUMBER: [
        "Bound the states and controls to where every expression has a value."
    ],
    SolutionStatus.COMPLEMENTARITY_STALLED: [
        "Give relaxation.schedule more and smaller steps, or choose the form 'inequality'.",
        "Try other guesses ('multistart'), or more segments.",
        "Relaxed contacts push from a distance: check whether the task can be done without that.",
    ],
    SolutionStatus.MESH_LIMIT: [
        "Raise refinement.max_iterations or max_segments, or its tolerance.",
        "Where a control jumps, the error falls slowly: it is the mesh that has to find the jump.",
        "An angle as a control may jump by whole turns between nodes: bound it to one turn.",
    ],
}

_BETWEEN = {"penetration between knots", "slips between knots"}
_COARSE = "Between knots bodies cut corners: take more segments, or switch refinement on."
_BOOKS = {"normal work", "friction work", "limit work", "energy balance"}
_FICTION = "Steps of backward Euler may feed energy in: take discrete_gradient, or shorter steps."
_LOSSY = (
    "Raise refinement.max_iterations, or method.dissipation, the share that may be lost.",
    "Little work leaves little to lose: see the energies in the certificate.",
    "contact_implicit_polished solves the sequence that was found without such losses.",
)

_CORNERED = (SolutionStatus.ACCEPTABLE, SolutionStatus.DIVERGED, SolutionStatus.ITERATION_LIMIT)
_CORNER = (
    "Some expression has corners (see the warnings), at which gradient-based solvers get stuck: "
    'write "nonsmooth": {"abs": "slack"} or {"abs": {"tanh": 0.01}}.'
)
_AT_CORNERS = (
    "Where an absolute value has its corner inside of a segment, the integral is not exact: "
    'write "refinement": {"switches": true}, or lower its tolerance.'
)
_FOREVER = 1e4  # s: seldom meant where nothing limits the time
_ON_BOUND, _MOSTLY = 1e-4, 0.5
_WORDS = 2  # of the name of a user's constraint
_OVERSHOOT = (
    "The control passes its bounds between nodes: use method.control 'linear', or the "
    "trapezoidal method, where a control saturates."
)


def message(
    problem: Problem, status: SolutionStatus, solved: Sequence[SolvedMesh], certificate: Certificate
) -> str:
    """One or two sentences on how the solve ended."""
    text = _MESSAGES[status]
    if status is SolutionStatus.MESH_LIMIT and solved[-1].stepped:
        lost = f"{solved[-1].max_error:.0%}"
        text = f"Outside of impacts steps still lose {lost} of the actuators' work at the finest."
    if status is SolutionStatus.CERTIFICATE_FAILED:
        names = ", ".join(row.name for row in certificate.checks if row.judged and not row.passed)
        text += f" Failed: {names}."
    if choose(problem, solved) is not solved[-1]:
        before, after = (sum(map(len, mesh.errors)) for mesh in solved[-2:])
        ended = f"it ended: {solved[-1].outcome.status.replace('_', ' ')}"
        if solved[-1].optimal:
            ended = "it is less accurate"
        text += f" This is the optimum on {before} segments; on {after} {ended}."
    return text


def advice(
    problem: Problem,
    status: SolutionStatus,
    phases: Sequence[PhaseResult],
    residuals: Sequence[Residual],
    certificate: Certificate,
) -> list[str]:
    """What to try next."""
    lines = list(_ADVICE.get(status, []))
    if status is SolutionStatus.MESH_LIMIT and any(
        isinstance(phase.method, ContactImplicit) for phase in problem.phases
    ):
        lines = list(_LOSSY)
    if status is SolutionStatus.LOCALLY_INFEASIBLE:
        lines = [*_unmet(problem, residuals), *_saturated(problem, phases), *lines]
    elif status is SolutionStatus.COMPLEMENTARITY_STALLED:
        lines = [*_unmet(problem, [row for row in residuals if _meant(row)]), *lines]
    lines += _runaway(problem, phases)
    failed = {row.name for row in certificate.checks if row.judged and not row.passed}
    if status is SolutionStatus.CERTIFICATE_FAILED and "control overshoot" in failed:
        lines.append(_OVERSHOOT)
    if status is SolutionStatus.CERTIFICATE_FAILED and failed & _BETWEEN:
        lines.append(_COARSE)
    if status is SolutionStatus.CERTIFICATE_FAILED and _backward(problem) and failed & _BOOKS:
        lines.append(_FICTION)
    if status in _CORNERED and problem.nonsmooth is None and any(corners(problem)):
        lines.insert(0, _CORNER)
    switches = problem.refinement is not None and problem.refinement.switches
    if status is SolutionStatus.CERTIFICATE_FAILED and problem.nonsmooth and not switches:
        lines += [_AT_CORNERS] if "objective" in failed else []
    return lines


def _unmet(problem: Problem, residuals: Sequence[Residual]) -> Iterator[str]:
    """The worst constraint, and what friction has to do with it."""
    for worst in residuals[:1]:
        yield f"Hardest to meet is {_place(worst)}."
    yield from friction_advice(problem, residuals)


def _meant(row: Residual) -> bool:
    """Whether it is a user's or a friction cone; rows of pairs have long names."""
    return len(row.name.split(" ")) <= _WORDS or row.name.endswith(" cone")


def _backward(problem: Problem) -> bool:
    methods = [phase.method for phase in problem.phases]
    return any(
        isinstance(one, ContactImplicit) and one.discretisation == "backward_euler"
        for one in methods
    )


def _runaway(problem: Problem, phases: Sequence[PhaseResult]) -> Iterator[str]:
    """Free final times, open above, that ended far away: longer is always better there."""
    for spec, phase in zip(problem.phases, phases, strict=True):
        _, latest = resolve.interval(spec.time.final, resolve.parameters(spec.system))
        if np.isinf(latest) and phase.knots[-1] - phase.knots[0] > _FOREVER:
            yield f"The final time ran away to {phase.knots[-1]:.3g} s: bound 'time.final' above."


def _saturated(problem: Problem, phases: Sequence[PhaseResult]) -> Iterator[str]:
    """The controls that sit on their bounds for most of the nodes."""
    for spec, phase in zip(problem.phases, phases, strict=True):
        constants = resolve.parameters(spec.system)
        for name in spec.system.control_names:
            limits = np.array(resolve.interval(spec.bounds.get(name), constants))
            values = np.array(phase.groups["controls"].values[name], dtype=float)
            limits = limits[np.isfinite(limits)]
            near = np.abs(values[:, None] - limits) <= _ON_BOUND * (1 + np.abs(limits))
            share = float(np.mean(near.any(axis=1)))
            if share > _MOSTLY:
                yield f"'{name}' is on its bounds for {share:.0%} of the nodes."


def _place(residual: Residual) -> str:
    phase = f" in phase {residual.phase}" if residual.phase else ""
    time = "" if residual.time is None else f" at t = {residual.time:.4g} s"
    size = "which has no finite value" if residual.value is None else f"by {residual.value:.3g}"
    return f"'{residual.name}'{phase}{time}, {size}"


def warnings(problem: Problem, redundancy: Redundancy) -> list[str]:
    """What works but deserves a look: dropped equalities, functions with kinks."""
    lines = [
        f"'{name}' follows from the other equalities and was dropped."
        for name in redundancy.names
        if not name.startswith(START)
    ]
    lines += [
        f"'{name}' depends on other equalities and may contradict them."
        for name in redundancy.conflicts
    ]
    found = [
        untied(problem),
        folding(problem),
        corners(problem),
        doubtful(problem),
        stepping(problem),
    ]
    return [*lines, *(line for one in found for line in one)]
