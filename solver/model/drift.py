"""What keeps contacts and loops in place on a mesh: two more variables for each, and their rows.

Accelerations that keep a foot at rest let it creep: every step of a method adds its own error.
So a method gets ``d(q)/dt = v + J' eta`` and ``d(v)/dt = a + J' zeta``, and in return the place
itself, and its rate, are held at every node but the first of each segment, where eta and zeta are
zero (Gear, Gupta and Leimkuhler, 1985; Posa, Kuindersma and Tedrake, 2016, for Hermite-Simpson).
Both are of the size of the method's own error. Forces follow from the accelerations, as ever: they
do not oscillate.
"""

from collections.abc import Mapping, Sequence

import casadi as ca

from schemas.expressions import derivative
from solver.expressions import SX
from solver.lowering import Form, Holonomic
from solver.model.shape import PhaseShape

Holds = Form | PhaseShape
"""What knows its states, and what contacts and loops hold."""


def drift_names(form: Holds) -> tuple[str, ...]:
    """The variables: eta of each place, then zeta of each rate; no user can write them."""
    etas = [f"#eta {one.label}" for one in form.holonomic if one.place is not None]
    return (*etas, *(f"#zeta {one.label}" for one in form.holonomic))


def drift_rates(form: Holds, scope: Mapping[str, SX], x: SX, drift: SX) -> SX:
    """What eta and zeta add to the rates of the states, (n_x,)."""
    if not form.holonomic:
        return SX.zeros(*x.shape)
    matrix = ca.jacobian(ca.vertcat(*(scope[one.rate] for one in form.holonomic)), x)
    rows = [i for i, one in enumerate(form.holonomic) if one.place is not None]
    coordinates, velocities = _split(form)
    J = matrix[:, velocities]
    eta, zeta = drift[: len(rows)], drift[len(rows) :]
    added = SX.zeros(*x.shape)
    added[coordinates] = ca.mtimes(J[rows, :].T, eta)
    added[velocities] = ca.mtimes(J.T, zeta)
    return added


def _split(form: Holds) -> tuple[list[int], list[int]]:
    """Positions of the coordinates and of their velocities among the states."""
    place = {name: i for i, name in enumerate(form.states)}
    pairs = [(i, place[rate]) for name, i in place.items() if (rate := derivative(name)) in place]
    return [i for i, _ in pairs], [j for _, j in pairs]


def held_values(form: Holds, scope: Mapping[str, SX]) -> SX:
    """Places, then rates, of what is held."""
    places = [scope[one.place] for one in form.holonomic if one.place is not None]
    return ca.vertcat(SX(0, 1), *places, *(scope[one.rate] for one in form.holonomic))


def held_labels(held: Sequence[Holonomic]) -> tuple[str, ...]:
    """What to call the rows, as `held_values` orders them."""
    places = [f"held {one.label}" for one in held if one.place is not None]
    return (*places, *(f"held rate {one.label}" for one in held))
