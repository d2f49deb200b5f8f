"""The model: frozen dataclasses built from the problem in one place."""

from solver.model.build import build_model
from solver.model.model import Constraint, Interval, Model, Phase

__all__ = ["Constraint", "Interval", "Model", "Phase", "build_model"]
