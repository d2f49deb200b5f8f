"""What of a problem is complementary, and how that is reached."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from schemas.methods import Relaxation
from schemas.results import PhaseResult
from solver.complementarity.pair import Pair

Array = NDArray[np.float64]

Losses = Callable[[Sequence[PhaseResult], Mapping[str, float]], list[Array]]
"""From the results of all phases and the statics to what each step loses, over the actuators' work
of all phases; empty for phases without steps through contact."""


@dataclass(frozen=True, slots=True)
class Complementary:
    """The pairs of all phases, the user's settings for their relaxation, the mesh's estimator."""

    pairs: tuple[Pair, ...]
    settings: Relaxation
    losses: Losses
