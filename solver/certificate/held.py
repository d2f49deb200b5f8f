"""Do contacts that touch stay in touch, and loops closed? By the judge's own kinematics."""

import numpy as np

from schemas.results import Check
from solver.certificate.case import Case, PhaseCase
from solver.certificate.findings import Finding, judge, worst_sample
from solver.numeric import Array
from solver.simulation.instant import Instant
from solver.simulation.multibody import Multibody

SLIDES = {"sliding_right": -1.0, "sliding_left": 1.0}
"""The side of a slip, m/s, that is against its mode."""


def contacts_and_loops(case: Case) -> Check | None:
    """The largest gap, slip or opening of what a mode or a loop holds, in m and m/s.

    All of them are to be zero; a contact that slides only slips to its own side.
    """
    findings = [finding for phase in case.curved for finding in _of_phase(phase)]
    return judge("contacts and loops", findings, case.constraint_tolerance)


def _of_phase(phase: PhaseCase) -> list[Finding]:
    model = phase.bodies.model if phase.bodies else None
    if phase.bodies is None or not isinstance(model, Multibody):
        return []
    now = phase.samples
    motion = phase.bodies.motion(now.x, now.u)
    rows = _off(model, model.at(now.t, motion.q, motion.v))
    if not rows:
        return []
    return [worst_sample(phase.name, list(rows), now.t, np.array(list(rows.values())))]


def _off(model: Multibody, at: Instant) -> dict[str, Array]:
    """By how much each held quantity is off."""
    rows: dict[str, Array] = {}
    for name, doing in model.mechanism.mode.items():
        pair = model.pairs.index(name)
        rows[f"contact.{name}.gap"] = np.abs(at.contacts.gaps[pair])
        slip = at.contacts.slips[pair]
        if doing == "sticking":
            rows[f"contact.{name}.slip"] = np.abs(slip)
        elif doing in SLIDES:
            rows[f"contact.{name}.slip"] = np.maximum(SLIDES[doing] * slip, 0.0)
    for row, name in enumerate(model.mechanism.loops):
        rows[f"loop {name}"] = np.abs(at.loops.z[row])
    return rows
