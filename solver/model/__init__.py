"""The model: frozen dataclasses built from the problem in one place."""

from solver.model.build import build_model, read_static
from solver.model.model import OPEN, Constraint, Interval, Model, Phase, Static

__all__ = [
    "OPEN",
    "Constraint",
    "Interval",
    "Model",
    "Phase",
    "Static",
    "build_model",
    "read_static",
]
