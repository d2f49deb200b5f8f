"""The NLP solvers: one file each, listed here."""

from collections.abc import Mapping

from solver.backends.base import Backend, NlpStatus, Outcome
from solver.backends.ipopt import Ipopt
from solver.backends.watch import FEASIBLE, Iterate, Watch

BACKENDS: Mapping[str, type[Backend]] = {"ipopt": Ipopt}
"""Name -> backend."""


def make_backend(name: str) -> Backend:
    """The backend that a problem asks for."""
    return BACKENDS[name]()


__all__ = [
    "BACKENDS",
    "FEASIBLE",
    "Backend",
    "Iterate",
    "NlpStatus",
    "Outcome",
    "Watch",
    "make_backend",
]
