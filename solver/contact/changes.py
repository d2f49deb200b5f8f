"""In which steps contacts open or close."""

import numpy as np
from numpy.typing import NDArray

from schemas.results import PhaseResult

PRESSES = 1e-3
"""Of the largest force of any contact: what is less does not press."""


def changes(result: PhaseResult) -> NDArray[np.bool_]:
    """Steps before or after which something presses that does not press in them, (N,)."""
    forces = result.groups["forces"].values
    rows = [row for name, row in forces.items() if name.endswith(".normal")]
    if not rows:
        return np.zeros(len(result.knots) - 1, dtype=bool)
    sizes = np.nan_to_num(np.array(rows, dtype=float))
    presses = sizes > PRESSES * sizes.max(initial=0.0)
    other = np.any(presses[:, 1:] != presses[:, :-1], axis=0)
    return np.asarray(np.append(other, False) | np.append(False, other))
