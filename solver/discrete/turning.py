"""How far things may turn in one step.

By where a body is at both ends nobody can tell a turn by an angle from one by a full turn more,
which costs nothing: an optimizer would use that.
"""

import math
from collections.abc import Iterator

import casadi as ca

from solver.discrete.chord import Column
from solver.expressions import SX
from solver.mechanics.principle import Principle

LARGEST = 1.0
"""Of a joint or a free body in one step, rad."""


Row = tuple[str, SX, float, float]


def turn_rows(principle: Principle, q0: Column, q1: Column) -> Iterator[Row]:
    """What turns, by how much, and the limits of that.

    Hinges by the change of their coordinate, rad; quaternions by the product of both ends, which
    is the cosine of half the angle.
    """
    for place, factor in principle.hinges:
        name, turn = principle.coordinates[place], factor * (q1[place] - q0[place])
        yield f"turn of {name}", SX(turn), -LARGEST, LARGEST
    for places in principle.norms:
        name = principle.coordinates[places[0]].rpartition(".")[0]
        ends = (ca.vertcat(*(q[i] for i in places)) for q in (q0, q1))
        yield f"turn of {name}", ca.dot(*ends), math.cos(LARGEST / 2), math.inf
