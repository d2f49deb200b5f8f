"""Key poses of a guess: each by inverse kinematics, near the one before, straight lines between."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from schemas import resolve
from schemas.expressions import derivative, stem
from schemas.expressions.names import MAX_ORDER
from schemas.guesses import Guess, KeyPose, LinearGuess, PointsGuess, PosesGuess, RandomGuess
from schemas.mechanisms import Mechanism
from schemas.phases import Phase
from schemas.problem import Problem
from schemas.values import Bound, Scalar
from solver.mechanics import limited
from solver.model import read_static
from solver.numeric.tape import Array
from solver.poses.search import REACHED, VALUELESS, Search
from solver.poses.tapes import Tapes

Limits = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Posed:
    """A problem whose key poses are points, and what is to be said of those out of reach."""

    problem: Problem
    remarks: list[str]


def posed(problem: Problem) -> Posed:
    """The problem with the points that its key poses stand for; as it is where it has none.

    Phases that are no planar mechanisms take the linear guess in their place.
    """
    own = [phase.guess or problem.guess for phase in problem.phases]
    if not any(_poses(guess) for guess in own):
        return Posed(problem, [])
    statics = {name: read_static(name, one).guess for name, one in problem.static.items()}
    phases, remarks = [], list[str]()
    for phase, guess, tight in zip(problem.phases, own, limited(problem).phases, strict=True):
        found = _replaced(guess, tight, statics, remarks)
        phases.append(phase if found is guess else phase.model_copy(update={"guess": found}))
    return Posed(problem.model_copy(update={"phases": phases}), remarks)


def _poses(guess: Guess) -> PosesGuess | None:
    about = guess.about if isinstance(guess, RandomGuess) else guess
    return about if isinstance(about, PosesGuess) else None


def _replaced(
    guess: Guess, phase: Phase, statics: Mapping[str, float], remarks: list[str]
) -> Guess:
    """The guess with points for poses; ``phase`` has the limits of joints among its bounds."""
    poses = _poses(guess)
    if poses is None:
        return guess
    points: PointsGuess | LinearGuess = LinearGuess(duration=poses.duration)
    if isinstance(phase.system, Mechanism):
        posing = _Posing(phase, Tapes(phase.system, statics))
        points = posing.points(poses)
        remarks += posing.remarks
    if isinstance(guess, RandomGuess):
        return guess.model_copy(update={"about": points})
    return points


@dataclass(slots=True)
class _Posing:
    """One phase's mechanism on its way from pose to pose."""

    phase: Phase
    tapes: Tapes
    remarks: list[str] = field(default_factory=list)

    def points(self, guess: PosesGuess) -> PointsGuess:
        """Coordinates at the times of the poses, and the velocities of the lines between them."""
        names = self.tapes.system.coordinates
        last = len(guess.poses) - 1
        found: list[Array] = []
        for index, pose in enumerate(guess.poses):
            end = {0: self.phase.initial, last: self.phase.final}.get(index, {})
            found.append(self._pose(pose, end, found[-1] if found else None))
        times, poses = np.array([pose.at for pose in guess.poses]), np.array(found).T
        series = dict(zip(names, poses, strict=True))
        rates = np.gradient(poses, times, axis=1) * self._stretch(guess, times)
        series |= zip((derivative(name) for name in names), rates, strict=True)
        return PointsGuess(
            kind="points",
            duration=guess.duration,
            time=times.tolist(),
            values={name: [Scalar(float(one)) for one in row] for name, row in series.items()},
        )

    def _stretch(self, guess: PosesGuess, times: Array) -> float:
        """What a rate over the poses' times is multiplied by; 1 where nobody knows the length."""
        length = float(times[-1] - times[0])
        limits = resolve.interval(self.phase.time.duration, self.tapes.constants)
        known = guess.duration or (limits[0] if limits[0] == limits[1] else length)
        return length / known

    def _pose(self, pose: KeyPose, end: Mapping[str, Bound], before: Array | None) -> Array:
        asked = dict(self._asked(pose))
        rows = dict(self._kept(end)) | asked
        lower, upper = self._box(end)
        if not rows:
            return np.clip(_middle(lower, upper) if before is None else before, lower, upper)
        limits = np.array(list(rows.values()))
        tape = self.tapes.tape(list(rows))
        search = Search(self.tapes, tape, limits[:, 0], limits[:, 1])
        start = _middle(lower, upper) if before is None else before
        found = search.best((lower, upper), start)
        if found.worst > REACHED:
            self._remark(pose, list(rows), found.missed)
        return found.pose

    def _remark(self, pose: KeyPose, names: Sequence[str], missed: Array) -> None:
        worst = names[int(np.argmax(np.abs(missed)))]
        if np.abs(missed).max() >= VALUELESS:
            return
        owner = worst.rpartition(".")[0]
        together = [name in (f"{owner}.x", f"{owner}.y", worst) for name in names]
        what = owner if owner in pose.places else worst
        size = float(np.linalg.norm(missed[together]))
        self.remarks.append(
            f"The guessed pose at {pose.at:g} in phase {self.phase.name} is out of reach: '{what}' "
            f"misses it by {size:.3g} in the closest one, which is taken."
        )

    def _asked(self, pose: KeyPose) -> Iterator[tuple[str, Limits]]:
        """What of the pose this mechanism knows."""
        constants, known = self.tapes.constants, self.tapes.system.positions
        for owner, corner in pose.places.items():
            for word, value in zip(("x", "y"), corner, strict=True):
                name = f"{owner}.{word}"
                if value is not None and name in known:
                    number = resolve.scalar(value, constants)
                    yield name, (number, number)
        for name, bound in pose.values.items():
            if name in known:
                yield name, resolve.interval(bound, constants)

    def _kept(self, end: Mapping[str, Bound]) -> Iterator[tuple[str, Limits]]:
        """What every pose keeps to: nothing inside of another, loops closed, bounds."""
        system = self.tapes.system
        for name in system.touching:
            yield f"contact.{name}.gap", (0.0, math.inf)
        for name in system.loops:
            yield from ((f"loop.{name}#{word}", (0.0, 0.0)) for word in ("x", "y"))
        for bounds in (self.phase.bounds, end):
            for name, bound in bounds.items():
                if system.defined.get(name) == MAX_ORDER and stem(name)[0] == 0:
                    yield name, resolve.interval(bound, self.tapes.constants)

    def _box(self, end: Mapping[str, Bound]) -> tuple[Array, Array]:
        """Limits of the coordinates, those of an end among them."""
        constants = self.tapes.constants
        sides = []
        for name in self.tapes.system.coordinates:
            along = resolve.interval(self.phase.bounds.get(name), constants)
            there = resolve.interval(end.get(name), constants)
            sides.append((max(along[0], there[0]), min(along[1], there[1])))
        box = np.array(sides)
        return box[:, 0], np.maximum(box[:, 0], box[:, 1])


def _middle(lower: Array, upper: Array) -> Array:
    """Between the limits, away from poses at which joints are straight."""
    closed = np.isfinite(lower) & np.isfinite(upper)
    with np.errstate(invalid="ignore"):
        return np.where(closed, (lower + upper) / 2, np.clip(0.0, lower, upper))
