"""Several solves as one: stages in a row, and many guesses.

The solve itself is a parameter: each guess may have stages, and the pipeline knows of neither.
"""

from solver.campaign.minima import distinct
from solver.campaign.multistart import solve_guesses
from solver.campaign.once import SolveOnce
from solver.campaign.polished import solve_polished
from solver.campaign.stages import solve_stages

__all__ = ["SolveOnce", "distinct", "solve_guesses", "solve_polished", "solve_stages"]
