"""What the author of a contact-implicit problem may want to know before it is solved."""

import math
from collections.abc import Iterator

from schemas.checks.contact_implicit import Stepped, stepped_phases
from schemas.checks.contact_points import redundant
from schemas.checks.masses import Numbers
from schemas.mechanisms import Mechanism, Prismatic, Revolute
from schemas.pointers import pointer
from schemas.problem import Problem
from schemas.urdf import Urdf

_LONG = 0.25
"""s; a body falls 0.3 m in the meantime."""


def stepping(problem: Problem) -> Iterator[str]:
    """On phases in which nothing touches, forces that are not unique, steps that are long."""
    for one in stepped_phases(problem):
        yield from _untouched(one)
        yield from _shared(one)
        yield from _long(one)


def _untouched(one: Stepped) -> Iterator[str]:
    system = one.phase.system
    if not isinstance(system, Mechanism | Urdf) or system.touching:
        return
    if isinstance(system, Mechanism):
        joints = system.joints.values()
        stops = any(isinstance(j, Revolute | Prismatic) and j.limits is not None for j in joints)
        if system.loops or (stops and one.steps.stops):
            return
    yield (
        f"{pointer(*one.own)}: nothing touches or stops in the phase '{one.phase.name}': "
        "collocation, such as hermite_simpson, is more accurate there"
    )


def _shared(one: Stepped) -> Iterator[str]:
    system = one.phase.system
    if isinstance(system, Mechanism | Urdf):
        numbers = Numbers.of(one.phase, int(one.place[1]))
        for against, body, names in redundant(system, numbers):
            some = "', '".join(names[:-1]) + f"' and '{names[-1]}"
            yield (
                f"{numbers.at('contacts', names[-1])}: '{some}' bear the load of '{body}' on "
                f"'{against}' in more than one way; the forces of a result are one of many, their "
                "sum and what it turns are not"
            )


def _long(one: Stepped) -> Iterator[str]:
    """Steps that are long even where the phase is as short as it may be."""
    if one.lasting is None or not math.isfinite(one.lasting[0]):
        return
    step = one.lasting[0] / one.steps.segments
    if step > _LONG:
        yield (
            f"{pointer(*one.settings, 'segments')}: steps of {step:.3g} s, in which a body falls "
            f"{9.81 * step**2 / 2:.2g} m: impacts take energy by the step, so take more segments"
        )
