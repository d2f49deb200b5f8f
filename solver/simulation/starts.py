"""Why a mechanism cannot start as it is told to, and what would mend it."""

from collections.abc import Collection, Iterator

import numpy as np
from numpy.typing import NDArray

from schemas.errors import Issue
from schemas.expressions import derivative
from schemas.pointers import pointer
from solver.numeric.tape import Array
from solver.simulation.instant import Instant
from solver.simulation.kinematics import Complex
from solver.simulation.multibody import Multibody

_ROUNDS, _CLOSED = 50, 1e-10
_STRIDE = 1.0
"""The longest step of a coordinate on the way to a closed loop, m or rad."""


def inside(model: Multibody, at: Instant, pair: str, gap: float) -> Issue:
    """A contact that is deeper than it may be, or over ground without a height."""
    touch = model.mechanism.touching[pair]
    body = model.mechanism.contacts[touch.contact].body
    if np.isfinite(gap):
        return Issue(
            "/initial",
            f"the contact '{pair}' of '{body}' starts {-gap:.3g} m inside '{touch.against}'",
            f"place '{body}' {-gap:.3g} m further out by the coordinates that carry it",
        )
    places = at.parts.touch.places[0][[model.pairs.index(pair)]]
    x = float((places @ at.pose.features)[0, 0].real)
    where = pointer("system", "surfaces", touch.against, "height")
    if touch.against not in model.mechanism.surfaces:
        where = pointer("system", "shapes", touch.against)
    return Issue(
        where,
        f"no finite value at x = {x:.4g}, where the contact '{pair}' of '{body}' starts",
        "height and slope need a value wherever the contact may go",
    )


def past(limit: str, gap: float, unit: str) -> Issue:
    """A joint, as ``JOINT.lower`` or ``.upper``, that starts beyond its limit."""
    joint, _, side = limit.rpartition(".")
    return Issue(
        "/initial",
        f"the joint '{joint}' starts {-gap:.3g} {unit} beyond its {side} limit",
        f"change '{joint}' in 'initial', or the 'limits' of the joint",
    )


def open_loops(
    model: Multibody, at: Instant, given: Collection[str], most: float
) -> Iterator[Issue]:
    """Loops that are open by more than ``most``, m. Coordinates ``given`` are kept if they can."""
    gaps = np.abs(at.loops.z[:, 0])
    if np.all(gaps <= most):
        return
    hint = _closing(model, at.q[:, 0], given)
    for name, gap in zip(model.parts.loop_names, gaps, strict=True):
        if not gap <= most:
            ends = [f"'{one.body}'" for one in model.mechanism.loops[name].between]
            message = f"the loop '{name}', of {' and '.join(ends)}, is open by {gap:.3g} m"
            yield Issue("/initial", f"{message} at the start", hint)


def parting_loops(model: Multibody, at: Instant, most: float) -> Iterator[Issue]:
    """Loops whose ends move apart, by more than ``most``, m/s."""
    rates = np.abs(at.loops.rate[:, 0])
    if np.all(rates <= most):
        return
    J, rate = _stacked(at.loops.slopes[..., 0]), _stacked(at.loops.rate[:, 0])
    fitting = at.v[:, 0] - np.linalg.pinv(J, rcond=1e-8) @ rate
    names = [derivative(name) for name in model.coordinates]
    hint = f"velocities that keep it closed: {_written(names, fitting)}"
    for name, speed in zip(model.parts.loop_names, rates, strict=True):
        if not speed <= most:
            yield Issue(
                "/initial", f"the loop '{name}' opens at {speed:.3g} m/s at the start", hint
            )


def _closing(model: Multibody, q: Array, given: Collection[str]) -> str:
    """What closes the loops: with the given coordinates as they are, else with all of them."""
    every = np.arange(len(q), dtype=np.intp)
    kept = np.array([i for i in every if model.coordinates[i] not in given], dtype=np.intp)
    best = np.inf
    for some in (kept, every):
        found, wide = _closed(model, q, some)
        best = min(best, wide)
        if wide <= _CLOSED:
            return f"it closes at {_written(model.coordinates, found)}"
    return (
        f"no pose near the start closes it, {best:.3g} m stay open: change the lengths of its "
        "bodies, or the places that it joins"
    )


def _closed(model: Multibody, q: Array, some: NDArray[np.intp]) -> tuple[Array, float]:
    """The pose after Gauss-Newton steps in some coordinates, and how far it is open, m."""
    best, wide = q, np.inf
    for _ in range(_ROUNDS if len(some) else 1):
        loops = model.at(0.0, q[:, None]).loops
        opening = float(np.abs(loops.z).max())
        if opening < wide:
            best, wide = q, opening
        if wide <= _CLOSED or not len(some):
            break
        J = _stacked(loops.slopes[..., 0])[:, some]
        step = np.linalg.pinv(J, rcond=1e-8) @ _stacked(loops.z[:, 0])
        step *= min(1.0, _STRIDE / max(float(np.abs(step).max()), 1e-300))
        q = q.copy()
        q[some] -= step
    return best, wide


def _stacked(rows: Complex) -> Array:
    return np.concatenate([rows.real, rows.imag])


def _written(names: Collection[str], values: Array) -> str:
    return ", ".join(f"{name} = {value:.10g}" for name, value in zip(names, values, strict=True))
