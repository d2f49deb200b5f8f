"""Everything that may touch or come to its limit, and the loops, in one list of rows.

First the pairs, in the order of the multibody, then the joints' limits, which have no friction.
"""

import math
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, replace
from typing import assert_never

import numpy as np

from schemas import resolve
from schemas.errors import InvalidModel
from schemas.mechanisms import Floating, Prismatic, Revolute, Welded
from solver.numeric.tape import Array
from solver.simulation.automaton import Moment
from solver.simulation.instant import Instant
from solver.simulation.kinematics import Complex
from solver.simulation.multibody import Multibody
from solver.simulation.starts import inside, open_loops, past

DEEP = 1e-6
"""A start that penetrates more than this is refused, m."""

Control = Callable[[Array, Array, float], Array]
"""Times (k,), states (2 n, k), a time within their piece -> the controls (controls, k)."""


@dataclass(frozen=True, slots=True)
class Rows:
    """All unilateral constraints, c of them, and the loops' rows, at N points.

    Attributes
    ----------
    gaps, rates, slips
        m (rad of hinges) and per second, (c, N). Slips are zero at limits.
    Jn, Jt
        Their slopes, (c, n, N).
    normal_bias, slip_bias
        Accelerations of gaps and slips at zero dd(q), (c, N).
    loop_gaps, loop_rates, loop_bias
        (2 loops, N), and ``loop_slopes`` (2 loops, n, N).
    """

    gaps: Array
    rates: Array
    slips: Array
    Jn: Array
    Jt: Array
    normal_bias: Array
    slip_bias: Array
    loop_gaps: Array
    loop_rates: Array
    loop_slopes: Array
    loop_bias: Array


@dataclass(frozen=True, slots=True)
class Unilateral:
    """The list itself: names, coefficients, and the limits as ``slopes @ q + offsets >= 0``."""

    multibody: Multibody
    control: Control
    names: tuple[str, ...]
    friction: Array
    restitution: Array
    slopes: Array
    offsets: Array
    within: float = 0.0

    @classmethod
    def of(
        cls,
        multibody: Multibody,
        control: Control,
        statics: Mapping[str, float] | None = None,
        restitution: float | None = None,
    ) -> "Unilateral":
        """Read a multibody; ``restitution`` replaces that of all pairs."""
        names, slopes, offsets = _limits(multibody, statics or {})
        count = len(multibody.pairs)
        bounce = multibody.restitution if restitution is None else np.full(count, restitution)
        return cls(
            multibody,
            control,
            (*multibody.pairs, *names),
            np.concatenate([multibody.friction, np.zeros(len(names))]),
            np.concatenate([bounce, np.zeros(len(names))]),
            np.reshape(slopes, (len(names), len(multibody.coordinates))),
            np.array(offsets),
        )

    @property
    def pairs(self) -> int:
        """How many of them are contacts."""
        return len(self.multibody.pairs)

    def at(self, t: Array, y: Array) -> Instant:
        """The mechanism at times (N,) and states (2 n, N): coordinates, then velocities."""
        q, v = np.split(y, 2)
        return self.multibody.at(t, q, v, self.control(t, y, self.within))

    def piece(self, within: float) -> "Unilateral":
        """The same, in another piece of what drives it: that with the time ``within``."""
        return replace(self, within=within)

    def rows(self, at: Instant) -> Rows:
        """All rows at the points of an instant."""
        touch, loops, N = at.contacts, at.loops, at.q.shape[1]
        limits = len(self.slopes)
        slopes = np.repeat(self.slopes[..., None], N, axis=2)
        flat = np.zeros((limits, N))
        return Rows(
            gaps=np.concatenate([touch.gaps, self.slopes @ at.q + self.offsets[:, None]]),
            rates=np.concatenate([touch.gap_rates, self.slopes @ at.v]),
            slips=np.concatenate([touch.slips, flat]),
            Jn=np.concatenate([touch.Jn, slopes]),
            Jt=np.concatenate([touch.Jt, np.zeros_like(slopes)]),
            normal_bias=np.concatenate([touch.gap_bias, flat]),
            slip_bias=np.concatenate([touch.slip_bias, flat]),
            loop_gaps=_both(loops.z),
            loop_rates=_both(loops.rate),
            loop_slopes=_both(loops.slopes),
            loop_bias=_both(loops.bias),
        )


def check_start(system: Unilateral, moment: Moment, given: Collection[str] = ()) -> None:
    """Look at a start; ``given`` coordinates are not the ones to change.

    Raises
    ------
    InvalidModel
        Where contacts penetrate or have no ground, joints are beyond their limits, or loops open.
    """
    here, model = system.piece(moment.within), system.multibody
    with np.errstate(all="ignore"):
        at = here.at(np.array([moment.time]), moment.state[:, None])
        gaps = here.rows(at).gaps[:, 0]
    issues = []
    for row, (name, gap) in enumerate(zip(system.names, gaps, strict=True)):
        if not gap >= -DEEP:
            touches = row < system.pairs
            issues.append(
                inside(model, at, name, gap) if touches else past(name, gap, _unit(model, name))
            )
    issues += open_loops(model, at, given, DEEP)
    if issues:
        raise InvalidModel(issues)


def _unit(model: Multibody, limit: str) -> str:
    joint = model.mechanism.joints[limit.rpartition(".")[0]]
    return "m" if isinstance(joint, Prismatic) else "rad"


def _both(values: Complex) -> Array:
    return np.concatenate([values.real, values.imag])


def _limits(
    multibody: Multibody, statics: Mapping[str, float]
) -> tuple[list[str], list[Array], list[float]]:
    """Every limit of a joint: its name with ``.lower`` or ``.upper``, its slope and offset."""
    names, slopes, offsets = [], [], []
    known = {**statics, **resolve.parameters(multibody.mechanism)}
    axes, joints = multibody.parts.axes, multibody.mechanism.joints
    for row, name in enumerate(axes.names):
        joint = joints[name]
        match joint:
            case Revolute() | Prismatic():
                pass
            case Welded() | Floating():  # nothing to limit
                continue
            case _:
                assert_never(joint)
        lower, upper = resolve.interval(joint.limits, known)
        for word, limit, sign in (("lower", lower, 1.0), ("upper", upper, -1.0)):
            if math.isfinite(limit):
                names.append(f"{name}.{word}")
                slopes.append(sign * axes.rows[row])
                offsets.append(sign * (axes.offsets[row] - limit))
    return names, slopes, offsets
