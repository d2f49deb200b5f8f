"""Accelerations under contacts that stay and loops that hold, at many points at once.

Every held row asks ``D a + bias = 0``; its force acts along G. Where a contact slides, the normal
force brings its friction along, so that G and D differ. Rows that depend on each other (toe and
heel of one rigid foot) share their force so that the sum of its squares is least.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from solver.numeric.tape import Array
from solver.simulation.instant import Instant

NOTHING: Mapping[str, Array] = MappingProxyType({})

DEPENDENT = 1e-10
"""Singular values below this share of the largest belong to rows that others imply."""


@dataclass(frozen=True, slots=True)
class Held:
    """Accelerations (n, ...), and the forces by name: ``contact.C.normal``, ``loop.L.x``."""

    accelerations: Array
    forces: Mapping[str, Array]


@dataclass(frozen=True, slots=True)
class Row:
    """One held row: its force's name, D and G (n, N), and its bias (N,)."""

    name: str
    D: Array
    G: Array
    bias: Array


def solve(at: Instant, mode: Mapping[str, str], given: Mapping[str, Array]) -> Held:
    """Accelerations (n, N) and forces (N,) under a mode."""
    rows = [*_contacts(at, mode, given), *_loops(at)]
    force = at.applied + _pushed(at, given)
    if not rows:
        found = regular(at.mass, force.T[..., None])[..., 0].T
        return Held(np.asarray(found, dtype=float), _friction(at, mode, given, {}))
    G = np.stack([row.G for row in rows], axis=-1).transpose(1, 0, 2)
    D = np.stack([row.D for row in rows]).transpose(2, 0, 1)
    bias = np.stack([row.bias for row in rows], axis=-1)
    both = regular(at.mass, np.concatenate([G, force.T[..., None]], axis=-1))
    free = both[..., -1]
    compliance = D @ both[..., :-1]
    asked = -(D @ free[..., None])[..., 0] - bias
    shares = _least(compliance, asked)
    found = free + (both[..., :-1] @ shares[..., None])[..., 0]
    forces = {row.name: shares[:, k] for k, row in enumerate(rows)}
    return Held(np.asarray(found.T, dtype=float), _friction(at, mode, given, forces))


def regular(matrix: Array, right: Array) -> Array:
    """The solution of ``matrix @ x = right`` at every point; NaN where the matrix is singular."""
    try:
        return np.asarray(np.linalg.solve(matrix, right))
    except np.linalg.LinAlgError:
        rank = np.linalg.matrix_rank(matrix, hermitian=True)
        bad = (rank < matrix.shape[-1])[..., None, None]
        eye = np.eye(matrix.shape[-1])
        return np.where(bad, np.nan, np.linalg.solve(np.where(bad, eye, matrix), right))


def _least(matrix: Array, right: Array) -> Array:
    """The least solution of ``matrix @ x = right`` at every point, (N, rows)."""
    if not np.all(np.isfinite(matrix)):
        return np.full(right.shape, np.nan)
    return np.asarray((np.linalg.pinv(matrix, rcond=DEPENDENT) @ right[..., None])[..., 0])


def drag(at: Instant, pair: int, doing: str) -> Array | float:
    """Tangential over normal force of a sliding pair: against the slip, by Coulomb."""
    mu = float(at.parts.touch.friction[pair])
    if doing == "sliding_right":
        return -mu
    if doing == "sliding_left":
        return mu
    return -mu * np.sign(at.contacts.slips[pair]) if doing == "sliding" else 0.0


def _contacts(at: Instant, mode: Mapping[str, str], given: Mapping[str, Array]) -> list[Row]:
    rows = []
    names = at.parts.touch.names
    for name, doing in mode.items():
        pair, normal, tangential = names.index(name), *_names(name)
        touch = at.contacts
        Jn, Jt, Gn = touch.Jn[pair], touch.Jt[pair], touch.Gn[pair]
        sliding = doing != "sticking"
        if normal not in given:
            G = Gn + drag(at, pair, doing) * Jt if sliding else Gn
            rows.append(Row(normal, Jn, G, touch.gap_bias[pair]))
        if not sliding and tangential not in given:
            rows.append(Row(tangential, Jt, Jt, touch.slip_bias[pair]))
    return rows


def _names(pair: str) -> tuple[str, str]:
    return f"contact.{pair}.normal", f"contact.{pair}.tangential"


def _loops(at: Instant) -> list[Row]:
    """The force of a loop acts on the body of its second place, its reaction on the first."""
    rows = []
    for row, name in enumerate(at.parts.loop_names):
        loop = at.loops
        slopes, bias = loop.slopes[row], loop.bias[row]
        rows.append(Row(f"loop.{name}.x", slopes.real, slopes.real, bias.real))
        rows.append(Row(f"loop.{name}.y", slopes.imag, slopes.imag, bias.imag))
    return rows


def _pushed(at: Instant, given: Mapping[str, Array]) -> Array:
    """Known contact forces as generalized forces, (n, N)."""
    total = np.zeros_like(at.q)
    names = at.parts.touch.names
    for name, force in given.items():
        _, pair, word = name.split(".")
        J = at.contacts.Gn if word == "normal" else at.contacts.Jt
        total += J[names.index(pair)] * np.reshape(force, -1)
    return total


def _friction(
    at: Instant, mode: Mapping[str, str], given: Mapping[str, Array], found: Mapping[str, Array]
) -> dict[str, Array]:
    """All forces by name, those of sliding contacts and known ones too."""
    forces = dict(found)
    size = at.q.shape[1]
    for name, force in given.items():
        forces[name] = np.broadcast_to(np.reshape(force, -1), (size,))
    for name, doing in mode.items():
        normal, tangential = _names(name)
        if doing != "sticking":
            pair = at.parts.touch.names.index(name)
            forces[tangential] = drag(at, pair, doing) * forces[normal]
    return forces
