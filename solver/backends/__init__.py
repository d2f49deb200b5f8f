"""The NLP solvers: one file each, listed here."""

from collections.abc import Mapping

from solver.backends.base import (
    ADAPTIVE,
    DEFAULT,
    FREE,
    RESCALED,
    Backend,
    NlpStatus,
    Outcome,
    Strategy,
)
from solver.backends.fatrop import Fatrop
from solver.backends.ipopt import Ipopt
from solver.backends.sqp import Sqp
from solver.backends.uno import Uno
from solver.backends.watch import FEASIBLE, Iterate, Watch

BACKENDS: Mapping[str, type[Backend]] = {
    "ipopt": Ipopt,
    "fatrop": Fatrop,
    "uno": Uno,
    "sqp": Sqp,
}
"""Name -> backend."""


def make_backend(name: str) -> Backend:
    """The backend that a problem asks for."""
    return BACKENDS[name]()


__all__ = [
    "ADAPTIVE",
    "BACKENDS",
    "DEFAULT",
    "FEASIBLE",
    "FREE",
    "RESCALED",
    "Backend",
    "Iterate",
    "NlpStatus",
    "Outcome",
    "Strategy",
    "Watch",
    "make_backend",
]
