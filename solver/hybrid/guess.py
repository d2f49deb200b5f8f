"""Guesses of modes: one guess over the whole phase, cut where its modes are thought to change."""

import itertools
import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from schemas import resolve
from schemas.expressions import Expression, ExpressionError, constant
from schemas.guesses import Guess, SolutionGuess
from schemas.mechanisms import Mechanism
from schemas.problem import Problem
from schemas.systems import System
from solver.hybrid.expand import Expansion
from solver.model import Interval, Model, Phase
from solver.switches.join import restrict
from solver.trajectory import Trajectory, initial_guesses
from solver.trajectory.trajectory import straight_lines


def mode_guesses(expansion: Expansion, posted: Problem, model: Model) -> list[Trajectory]:
    """A trajectory for every phase of the expansion.

    An earlier result that knows the modes themselves serves them as it is.
    """
    wholes, wanted, known = list[Phase](), list[Guess](), list[list[float]]()
    phases = list(model.phases)
    for spec, split in zip(posted.phases, expansion.splits, strict=True):
        names = [spec.name] if split is None else list(split.names)
        own, phases = phases[: len(names)], phases[len(names) :]
        guess = spec.guess or posted.guess
        if split is None or _knows(guess, names):
            alike, shares = own, [[1.0]] * len(own)
        else:
            alike, shares = [_whole(own)], [list(split.shares)]
        wholes += alike
        wanted += [guess] * len(alike)
        known += shares
    trajectories = initial_guesses(replace(model, phases=tuple(wholes)), wanted)
    pieces = [
        piece
        for trajectory, own in zip(trajectories, known, strict=True)
        for piece in _pieces(trajectory, own)
    ]
    systems = [phase.system for phase in expansion.problem.phases]
    return [_bearing(*each) for each in zip(pieces, systems, strict=True)]


def _bearing(trajectory: Trajectory, system: System) -> Trajectory:
    """With contacts that bear the weight, each its part, where nothing is known of them."""
    if not isinstance(system, Mechanism) or not system.mode:
        return trajectory
    names = [f"contact.{pair}.normal" for pair in system.mode]
    unknown = [name for name in names if trajectory.curve(name) is None]
    times = trajectory.states.breaks[[0, -1]]
    share = np.full((len(unknown), 2), _weight(system) / len(names))
    lines = straight_lines(unknown, times, share)
    return trajectory if not unknown or trajectory.others else replace(trajectory, others=lines)


def _weight(system: Mechanism) -> float:
    """Of all bodies, N; what rests on free parameters counts for nothing."""
    constants = resolve.parameters(system)

    def number(expression: Expression) -> float:
        try:
            return constant(expression.tree, constants)
        except ExpressionError:
            return 0.0

    masses = [number(body.mass) for body in system.bodies.values() if body.mass is not None]
    return sum(masses) * math.hypot(*map(number, system.gravity))


def _knows(guess: Guess, names: Sequence[str]) -> bool:
    return isinstance(guess, SolutionGuess) and {one.name for one in guess.phases} >= {*names}


def _whole(modes: Sequence[Phase]) -> Phase:
    """All modes as one phase."""
    least, most = (sum(side) for side in zip(*(one.duration for one in modes), strict=True))
    duration = Interval(max(least, 0.0), math.inf if math.isnan(most) else most)
    name = modes[0].name.partition("/")[0]
    final = {**modes[0].final, **modes[-1].final}  # a force may be loose in one mode alone
    return replace(modes[0], name=name, end=modes[-1].end, duration=duration, final=final)


def _pieces(trajectory: Trajectory, shares: Sequence[float]) -> list[Trajectory]:
    length = trajectory.end - trajectory.start
    ends = [trajectory.start + length * share for share in itertools.accumulate(shares)]
    ends[-1] = trajectory.end
    return [
        restrict(trajectory, start, end)
        for start, end in itertools.pairwise([trajectory.start, *ends])
    ]
