"""Which phases are stepped through contact: one answer for checks, engine and judge."""

from schemas.mechanisms import Mechanism
from schemas.methods import ContactImplicit
from schemas.phases import Phase
from schemas.problem import Problem
from schemas.urdf import Urdf


def stepped_by(problem: Problem, phase: Phase) -> ContactImplicit | None:
    """The contact-implicit method of a phase; None where it has another, or nothing can touch.

    A formula, or a system of equations, is no body: the problem's method is not for it.
    """
    method = phase.method or problem.method
    bodies = isinstance(phase.system, Mechanism | Urdf)
    return method if bodies and isinstance(method, ContactImplicit) else None
