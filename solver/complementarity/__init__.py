"""Complementarity: pairs of variables, at most one of which is above zero, and the way there."""

from solver.complementarity.complementary import Complementary
from solver.complementarity.pair import Pair
from solver.complementarity.pairs import Pairing, paired_scaling, unpaired
from solver.complementarity.relaxations import (
    FORMS,
    RELAXATION,
    relaxation_cost,
    relaxation_rows,
)
from solver.complementarity.solve import PairsWon, solve_pairs

__all__ = [
    "FORMS",
    "RELAXATION",
    "Complementary",
    "Pair",
    "Pairing",
    "PairsWon",
    "paired_scaling",
    "relaxation_cost",
    "relaxation_rows",
    "solve_pairs",
    "unpaired",
]
