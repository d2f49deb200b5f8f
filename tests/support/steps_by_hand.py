"""Steps through contact made by hand.

Nothing of the engine: each motion is solved step by step from its own equations, so that it is
right to round-off, or wrong in a way that a test chooses.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import scipy.optimize
from numpy.typing import NDArray

from schemas.results import PhaseResult
from tests.support.stepped import published

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
G = 9.81

BLOCK: dict[str, Any] = {
    "kind": "mechanism",
    "bodies": {"block": {"mass": 2.0, "inertia": 0.1}},
    "joints": {"free": {"kind": "floating", "child": "block"}},
    "contacts": {"foot": {"body": "block"}},
    "surfaces": {"ground": {"friction": 0.4}},
    "controls": ["u"],
    "forces": {
        "push": {"body": "block", "at": [0, 0], "direction": [1, 0], "value": "u", "frame": "world"}
    },
}
"""2 kg on level ground, pushed along it at its only contact."""

Law = Callable[[float, float], float]


def coulomb(sticking: float, most: float) -> float:
    """The friction that would stop the block, or the most that there is."""
    return float(np.clip(sticking, -most, most))


def block(
    knots: Array,
    start: tuple[float, float, float, float],
    push: Array,
    friction: Law = coulomb,
    floor: float = 0.0,
) -> PhaseResult:
    """From x, y, vx, vy at the start under pushes (N,); plastic where it lands."""
    m, mu = 2.0, 0.4
    x, y, vx, vy = ([one] for one in start)
    normal, tangential = [], []
    for h, u in zip(np.diff(knots), push, strict=True):
        fall = vy[-1] - G * h
        rise = max(fall, (floor - y[-1]) / h)
        normal.append(m * (rise - fall) / h)
        rush = vx[-1] + u * h / m
        tangential.append(friction(-m * rush / h, mu * normal[-1]))
        vx.append(rush + tangential[-1] * h / m)
        vy.append(rise)
        x.append(x[-1] + h * vx[-1])
        y.append(y[-1] + h * vy[-1])
    states = {"block.x": np.array(x), "block.y": np.array(y), "block.angle": np.zeros(len(x))}
    starts = (("block.d(x)", vx[:1]), ("block.d(y)", vy[:1]), ("block.d(angle)", [0.0]))
    forces = {"normal": normal, "tangential": tangential}
    return published(
        knots,
        {**states, **{name: np.array(one) for name, one in starts}},
        {"u": np.asarray(push, dtype=float)},
        {f"contact.foot.{name}": np.array(one) for name, one in forces.items()},
    )


MASS, LONG, INERTIA = 1.2, 0.7, 0.03
STOP = -0.6
ARM: dict[str, Any] = {
    "kind": "mechanism",
    "angles": "absolute",
    "bodies": {
        "upper": {"mass": MASS, "inertia": INERTIA, "com": [0, -LONG]},
        "lower": {"mass": MASS, "inertia": INERTIA, "com": [0, -LONG]},
    },
    "joints": {
        "hip": {"kind": "revolute", "child": "upper"},
        "knee": {
            "kind": "revolute",
            "parent": "upper",
            "child": "lower",
            "at": [0, -LONG],
            "limits": [STOP, None],
        },
    },
    "motors": {"hip": {"joint": "hip"}},
    "springs": {"knee": {"joint": "knee", "stiffness": 8.0, "rest": 0.2, "damping": 0.3}},
}
"""Two links of 0.7 m with their masses at their ends; a stop, a spring and a damper in the knee."""


def arm(knots: Array, start: Array, torque: Array, euler: bool = False) -> PhaseResult:
    """From angles and their rates (4,) at the start, under torques (N,), against the stop.

    Steps of the discrete gradient; with ``euler`` those of 000.
    """
    angles, stops = [start[:2]], []
    step = _Step(start[:2], start[2:], LONG * start[2:] * np.exp(1j * start[:2]), 0.0, 0.0)
    for h, u in zip(np.diff(knots), torque, strict=True):
        step = step._replace(h=h, u=u)
        after, push = step.after(step.euler if euler else step.gradient)
        step = _Step(
            after, (after - step.q) / h, _chord(step.q, after) * (after - step.q) / h, h, u
        )
        angles.append(after)
        stops.append(push)
    table = np.array(angles).T
    names = ("upper", "lower")
    states = {f"{name}.angle": table[i] for i, name in enumerate(names)}
    starts = {f"{name}.d(angle)": start[2 + i : 3 + i] for i, name in enumerate(names)}
    return published(
        knots, {**states, **starts}, {"motor.hip.torque": torque}, {"limit.knee": np.array(stops)}
    )


class _Step(NamedTuple):
    """Angles, their rates, and the links' velocities (2,) before a step, and in it."""

    q: Array
    w: Array
    before: Complex
    h: float
    u: float

    def after(self, left: Callable[[Array, float], Array]) -> tuple[Array, float]:
        """The angles after the step, and the effort of the stop."""
        near = self.q + self.h * self.w
        found = _root(lambda q: left(q, 0.0), near)
        if found[1] - found[0] >= STOP:
            return found, 0.0
        turn, push = _root(lambda z: left(np.array([z[0], z[0] + STOP]), z[1]), [near[0], 0.0])
        return np.array([turn, turn + STOP]), float(push)

    def gradient(self, q1: Array, push: float) -> Array:
        """What is left of the balance by exact changes."""
        slopes, w1 = _chord(self.q, q1), (q1 - self.q) / self.h
        jumps = np.cumsum(slopes * w1 - self.before) + 1j * G * self.h
        knee = self.knee(q1, float(np.diff(self.q + q1)[0]) / 2) + push
        return self._left(slopes, jumps, w1, knee)

    def euler(self, q1: Array, push: float) -> Array:
        """What is left of ``M(q1) (w1 - w0) = h forces(q1, w1)``."""
        w1, out = (q1 - self.q) / self.h, LONG * np.exp(1j * q1)
        change = out * (w1 - self.w) + self.h * 1j * out * w1**2
        knee = self.knee(q1, float(np.diff(q1)[0])) + push
        return self._left(out, np.cumsum(change) + 1j * G * self.h, w1, knee)

    def knee(self, q1: Array, bent: float) -> float:
        """The torque of spring and damper."""
        return 8.0 * (0.2 - bent) - 0.3 * float(np.diff(q1 - self.q)[0]) / self.h

    def _left(self, slopes: Complex, jumps: Complex, w1: Array, knee: float) -> Array:
        inert = np.array([jumps.sum(), jumps[1]])
        moved = MASS * (slopes.conj() * inert).real + INERTIA * (w1 - self.w)
        return np.asarray(moved - self.h * np.array([self.u - knee, knee]))


def _root(left: Callable[[Array], Array], near: Any) -> Array:
    return np.asarray(scipy.optimize.fsolve(left, near, xtol=1e-12))


def _chord(q0: Array, q1: Array) -> Complex:
    """The change of the way to a link's end over that of its angle: exact, by sinc."""
    return np.asarray(LONG * np.exp(0.5j * (q0 + q1)) * np.sinc((q1 - q0) / 2 / np.pi))
