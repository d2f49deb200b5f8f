"""What pushes in a phase that is stepped through contact: in the plane, and in space."""

import math

from schemas import resolve
from schemas.expressions import Expression, ExpressionError, constant
from schemas.mechanisms import Mechanism
from schemas.methods import ContactImplicit
from schemas.phases import Phase
from schemas.urdf import Urdf
from solver.contact.adding import Forces
from solver.contact.planar import planar_forces
from solver.contact.space import spatial_forces

__all__ = ["Forces", "forces_of", "typical_force"]


def forces_of(phase: Phase, method: ContactImplicit) -> Forces:
    """The forces of a phase that is stepped through contact."""
    system = phase.system
    if isinstance(system, Mechanism):
        return planar_forces(system, method, typical_force(system, phase))
    if isinstance(system, Urdf):
        return spatial_forces(system, method, typical_force(system, phase))
    raise TypeError(f"no contact forces for a {system.kind} system")


def typical_force(system: Mechanism | Urdf, phase: Phase) -> float:
    """The weight; without gravity the largest effort of a motor, or 1, N."""
    constants = resolve.parameters(system)

    def number(expression: Expression) -> float:
        try:
            return constant(expression.tree, constants)
        except ExpressionError:
            return 0.0

    if isinstance(system, Urdf):
        masses = sum(link.mass for link in system.tree.links.values())
    else:
        masses = sum(number(body.mass) for body in system.bodies.values() if body.mass is not None)
    weight = masses * math.hypot(*map(number, system.gravity))
    if weight > 0:
        return weight
    limits = (
        [resolve.interval(motor.torque, constants) for motor in system.motors.values()]
        if isinstance(system, Mechanism)
        else [system.intervals[name] for name in system.control_names if name in system.intervals]
    )
    limits += [resolve.interval(phase.bounds.get(name), constants) for name in system.controls]
    sizes = [max(map(abs, side)) for side in limits]
    return max((size for size in sizes if 0 < size < math.inf), default=1.0)
