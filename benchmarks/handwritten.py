"""The cart-pole on 25 Hermite-Simpson segments as one would write it by hand: the yardstick.

One script, one NLP in SX symbols, CasADi's own derivatives, IPOPT with its defaults.
"""

from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

SEGMENTS, DURATION = 25, 2.0
M1, M2, LENGTH, G = 1.0, 0.3, 0.5, 9.81
OPTIONS: dict[str, Any] = {"print_time": False, "ipopt.print_level": 0, "ipopt.sb": "yes"}


@dataclass(frozen=True)
class Handwritten:
    """The NLP solver and its arguments."""

    solver: ca.Function
    arguments: dict[str, Any]

    def solve(self) -> float:
        """Run IPOPT; the objective."""
        return float(self.solver(**self.arguments)["f"])


def rate(x: ca.SX, u: ca.SX) -> ca.SX:
    """The dynamics of 003, equations 7.22 and 7.23."""
    sin, cos = ca.sin(x[1]), ca.cos(x[1])
    den = M1 + M2 * sin**2
    a1 = (LENGTH * M2 * sin * x[3] ** 2 + u + M2 * G * cos * sin) / den
    a2 = -(LENGTH * M2 * cos * sin * x[3] ** 2 + u * cos + (M1 + M2) * G * sin) / (LENGTH * den)
    return ca.vertcat(x[2], x[3], a1, a2)


def build() -> Handwritten:
    """Separated Hermite-Simpson: states and controls at knots and midpoints."""
    nodes, h = 2 * SEGMENTS + 1, DURATION / SEGMENTS
    x, u = ca.SX.sym("x", 4, nodes), ca.SX.sym("u", 1, nodes)
    f = [rate(x[:, i], u[:, i]) for i in range(nodes)]
    rows, cost = [], ca.SX(0)
    for k in range(0, nodes - 1, 2):
        rows.append(x[:, k + 1] - (x[:, k] + x[:, k + 2]) / 2 - h / 8 * (f[k] - f[k + 2]))
        rows.append(x[:, k + 2] - x[:, k] - h / 6 * (f[k] + 4 * f[k + 1] + f[k + 2]))
        cost += h / 6 * (u[k] ** 2 + 4 * u[k + 1] ** 2 + u[k + 2] ** 2)
    program: dict[str, Any] = {"x": ca.veccat(x, u), "f": cost, "g": ca.vertcat(*rows)}
    end = np.array([1.0, np.pi, 0.0, 0.0])
    lower = np.tile([-2.0, -np.inf, -np.inf, -np.inf], (nodes, 1))
    upper = -lower
    lower[0], upper[0], lower[-1], upper[-1] = 0.0, 0.0, end, end
    guess = np.outer(np.linspace(0, 1, nodes), end)
    force = np.full(nodes, 20.0)
    return Handwritten(
        ca.nlpsol("solver", "ipopt", program, OPTIONS),
        {
            "x0": np.concatenate([guess.ravel(), np.zeros(nodes)]),
            "lbx": np.concatenate([lower.ravel(), -force]),
            "ubx": np.concatenate([upper.ravel(), force]),
            "lbg": 0.0,
            "ubg": 0.0,
        },
    )
