"""The automaton of a mechanism's contacts and limits: open, sticking, sliding, each of them.

Guards, and what they lead to (003, section 6.4.3): a gap closes - impact; a normal force falls
below zero - release; friction leaves its cone - slide; a slip comes to an end - stick or reverse.
Which it is, is always decided for all contacts at once (`settling`).
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from schemas.simulated import EventKind, SimulationEvent, SimulationStatus
from solver.numeric.tape import Array
from solver.simulation.automaton import Flow, Jump, Moment, Stop
from solver.simulation.held import OPEN, SIGN, STICKING, Touch, held
from solver.simulation.instant import Instant
from solver.simulation.settling import Settled, settle
from solver.simulation.unilateral import Unilateral

LOWEST = 1e-14
"""Gaps close here, m. What falls so far stays slower than the escape velocity."""

SINGULAR = 1e-6
"""Below this share the held rows are singular: Painleve's paradox is near."""

PAINLEVE = "no contact forces agree with Coulomb's law at t = {:.9g} s (Painleve's paradox): {}"


class Guard(NamedTuple):
    """What is watched: a word, and the constraint that it is about."""

    kind: str
    contact: int


@dataclass(frozen=True)
class ContactAutomaton:
    """Modes are `held.Touch`; states (2 n,) are coordinates, then velocities.

    Attributes
    ----------
    escape
        What parts slower after an impact stays, m/s (003, section 6.3.1).
    force
        A typical force, N: what falls below zero by 1e-9 of it has done so.
    """

    system: Unilateral
    escape: float
    force: float

    @classmethod
    def of(cls, system: Unilateral, escape: float) -> "ContactAutomaton":
        """With the weight of the mechanism as the typical force."""
        parts = system.multibody.parts
        weight = float(parts.masses.sum() * abs(parts.gravity))
        return cls(system, escape, weight or float(parts.masses.sum()))

    def begin(self, moment: Moment) -> Jump:
        """Settle at the start."""
        return self._jump(None, moment)

    def flow(self, mode: Touch, within: float) -> Flow:
        """Accelerations under the held contacts; guards in the order of `watched`."""
        armed = np.ones(len(watched(mode)), dtype=bool)
        system = self.system.piece(within)

        def rates(time: float, state: Array) -> Array:
            at = system.at(np.array([time]), state[:, None])
            found = held(system, mode, at, system.rows(at))
            return np.concatenate([at.v[:, 0], found.accelerations[:, 0]])

        def guards(times: Array, states: Array) -> Array:
            return self._guards(mode, system.at(times, states))

        return Flow(rates, guards, armed)

    def jump(self, mode: Touch, fired: tuple[int, ...], moment: Moment) -> Jump:
        """Settle anew; where the flow itself became singular, the motion ends."""
        guards = watched(mode)
        if any(guards[one].kind == "regular" for one in fired):
            names = ", ".join(self.system.names[i] for i in mode.sliding)
            message = PAINLEVE.format(moment.time, f"the friction of {names} jams")
            return Jump(mode, moment.state, stop=Stop(SimulationStatus.PAINLEVE, message))
        return self._jump(mode, moment)

    def _jump(self, mode: Touch | None, moment: Moment) -> Jump:
        system = self.system.piece(moment.within)
        found = settle(system, moment, self.escape, mode)
        records = tuple(events(self.system, mode, found, moment.time))
        stop = None
        if not found.solved:
            names = ", ".join(self.system.names[i] for i in found.touching)
            stop = Stop(SimulationStatus.PAINLEVE, PAINLEVE.format(moment.time, names))
        return Jump(found.touch, found.state, records, stop)

    def _guards(self, mode: Touch, at: Instant) -> Array:
        rows = self.system.rows(at)
        forces = held(self.system, mode, at, rows)
        signs = np.array([SIGN.get(word, 0.0) for word in mode.doing])
        values = {
            # Below zero and falling: what has just parted is at zero but for round-off.
            "gap": np.maximum(rows.gaps + LOWEST, rows.rates),
            "force": forces.normal + 1e-9 * self.force,
            "cone_right": self._cone(forces.normal, -forces.tangential),
            "cone_left": self._cone(forces.normal, forces.tangential),
            "slip": rows.slips * signs[:, None] + 1e-11,
            "regular": forces.regular[None] - SINGULAR,
        }
        found = [values[guard.kind][guard.contact] for guard in watched(mode)]
        return np.reshape(found, (len(found), len(at.t)))

    def _cone(self, normal: Array, tangential: Array) -> Array:
        room = self.system.friction[:, None] * normal - tangential
        return np.asarray(room + 1e-9 * self.force)


def watched(mode: Touch) -> list[Guard]:
    """The guards of a mode, in order."""
    found = [Guard("gap", i) for i, word in enumerate(mode.doing) if word == OPEN]
    found += [Guard("force", i) for i in mode.carrying]
    for i in mode.sticking:
        found += [Guard("cone_right", i), Guard("cone_left", i)]
    found += [Guard("slip", i) for i in mode.sliding]
    return found + ([Guard("regular", 0)] if mode.sliding else [])


def events(
    system: Unilateral, before: Touch | None, found: Settled, time: float
) -> list[SimulationEvent]:
    """What to tell of an instant: impacts, then what contacts do now and did not before."""
    told = _impacts(system, found, time)
    struck = {event.name for event in told}
    if before is None:
        return told
    for i, (old, new) in enumerate(zip(before.doing, found.touch.doing, strict=True)):
        kind = _change(old, new, struck=system.names[i] in struck)
        if kind:
            told.append(SimulationEvent(time=time, kind=kind, name=system.names[i]))
    return told


def _impacts(system: Unilateral, found: Settled, time: float) -> list[SimulationEvent]:
    if found.impact is None or found.before is None or found.after is None:
        return []
    return [
        SimulationEvent(
            time=time,
            kind="impact",
            name=system.names[contact],
            normal=float(found.impact.normal[k]),
            tangential=float(found.impact.tangential[k]),
            gap_rate=(float(found.before[k]), float(found.after[k])),
        )
        for k, contact in enumerate(found.touching)
        if found.impact.normal[k] > 0
    ]


def _change(old: str, new: str, *, struck: bool) -> EventKind | None:
    if old == new:
        return None
    if new == OPEN:
        return "lift"
    if old == OPEN:
        return None if struck else "touch"
    return "stick" if new == STICKING else "slip"
