"""The three problems of the comparison, once for all peers: plain numbers, no tool's symbols.

Footfall solves its own examples of these names; the peers get the same equations from here.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import inf, pi
from typing import Any

Symbol = Any
"""A number or an expression of whichever tool."""

Sine = Callable[[Symbol], Symbol]


@dataclass(frozen=True)
class Problem:
    """Minimize the integral of the controls' squares from rest to rest in a given time.

    ``rate(x, u, sin, cos)`` are the states' time derivatives; ``bounds`` hold for states and then
    controls; ``optimum`` is J* (shared/numerics.md: high-order collocation, stable digits).
    """

    name: str
    duration: float
    start: Sequence[float]
    end: Sequence[float]
    controls: int
    bounds: Sequence[tuple[float, float]]
    rate: Callable[[Sequence[Symbol], Sequence[Symbol], Sine, Sine], list[Symbol]]
    optimum: float

    @property
    def states(self) -> int:
        """How many states there are."""
        return len(self.start)

    def guess(self, share: float) -> list[float]:
        """The states on the straight line between the ends, at a share of the time."""
        return [a + share * (b - a) for a, b in zip(self.start, self.end, strict=True)]


def _cart_pole(x: Sequence[Symbol], u: Sequence[Symbol], sin: Sine, cos: Sine) -> list[Symbol]:
    """Kelly's dissertation, equations 7.22 and 7.23."""
    m1, m2, length, g = 1.0, 0.3, 0.5, 9.81
    s, c, force = sin(x[1]), cos(x[1]), u[0]
    den = m1 + m2 * s**2
    cart = (length * m2 * s * x[3] ** 2 + force + m2 * g * c * s) / den
    pole = -(length * m2 * c * s * x[3] ** 2 + force * c + (m1 + m2) * g * s) / (length * den)
    return [x[2], x[3], cart, pole]


def _quadrotor(x: Sequence[Symbol], u: Sequence[Symbol], sin: Sine, cos: Sine) -> list[Symbol]:
    """Section 8.7, the equations as printed."""
    m, d, g = 0.2, 0.3, 9.81
    thrust = (u[0] + u[1]) / m
    turn = (u[1] - u[0]) / (2 * m * d)
    return [x[3], x[4], x[5], -sin(x[2]) * thrust, cos(x[2]) * thrust - 2 * g, turn]


def _pendulum(x: Sequence[Symbol], u: Sequence[Symbol], sin: Sine, cos: Sine) -> list[Symbol]:
    """Section 8.8."""
    del cos
    return [x[1], -0.2 * x[1] - 3.0 * sin(x[0]) + u[0]]


_OPEN = (-inf, inf)

PROBLEMS = {
    "cart_pole": Problem(
        name="cart_pole",
        duration=2.0,
        start=[0.0] * 4,
        end=[1.0, pi, 0.0, 0.0],
        controls=1,
        bounds=[(-2.0, 2.0), _OPEN, _OPEN, _OPEN, (-20.0, 20.0)],
        rate=_cart_pole,
        optimum=58.80766746,
    ),
    "quadrotor": Problem(
        name="quadrotor",
        duration=1.0,
        start=[0.0] * 6,
        end=[1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        controls=2,
        bounds=[_OPEN] * 8,
        rate=_quadrotor,
        optimum=9.8353243,
    ),
    "pendulum_torque": Problem(
        name="pendulum_torque",
        duration=5.0,
        start=[0.0, 0.0],
        end=[pi, 0.0],
        controls=1,
        bounds=[_OPEN] * 3,
        rate=_pendulum,
        optimum=9.17076217,
    ),
}
