"""004: a hopper at an ice patch, in three steps."""

from typing import Any

import examples
from benchmarks.reproduce.rows import Row, Table

SEQUENCES = ("str", "stl_str", "sli_str", "sli_stl_str")

_SUMS = (
    ("actuation", 0.2050505, "sums of (u dt)^2 vanish with the step; the integral is 0.8946793"),
    ("work", 0.280342, "summed over ten nodes, without the toe's speed"),
)


_OPTIMA = {
    "str": (0.8946793, 0.25832),
    "stl_str": (0.044463, 0.11272),
    "sli_str": (0.015011, 0.01043),
}
"""Least actuation and work, by a Radau collocation written apart from the engine; the work of
``str`` smoothed as its code does, that of the others with exact absolute values.

From the ice over the left side there are many minima; none is known to be the least.
"""


def _two_steps(name: str) -> dict[str, Any]:
    """The changes that end after the second step, the least actuation squared."""
    stages = examples.load(name)["stages"][:2]
    return {"stages": stages, "objective": stages[-1]["objective"]}


def _rows(sequence: str) -> tuple[Row, ...]:
    name = f"slip_{sequence}"
    actuation, work = _OPTIMA.get(sequence, (None, None))
    return (
        Row(
            f"{sequence}, actuation squared",
            name,
            _two_steps(name),
            optimum=actuation,
            tolerance=5e-6 if sequence == "str" else 2e-4,
            refinement={"tolerance": 1e-6},
        ),
        Row(
            f"{sequence}, work",
            name,
            optimum=work,
            tolerance=2e-4,
            refinement={"tolerance": 1e-5},
        ),
        Row(f"{sequence}, random guesses", name, refinement=None, kind="random"),
    )


SLIP = Table(
    "004",
    "hopper at an ice patch",
    "Any motion, then the least actuation squared, then the least work: each step starts from "
    "the one before. The seed's sums over ten nodes are reproduced beside the integrals, which "
    "do not change with the mesh. `str` is the case that its code ships, and its work is smoothed "
    "as there; that of the others has exact absolute values.\n\n"
    "Random guesses: whole runs of all three steps, as the gallery has them, with certificate; "
    "the number is the least work that was found.\n\n"
    "![The four sequences, in the colours of the seed](images/slip.svg)",
    (
        *(
            Row(
                f"str, the seed's sum: {name}",
                "slip_str",
                {"sum": name},
                optimum=least,
                kind="sums",
                refinement=None,
                why=why,
            )
            for name, least, why in _SUMS
        ),
        *(row for sequence in SEQUENCES for row in _rows(sequence)),
    ),
)
