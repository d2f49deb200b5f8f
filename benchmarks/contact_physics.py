"""What backward Euler's contacts do from nothing: its steps beside those of the discrete gradient.

Run: python -m benchmarks.contact_physics. The same problems by both, each from the same guess; the
books are those of the audit (docs/theory.md), made anew from the published knots and forces.
Seconds are those of the processor, to build and to solve.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

import examples
from benchmarks.aims import Clock
from schemas.problem import Problem
from schemas.reading import read_problem
from schemas.results import Certificate, PhaseResult, Solution, SolutionStatus
from solver import solve
from solver.certificate.case import Case
from solver.certificate.stepped import ContactCase
from solver.certificate.steps import Steps
from solver.numeric import Array
from solver.posing import Posing

DISCRETISATIONS = {"discrete_gradient": "discrete gradient", "backward_euler": "backward Euler"}


@dataclass(frozen=True)
class Trial:
    """An example, and its number of steps."""

    example: str
    segments: int

    @property
    def label(self) -> str:
        """As the table has it."""
        return f"{self.example}, {self.segments} steps"


TRIALS = (
    Trial("stiction_block", 60),
    Trial("finger_no_gravity", 24),
    Trial("finger_no_gravity_two_seconds", 40),
    Trial("spring_flamingo", 20),
    Trial("spring_flamingo", 40),
)


@dataclass(frozen=True)
class Books:
    """What a solution's energy and momentum come to, over all steps.

    Attributes
    ----------
    contacts
        The positive work of contacts, J: none has any to give.
    gained
        What steps gain beyond all work that was done in them, J: the method's own gift.
    actuators
        The work of the actuators, both signs positive, J.
    carried
        Impulses of the ground over those of the weight; None where there is none to carry.
    """

    contacts: float
    gained: float
    actuators: float
    carried: float | None


def main() -> None:
    """Print the table, and which examples are not there."""
    there = set(examples.names())
    print("\nthe same problems by both discretisations; work in J, seconds of the processor")
    print(HEAD)
    for trial in TRIALS:
        if trial.example in there:
            for kind in DISCRETISATIONS:
                print(row(trial, kind), flush=True)
    if missing := {trial.example for trial in TRIALS} - there:
        print(f"NOT MEASURED, not in the gallery: {', '.join(sorted(missing))}")


HEAD = (
    f"{'':46}{'objective':>12}{'contacts':>10}{'nothing':>10}{'actuators':>11}{'impulse/mgT':>13}"
    f"{'iterations':>12}{'seconds':>9}  verdict"
)


def row(trial: Trial, kind: str) -> str:
    """Solve, and tell."""
    document = examples.load(trial.example)
    method = document["method"] | {"segments": trial.segments, "discretisation": kind}
    clock = Clock()
    changed = document | {"method": method, "refinement": None, "known": []}
    problem = read_problem(changed)
    solution = solve(problem, on_event=clock)
    title = f"{trial.label}, {DISCRETISATIONS[kind]}"
    return f"{title:46}{''.join(_cells(problem, solution, clock.seconds))}"


def _cells(problem: Problem, solution: Solution, seconds: float) -> Iterator[str]:
    if solution.objective is None:
        yield f"  {solution.status}"
        return
    found = books(problem, solution.phases, solution.static)
    carried = "-" if found.carried is None else f"{found.carried:.4f}"
    yield f"{solution.objective:12.5g}{found.contacts:10.2g}{found.gained:10.2g}"
    yield f"{found.actuators:11.4g}{carried:>13}"
    yield f"{solution.solver.iterations:12}{seconds:9.1f}  {verdict(solution)}"


def verdict(solution: Solution) -> str:
    """The certificate's, and what failed; of what is no optimum its status."""
    if solution.status not in (SolutionStatus.CONVERGED, SolutionStatus.CERTIFICATE_FAILED):
        return str(solution.status)
    failed = _failed(solution.certificate)
    return f"not certified: {', '.join(failed)}" if failed else "certified"


def _failed(certificate: Certificate) -> list[str]:
    return [check.name for check in certificate.checks if check.judged and not check.passed]


def books(
    problem: Problem,
    phases: Sequence[PhaseResult],
    statics: Mapping[str, float | None] | None = None,
) -> Books:
    """Of all phases through contact, by the audit's own numbers."""
    case = Case.open(Posing.of(problem).judged, phases, None, statics or {})
    return Books(
        contacts=sum(_given(phase) for phase in case.stepped),
        gained=sum(_positive(phase.energies.left) for phase in case.stepped),
        actuators=sum(float(phase.energies.actuators.sum()) for phase in case.stepped),
        carried=_carried(case),
    )


def _given(phase: ContactCase) -> float:
    """The positive work of pushing and of rubbing, J."""
    return _positive(phase.energies.normal) + _positive(phase.energies.friction)


def _positive(works: Array) -> float:
    return float(np.maximum(works, 0.0).sum())


def _carried(case: Case) -> float | None:
    """Normal impulses over weight times time, where there is gravity and one phase in the plane."""
    (phase,) = case.stepped
    steps = phase.steps
    if not isinstance(steps, Steps):
        return None
    parts = steps.model.parts
    weight = float(parts.masses.sum() * abs(parts.gravity))
    pushed = float(np.sum(steps.normal @ steps.lengths))
    return pushed / (weight * phase.duration) if weight else None


if __name__ == "__main__":
    main()
