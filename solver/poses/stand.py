"""Whether a mechanism can stand as it is asked to: loops closed, contacts in place, ends met.

What bounds and names cannot tell is found here, by damped least squares over the coordinates: a
pose within their limits at which every loop closes, contacts that touch do, those that do not are
clear of each other, and places given for an end are reached.
"""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from schemas import resolve
from schemas.errors import Issue
from schemas.expressions import stem
from schemas.expressions.names import MAX_ORDER
from schemas.phases import Phase
from schemas.pointers import Part, pointer
from solver.numeric.tape import Array
from solver.poses.search import REACHED, VALUELESS, Found, Search
from solver.poses.tapes import Tapes

_SHOWN, _PLACES = 8, 9
SPLIT = "split"
"""The mode of a contact that may touch or not (``solver.contact``)."""

INSIDE = 1e-6
"""M; so deep may a given pose be, which is rounding."""

VERBS = {"initial": "starts", "final": "ends"}
"""What happens at each end."""


class Demand(NamedTuple):
    """``lower <= name <= upper``, of a definition over coordinates; where and how to blame it."""

    name: str
    lower: float
    upper: float
    parts: tuple[Part, ...]
    wrong: str
    enough: float = REACHED


def check_poses(
    tapes: Tapes, phase: Phase, index: int, *, stepped: bool = False
) -> Iterator[Issue]:
    """An issue for the first end of a mechanism's phase that no pose can have.

    Of a phase that is ``stepped`` through contact both ends are clear of all that may be touched,
    and joints are within their limits there.
    """
    posing = _Posing(tapes, phase, index, stepped=stepped)
    for end in ("initial", "final"):
        issue = posing.issue(end)
        if issue is not None:
            yield issue
            return


class _Posing:
    """One phase's mechanism, its demands put to numbers."""

    def __init__(self, tapes: Tapes, phase: Phase, index: int, *, stepped: bool) -> None:
        self.tapes, self.phase, self.index, self.stepped = tapes, phase, index, stepped
        self.system, self.constants = tapes.system, tapes.constants
        self.names = self.system.coordinates

    def issue(self, end: str) -> Issue | None:
        """What is wrong with an end, if anything is."""
        demands = list(self._demands(end))
        if not demands:
            return None
        limits = np.array([(one.lower, one.upper) for one in demands])
        tape = self.tapes.tape([one.name for one in demands])
        search = Search(self.tapes, tape, limits[:, 0], limits[:, 1])
        given = self._box(end)
        found = search.best(given)
        enough = np.array([one.enough for one in demands])
        if bool((np.abs(found.missed) <= enough).all()):
            return None
        nearest = search.best(self._box(None), found.pose)
        return self._issue(demands, found, nearest)

    def _issue(self, demands: Sequence[Demand], found: Found, nearest: Found) -> Issue:
        shares = [abs(by) / one.enough for by, one in zip(found.missed, demands, strict=True)]
        demand = demands[int(np.argmax(shares))]
        together = [one.wrong == demand.wrong for one in demands]  # x and y of one loop
        size = np.linalg.norm(found.missed[together])
        hint = f"nearest within the limits of the joints: {self._shown(nearest.pose)}"
        if nearest.worst > REACHED:
            hint = f"the closest pose is {self._shown(found.pose)}"
        where = pointer("phases", self.index, *demand.parts)
        if found.worst >= VALUELESS:
            return Issue(where, f"'{demand.name}' has no finite value there", hint)
        return Issue(where, demand.wrong.format(size=f"{size:.4g}"), hint)

    def _shown(self, pose: Array) -> str:
        digits = ".7g" if self.stepped else ".4g"  # rounding must not push it back in
        clean = (round(float(value), _PLACES) + 0.0 for value in pose)
        pairs = [
            f"{name} = {value:{digits}}" for name, value in zip(self.names, clean, strict=True)
        ]
        return ", ".join(pairs[:_SHOWN]) + (", ..." if len(pairs) > _SHOWN else "")

    def _box(self, end: str | None) -> tuple[Array, Array]:
        """Limits of the coordinates; at an end with what is given there."""
        lower, upper = [], []
        for name in self.names:
            limits = resolve.interval(self.phase.bounds.get(name), self.constants)
            if end is not None:
                given = resolve.interval(getattr(self.phase, end).get(name), self.constants)
                limits = max(limits[0], given[0]), min(limits[1], given[1])
            lower.append(limits[0])
            upper.append(max(limits))
        return np.array(lower), np.array(upper)

    def _demands(self, end: str) -> Iterator[Demand]:
        for name in self.system.loops:
            wrong = f"no pose closes the loop '{name}': {{size}} m stay open"
            for word in ("x", "y"):
                yield Demand(f"loop.{name}#{word}", 0, 0, ("system", "loops", name), wrong)
        if self.stepped:
            yield from self._clear(end)
            yield from self._stopped()
        elif end == "initial":
            yield from self._gaps()
        for name, bound in getattr(self.phase, end).items():
            if self.system.defined.get(name) == MAX_ORDER and stem(name)[0] == 0:
                limits = resolve.interval(bound, self.constants)
                yield Demand(name, *limits, (end, name), f"'{name}' misses this by {{size}}")

    def _gaps(self) -> Iterator[Demand]:
        """Contacts that touch at the start; of those that do not, that they are clear of it.

        The latter where nothing of the pose is free: else there is more than one to judge.
        """
        lower, upper = self._box("initial")
        given = bool(np.all(lower == upper))
        for name, pair in self.system.touching.items():
            gap = f"contact.{name}.gap"
            if self.system.mode.get(name, SPLIT) != SPLIT:
                wrong = f"'{name}' touches, but the nearest pose leaves a gap of {{size}} m"
                yield Demand(gap, 0, 0, ("system", "mode", name), wrong)
            elif given:
                wrong = f"'{pair.contact}' starts {{size}} m inside of '{pair.against}'"
                yield Demand(gap, 0, np.inf, ("initial",), wrong)

    def _clear(self, end: str) -> Iterator[Demand]:
        """Contacts are inside of nothing; a pose that is given is judged as the audit judges."""
        lower, upper = self._box(end)
        enough = INSIDE if bool(np.all(lower == upper)) else REACHED
        for name, pair in self.system.touching.items():
            wrong = f"'{pair.contact}' {VERBS[end]} {{size}} m inside of '{pair.against}'"
            yield Demand(f"contact.{name}.gap", 0, np.inf, (end,), wrong, enough)

    def _stopped(self) -> Iterator[Demand]:
        """Limits of joints that are no coordinates; those that are bound the search."""
        for name, joint in self.system.joints.items():
            if name in self.system.defined and getattr(joint, "limits", None) is not None:
                limits = resolve.interval(self.phase.bounds.get(name), self.constants)
                wrong = f"'{name}' misses the limits of its joint by {{size}}"
                yield Demand(name, *limits, ("system", "joints", name, "limits"), wrong)
