"""003, sections 7.7 and 7.10: pushing a block."""

from benchmarks.reproduce.rows import FINE, Patch, Row, Table

BLOCK_FORCE = Table(
    "7.7",
    "block, least force",
    "The optimum is 12, with u = 6 - 12 t (equation 7.20). The seed prints no number of its own.",
    (
        Row(
            "trapezoidal, 25 segments",
            "block_min_force",
            {"method": {"kind": "trapezoidal", "segments": 25}},
            optimum=12.0,
            tolerance=1e-5,
            refined={"method": {"kind": "trapezoidal", "segments": 1000}},
            why="12 + 47 h^2: the rule's own optimum, and its quadrature of a parabola",
        ),
        Row(
            "Hermite-Simpson, 25 segments",
            "block_min_force",
            {"method": {"kind": "hermite_simpson", "segments": 25}},
            optimum=12.0,
        ),
    ),
)

_LIMIT = 20.0
_WORK = (_LIMIT * (1 - (1 - 4 / _LIMIT) ** 0.5) / 2) ** 2
_SMOOTH = {0.01: 1.1137702177, 1.0: 1.0330312090, 5.0: 0.64826364}
"""The smoothed problems' own optima: bang, then a smooth tail to the middle; own quadrature."""
_MESHES = (25, 50, 99)
_COARSE = "the sum at the nodes leaves out what abs(u v) does between them"
_EXACT: Patch = {
    "method": {"kind": "hermite_simpson", "segments": 100, "control": "linear"},
    "refinement": {"tolerance": 1e-6, "max_iterations": 8, "switches": True},
}
"""The exact absolute value: found switches, split there, make the bang-bang motion exact."""
_FINE: Patch = {"refinement": {"tolerance": 1e-6, "max_iterations": 8}}


def _work(name: str, segments: int, smooth: float | None) -> Row:
    method = {"kind": "trapezoidal", "segments": segments}
    changes: Patch = {} if smooth is None else {"nonsmooth": {"abs": {"tanh": smooth}}}
    last = segments == _MESHES[-1]
    return Row(
        f"{name}, {segments} segments",
        "block_min_work_slack",
        {"method": method, **changes},
        optimum=_WORK if smooth is None else _SMOOTH[smooth],
        tolerance=1e-6 if smooth is None else 5e-4,
        refinement=FINE if last else None,
        refined=_EXACT if smooth is None else _FINE,
        meets=last,
        why="" if last else _COARSE,
    )


BLOCK_WORK = Table(
    "7.10",
    "block, least work",
    "At most 20 N. The optimum (equation 7.52) is (20 s)^2 = 1.1145618 with full force up to "
    "s = 0.0527864 and full brake from 1 - s. Smoothing moves it: each alpha has an optimum of "
    "its own. The seed shows pictures only. The exact row is refined with a linear control and "
    "with the switches found.",
    (
        *(_work("slack", segments, None) for segments in _MESHES),
        *(
            _work(f"tanh, alpha {alpha:g}", segments, alpha)
            for alpha in _SMOOTH
            for segments in _MESHES
        ),
    ),
)
