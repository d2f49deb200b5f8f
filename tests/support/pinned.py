"""States of a robot for pinocchio, an independent library of rigid bodies: the same motion."""

import re
from dataclasses import dataclass
from typing import Any

import numpy as np

from schemas.urdf import Urdf
from solver.numeric.tape import Array

QUATERNION = ("qw", "qx", "qy", "qz")


@dataclass(frozen=True, slots=True)
class Pinned:
    """A motion of pinocchio's model, and how its forces and ours are related.

    ``moves`` (nv, n) takes our accelerations to its, ``acts`` (n, nv) its forces to our rows;
    ``rows`` are those of the dynamics, without the norm's.
    """

    q: Array
    v: Array
    a: Array
    moves: Array
    acts: Array
    damping: Array
    rows: list[int]


def pinned(pin: Any, model: Any, system: Urdf, q: Array, v: Array, a: Array) -> Pinned:
    """One state (n,), its rates and accelerations."""
    n, rows = len(q), {name: row for row, name in enumerate(system.coordinates)}
    out = Pinned(
        pin.neutral(model),
        np.zeros(model.nv),
        np.zeros(model.nv),
        np.zeros((model.nv, n)),
        np.zeros((n, model.nv)),
        np.zeros(model.nv),
        list(range(n)),
    )
    if system.base == "floating":
        _float(out, rows, q, v, a)
    names = {
        re.sub(r"\W", "_", name): joint
        for name, joint in zip(model.names, model.joints, strict=True)
    }
    for one in system.carriages:
        for step in one.steps if one.joint != "base" else ():
            joint, row = names[one.joint], rows[step.coordinates[0]]
            angle = step.factor * q[row] + step.offset
            turning = joint.nq == 2  # pinocchio has cosine and sine of what turns on and on
            out.q[joint.idx_q : joint.idx_q + joint.nq] = (
                [np.cos(angle), np.sin(angle)] if turning else angle
            )
            out.v[joint.idx_v] = step.factor * v[row]
            out.a[joint.idx_v] = step.factor * a[row]
            out.moves[joint.idx_v, row] = out.acts[row, joint.idx_v] = step.factor
            out.damping[joint.idx_v] = one.damping
    return out


def _float(out: Pinned, rows: dict[str, int], q: Array, v: Array, a: Array) -> None:
    """Pinocchio's velocity of a free base is in the base's axes; the quaternion's scalar last."""
    place = [rows[f"base.{one}"] for one in "xyz"]
    turn = [rows[f"base.{one}"] for one in QUATERNION]
    p, rate, second = q[turn], v[turn], a[turn]
    size = p @ p
    G = 2 / size * _imaginary(p)
    spin = G @ rate
    R = _rotation(p)
    out.q[:3], out.q[3:7] = q[place], p[[1, 2, 3, 0]] / np.sqrt(size)
    out.v[:3], out.v[3:6] = R.T @ v[place], spin
    out.a[:3] = R.T @ a[place] - np.cross(spin, out.v[:3])
    out.a[3:6] = G @ second - 2 * (p @ rate) / size * spin
    out.moves[np.ix_(range(3), place)] = R.T
    out.moves[np.ix_(range(3, 6), turn)] = G
    out.acts[np.ix_(place, range(3))] = R
    out.acts[np.ix_(turn[1:], range(3, 6))] = np.eye(3)
    out.rows.remove(turn[0])


def _imaginary(p: Array) -> Array:
    w, x, y, z = p
    return np.array([[-x, w, z, -y], [-y, -z, w, x], [-z, y, -x, w]])


def _rotation(p: Array) -> Array:
    w, x, y, z = p / np.linalg.norm(p)
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.asarray(np.eye(3) + 2 * w * K + 2 * K @ K)
