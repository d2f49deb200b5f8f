"""003, section 8.8: Tables 8.1 and 8.2, four methods by five objectives by two limits."""

from math import pi

from benchmarks.reproduce.rows import Row, Table

METHODS = {
    "DirCol5i": {"kind": "dircol5i", "segments": 12},
    "Radau": {"kind": "radau", "segments": 10, "points": 4},
    "trapezoidal": {"kind": "trapezoidal", "segments": 50},
    "Chebyshev": {"kind": "chebyshev_lobatto", "segments": 1, "degree": 24},
}
"""The table's own meshes; GPOPS-II is a Radau method."""

_OBJECTIVES = ("torque", "torque_rate", "acceleration", "jerk", "snap")

_FREE = dict(
    zip(
        _OBJECTIVES,
        (9.17076217, 2.29764617, 12 * pi**2 / 125, 120 * pi**2 / 3125, 0.0),
        strict=True,
    )
)
_LIMITED = dict(
    zip(_OBJECTIVES, (9.2226032, 12.8635403, 8.2790212, 27.389489, 124.1837), strict=True)
)

_TABLE_8_1 = {
    "DirCol5i": ("9.17 4.66", "2.30 1.31", "0.948 4.58", "0.379 3.67", "0.0377 1.74"),
    "Radau": ("9.17 0.33", "2.30 0.13", "diverged", "diverged", "0.0000 0.23"),
    "trapezoidal": ("9.21 2.90", "2.30 1.23", "0.949 2.64", "0.380 2.61", "0.0000 3.36"),
    "Chebyshev": ("9.17 0.95", "2.30 1.19", "0.948 2.13", "0.379 1.57", "0.0000 1.96"),
}
_TABLE_8_2 = {
    "DirCol5i": ("9.24 5.68", "12.9 2.22", "8.29 5.46", "27.4 4.69", "129 3.28"),
    "Radau": ("9.22 0.17", "12.9 0.19", "8.06 0.26", "27.2 0.37", "diverged"),
    "trapezoidal": ("9.26 2.98", "infeasible", "8.31 6.34", "43.1 16.3", "1220 18.1"),
    "Chebyshev": ("9.22 ringing", "12.8 5.51", "8.28 ringing", "27.3 ringing", "205 ringing"),
}
_SPLINE = (
    "the seed does not say where the torque is bounded; ours, at the knots, has another value "
    "on twelve segments"
)
WHY: dict[tuple[str, str, bool], str] = {
    ("DirCol5i", "snap", False): "the printed 0.0377 is not optimal: the cubic has no snap at all",
    ("DirCol5i", "torque", True): _SPLINE,
    ("DirCol5i", "jerk", True): _SPLINE,
    ("DirCol5i", "snap", True): _SPLINE + ". The fourth derivative of a quintic is of second "
    "order: seven hundredths above on twelve segments",
    ("Radau", "acceleration", False): "the seed's diverged between its points",
    ("Radau", "jerk", False): "the seed's diverged between its points",
    ("Radau", "acceleration", True): "the printed 8.06 lies below any feasible value",
    ("Radau", "jerk", True): "the printed 27.2 lies below any feasible value",
    ("Radau", "snap", True): "the seed's diverged between its points",
    ("trapezoidal", "torque_rate", True): "the seed's stopped at an infeasible point",
    ("trapezoidal", "jerk", True): "the printed 43.1 is far above, another motion it seems",
    ("trapezoidal", "snap", True): "the printed 1220 is far above; the seed calls it sub-optimal",
    ("Chebyshev", "snap", True): "the printed 205 is far above, and rings",
}


def _tolerance(method: str, objective: str, limited: bool) -> float:
    """Of the refined objective: smooth problems, those with switches, and methods of order 2."""
    if objective == "snap" and not limited:
        return 1e-7
    if limited:
        return 1e-4
    return 2e-5 if method == "trapezoidal" else 1e-6


def _row(method: str, objective: str, limited: bool) -> Row:
    table = _TABLE_8_2 if limited else _TABLE_8_1
    printed, _, seconds = table[method][_OBJECTIVES.index(objective)].partition(" ")
    return Row(
        f"{objective.replace('_', ' ')}, {'abs(u) <= 2' if limited else 'no limit'}, {method}",
        f"pendulum_{objective}" + ("_limited" if limited else ""),
        {"method": METHODS[method]},
        printed=printed,
        printed_seconds=seconds,
        optimum=(_LIMITED if limited else _FREE)[objective],
        tolerance=_tolerance(method, objective, limited),
        why=WHY.get((method, objective, limited), ""),
    )


PENDULUM = Table(
    "8.8",
    "pendulum swing-up, Tables 8.1 and 8.2",
    "Twelve segments of DirCol5i, ten of Radau with four points, fifty trapezoids, one Chebyshev "
    "polynomial of degree 24.",
    tuple(
        _row(method, objective, limited)
        for limited in (False, True)
        for objective in _OBJECTIVES
        for method in METHODS
    ),
)
