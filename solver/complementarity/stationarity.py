"""What kind of stationary point a solution with exact complementarity is proved to be.

Scheel and Scholtes (2000), "Mathematical programs with complementarity constraints: stationarity,
optimality, and sensitivity", section 2. With the pairs' products left out of the Lagrangian, let
u and v be the multipliers of ``a >= 0`` and ``b >= 0``. Only pairs of which both members are zero
(biactive ones) matter: the point is strongly stationary if u, v >= 0 at all of them, M-stationary
if u, v > 0 or u v = 0, C-stationary if u v >= 0, and weakly stationary whatever the signs are.
Without any such pair all of these are the same.
"""

from dataclasses import dataclass

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from solver.backends import Outcome
from solver.complementarity.pairs import Pairing
from solver.nlp.task import NlpTask

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

_BOTH = 1e-6  # a member of a biactive pair, over its size
_NONE = 1e-6  # of the largest multiplier: nothing


@dataclass(frozen=True, slots=True)
class Stationarity:
    """Label, the biactive pairs (k,), and the multipliers of all members (k, 2) over sizes."""

    label: str
    biactive: Mask
    multipliers: Array


def stationarity(task: NlpTask, pairing: Pairing, outcome: Outcome) -> Stationarity | None:
    """The label that the multipliers of a polished solve prove; None where there are none.

    ``task`` is the polished one, whose pair rows are open. Where constraints depend on each other
    multipliers are not unique, and others might prove more.
    """
    rows = outcome.row_multipliers
    if rows is None or outcome.bound_multipliers is None:
        return None
    z = outcome.point.z
    slopes = task.nlp.gradient(z, [])[1].full().ravel()
    pulls = ca.mtimes(task.nlp.jacobian(z, [])[1].T, ca.DM(rows)).full().ravel()
    # What is left of the slope of the Lagrangian is what the limits hold: also of variables that
    # are fixed, whose multipliers solvers leave out.
    multipliers = (slopes + pulls)[pairing.members] / pairing.sizes
    biactive = np.asarray((np.abs(pairing.values(z)) <= _BOTH).all(axis=1))
    size = max(1.0, float(np.abs(slopes).max(initial=0.0)))
    return Stationarity(label_of(multipliers[biactive], size), biactive, multipliers)


def label_of(multipliers: Array, size: float = 1.0) -> str:
    """The label of multipliers (b, 2) at biactive pairs; what is small against ``size`` is zero."""
    none = _NONE * size
    u, v = np.where(np.abs(multipliers) <= none, 0.0, multipliers).T
    if np.all((u >= 0) & (v >= 0)):
        return "strong"
    if np.all(((u > 0) & (v > 0)) | (u * v == 0)):
        return "M"
    return "C" if np.all(u * v >= 0) else "weak"
