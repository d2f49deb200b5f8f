"""The audit of contact-implicit steps: low residuals of a program are no honest physics.

Everything is computed from the knots and forces that were published, by the simulator's own
mechanics. Energies are compared with the weight over a length of the mechanism.
"""

from collections.abc import Callable, Iterable, Sequence

import numpy as np

from schemas.results import Check
from solver.certificate.case import Case
from solver.certificate.findings import Finding, judge, worst_sample
from solver.certificate.stepped import ContactCase
from solver.certificate.steps import Steps
from solver.numeric import Array

ENERGY = 1e-6
"""Of the scale of energies: work that a contact may feed in, and what the books may leave open."""

COMPLEMENTARY = 1e-6
"""Gaps, m, slips, m/s, and forces over the weight: the smaller one of two."""

DEPTH = 1e-6
"""How deep contacts and limits may be at knots, m or rad; as far as loops may be open."""

BETWEEN = 5e-3
"""How deep contacts may be between knots, and what slips may be off there, m."""

FAINT = 1e-3
"""Of the weight: contacts that push less are not asked for their slips."""

LOOKS = np.arange(1, 16) / 16
"""Where between knots gaps are looked at."""

Found = Callable[[ContactCase], Iterable[Finding]]


def step_velocities(case: Case) -> Check | None:
    """Velocities at the knots against those of the steps that end there."""

    def look(phase: ContactCase) -> Iterable[Finding]:
        steps = phase.steps
        off = np.abs(steps.published.v[:, 1:] - steps.chords)
        sizes = off / (1 + np.abs(steps.chords).max(axis=1, keepdims=True))
        yield _worst(phase, steps.model.coordinates, sizes)

    return judge("step velocities", _all(case, look), COMPLEMENTARY)


def normal_work(case: Case) -> Check | None:
    """What contacts feed in by pushing while they part, over all steps."""
    return _fed("normal work", case, lambda phase: (_pairs(phase), phase.energies.normal))


def friction_work(case: Case) -> Check | None:
    """What friction feeds in, over all steps."""
    return _fed("friction work", case, lambda phase: (_pairs(phase), phase.energies.friction))


def limit_work(case: Case) -> Check | None:
    """What the limits of joints feed in, over all steps."""
    return _fed("limit work", case, lambda one: (one.steps.stops.names, one.energies.stops))


def energy_balance(case: Case) -> Check | None:
    """What the books of energy leave open in a step."""

    def look(phase: ContactCase) -> Iterable[Finding]:
        yield _worst(phase, ["energy"], np.abs(phase.energies.left)[None] / phase.scale)

    return judge("energy balance", _all(case, look), ENERGY)


def complementarity(case: Case) -> Check | None:
    """Contacts push where they touch, friction is opposed to slip and within its cone."""

    def look(phase: ContactCase) -> Iterable[Finding]:
        sizes = phase.laws
        if sizes:
            yield _worst(phase, list(sizes), np.array(list(sizes.values())))

    return judge("complementarity", _all(case, look), COMPLEMENTARY, unit="SI")


def penetration(case: Case) -> Check | None:
    """How deep contacts are inside of things, and joints beyond their limits, at the knots."""

    def look(phase: ContactCase) -> Iterable[Finding]:
        steps = phase.steps
        depths = np.maximum(-np.concatenate([steps.gaps, steps.rooms]), 0.0)
        if len(depths):
            names = [*_pairs(phase), *steps.stops.names]
            yield worst_sample(phase.name, names, steps.published.knots, depths)

    return judge("penetration at knots", _all(case, look), DEPTH, unit="m, rad")


def tunnelling(case: Case) -> Check | None:
    """The same of contacts between the knots, on the straight way of each step."""

    def look(phase: ContactCase) -> Iterable[Finding]:
        if names := _pairs(phase):
            times, gaps = phase.steps.gaps_between(LOOKS)
            yield worst_sample(phase.name, names, times, np.maximum(-gaps, 0.0))

    return judge("penetration between knots", _all(case, look), BETWEEN, unit="m")


def slips_between(case: Case) -> Check | None:
    """What the slip by the ends of a step differs by from the way of the touching matter in it.

    By the simulator's tangents, along the straight way, where a contact pushes: no audit of work
    sees friction along a wrong tangent.
    """

    def look(phase: ContactCase) -> Iterable[Finding]:
        steps = phase.steps
        if names := _pairs(phase):
            pushes, off = steps.pressing > FAINT, steps.strayed
            yield _worst(phase, names, np.where(pushes | np.isnan(off), off, 0.0))

    return judge("slips between knots", _all(case, look), BETWEEN, unit="m")


def closed_loops(case: Case) -> Check | None:
    """How far loops are open at the knots."""

    def look(phase: ContactCase) -> Iterable[Finding]:
        steps = phase.steps
        if not isinstance(steps, Steps):
            return
        if names := [f"loop {name}" for name in steps.model.parts.loop_names]:
            yield worst_sample(
                phase.name, names, steps.published.knots, np.abs(steps.knots.loops.z)
            )

    return judge("loops at knots", _all(case, look), DEPTH, unit="m")


def _fed(
    name: str, case: Case, works: Callable[[ContactCase], tuple[Sequence[str], Array]]
) -> Check | None:
    """The positive part of works (names, N), summed; its place is that of the largest one."""

    def look(phase: ContactCase) -> Iterable[Finding]:
        names, values = works(phase)
        if len(names):
            gains = np.maximum(values, 0.0) / phase.scale
            yield Finding(float(gains.sum()), _worst(phase, names, gains).where)

    return judge(name, _all(case, look), ENERGY)


def _all(case: Case, look: Found) -> list[Finding]:
    return [finding for phase in case.stepped for finding in look(phase)]


def _worst(phase: ContactCase, names: Sequence[str], sizes: Array) -> Finding:
    """Of sizes (names, N) of the steps; told by the time at which the step ends."""
    return worst_sample(phase.name, names, phase.steps.ends, sizes)


def _pairs(phase: ContactCase) -> list[str]:
    return [f"contact {name}" for name in phase.steps.pairs]
