"""004 as its code has it: sums over ten nodes, for the case that it ships; nothing of the engine.

One stance to the right of the ice, trapezoids with a step of T/10 between ten nodes, and two
sums that the seed minimizes in a row: of (u dt)^2, and of the work per step.
"""

from functools import cache
from math import cos, inf, pi, sin
from typing import Any, NamedTuple

import casadi as ca

NODES = 10
SPRING, DAMP, TOE_MASS, GRAVITY, EPSILON = 20.0, 0.5, 0.1, 1.0, 1e-3
HIP = 1.1
START = (HIP, 0.0, HIP - cos(pi / 4), 0.0, sin(pi / 4), 0.0, 1.0, 0.0)
"""The toe's place and speed, the hip's place and speed in x and y, the rest length and its rate."""

_LOWER = (1.0, -inf, -inf, -inf, 0.0, -inf, -inf, -inf)


class _Node(NamedTuple):
    slope: ca.SX
    length: ca.SX
    ground: ca.SX
    spring: ca.SX


@cache
def least_sums() -> dict[str, float]:
    """The least sum of actuation squared and, from there, the least sum of work."""
    state, control, span = ca.SX.sym("x", 8, NODES), ca.SX.sym("u", 2, NODES), ca.SX.sym("T")
    step = span / NODES
    nodes = [_node(state[:, k], control[:, k]) for k in range(NODES)]
    rows, lower, upper = _rows(state, nodes, step)
    sums = {"actuation": ca.sumsqr(control * step), "work": _work(state, control, nodes, step)}
    x = ca.vertcat(ca.vec(state), ca.vec(control), span)
    low = [*_LOWER * NODES, *[-1.0] * (2 * NODES), 0.1]
    high = [*[inf] * (8 * NODES), *[1.0] * (2 * NODES), 2.0]
    at = ca.DM([min(max(1.0, a), b) for a, b in zip(low, high, strict=True)])
    quiet: dict[str, Any] = {
        "ipopt.print_level": 0,
        "print_time": False,
        "ipopt.sb": "yes",
        "ipopt.tol": 1e-9,
    }
    found = {}
    for name, cost in {"any": ca.SX(0), **sums}.items():
        solver = ca.nlpsol("sums", "ipopt", {"x": x, "g": rows, "f": cost}, quiet)
        result = solver(x0=at, lbx=low, ubx=high, lbg=lower, ubg=upper)
        if not solver.stats()["success"]:
            raise RuntimeError(f"the seed's sums, step '{name}': {solver.stats()['return_status']}")
        at, found[name] = result["x"], float(result["f"])
    return found


def _node(x: ca.SX, u: ca.SX) -> _Node:
    """The motion on sticking ground, equations 1 to 7."""
    across, length = x[2] - x[0], ca.sqrt((x[2] - x[0]) ** 2 + x[4] ** 2)
    rate = (across * (x[3] - x[1]) + x[4] * x[5]) / length
    spring, turn = SPRING * (x[6] - length) + DAMP * (x[7] - rate), u[1] / length
    c, s = across / length, x[4] / length
    ahead, up = spring * c + turn * s, spring * s - turn * c
    slope = ca.vertcat(x[1], 0, x[3], ahead, x[5], up - GRAVITY, x[7], u[0])
    without_toe = (across * x[3] + x[4] * x[5]) / length
    plain = SPRING * (x[6] - length) + DAMP * (x[7] - without_toe)
    return _Node(slope, length, up + TOE_MASS * GRAVITY, plain)


def _rows(x: ca.SX, nodes: list[_Node], step: ca.SX) -> tuple[ca.SX, list[float], list[float]]:
    """Trapezoids, the start, the hip above the toe; lengths and ground forces at all nodes."""
    defects = [
        x[:, k + 1] - x[:, k] - step * (nodes[k].slope + nodes[k + 1].slope) / 2
        for k in range(NODES - 1)
    ]
    zeros = ca.vertcat(*defects, x[:, 0] - ca.DM(START), x[2, -1] - HIP)
    lengths = ca.vertcat(*(node.length for node in nodes))
    ground = ca.vertcat(*(node.ground for node in nodes))
    count = zeros.numel()
    lower = [0.0] * count + [0.5] * NODES + [0.0] * NODES
    upper = [0.0] * count + [1.0] * NODES + [10.0] * NODES
    return ca.vertcat(zeros, lengths, ground), lower, upper


def _work(x: ca.SX, u: ca.SX, nodes: list[_Node], step: ca.SX) -> ca.SX:
    """Equation 11 with the smoothing of 12: leg per step times dt, hip by the angle's change."""
    total = ca.SX(0)
    for k in range(NODES - 1):
        power = (nodes[k].spring + nodes[k + 1].spring) / 2 * (x[7, k] + x[7, k + 1]) / 2
        turn = _angle(x[:, k + 1]) - _angle(x[:, k])
        total += _smooth(power) * step + _smooth((u[1, k] + u[1, k + 1]) / 2 * turn)
    return total


def _angle(x: ca.SX) -> ca.SX:
    return ca.atan2(x[4], x[2] - x[0])


def _smooth(value: ca.SX) -> ca.SX:
    return ca.sqrt(value**2 + EPSILON**2) - EPSILON
