"""003, section 7.8, and section 8.9 with Table 8.3."""

from benchmarks.reproduce.rows import Patch, Row, Table

_LEFT_FIRST = {
    "kind": "points",
    "time": [0, 0.6, 1.3, 2],
    "values": {"q1": [0, -0.6, 0.6, 1], "q2": [0, 1, -1.5, 3.141592653589793]},
}
"""The cart goes left first: to the other minimum."""

_GUESSES: tuple[tuple[str, Patch, float], ...] = (
    ("the seed's guess", {}, 58.80766746),
    ("left first", {"guess": _LEFT_FIRST}, 57.94478),
)
_KINDS = (("Hermite-Simpson", "hermite_simpson", 1e-6), ("trapezoidal", "trapezoidal", 1e-4))

CART_POLE = Table(
    "7.8",
    "cart-pole swing-up",
    "25 segments. The seed prints 5.91 s and 71 iterations, but no value. Its guess (equation "
    "7.37) leads to 58.80766746; a guess in which the cart goes left first to another minimum.",
    tuple(
        Row(
            f"{guess}, {name}",
            "cart_pole",
            {"method": {"kind": kind, "segments": 25}} | dict(extra),
            printed_seconds="5.91" if kind == "hermite_simpson" and not extra else "",
            optimum=optimum,
            tolerance=tolerance,
        )
        for guess, extra, optimum in _GUESSES
        for name, kind, tolerance in _KINDS
    ),
)

_TABLE_8_3 = {
    "torque": ("2.220 218.8", "2.220 0.64", "2.234 23.88"),
    "torque_rate": ("4.610 53.94", "4.610 1.220", "4.639 13.18"),
    "jerk": ("21.39 96.21", "21.36 139.0", "21.74 663.7"),
    "snap": ("3.854 22.47", "3.768 346.7", "10.22 4929"),
}
_OPTIMA = {"torque": 2.2200666, "torque_rate": 4.6099837, "jerk": 21.357751, "snap": 3.7436}
_METHODS = {
    "DirCol5i": {"kind": "dircol5i", "segments": 25},
    "Radau": {"kind": "radau", "segments": 20, "points": 4},
    "trapezoidal": {"kind": "trapezoidal", "segments": 49},
}
_SADDLE = (
    "the force does not act on the tip where sin q = 0, so its highest derivative is free there"
)
_WHY: dict[tuple[str, str], str] = {
    ("torque_rate", "trapezoidal"): "the seed's mesh is unknown; on 47 segments ours is 4.639",
    ("jerk", "DirCol5i"): "the seed's mesh is unknown",
    ("jerk", "trapezoidal"): "the seed's mesh is unknown, and it calls its 21.74 sub-optimal",
    ("snap", "DirCol5i"): "the seed's mesh is unknown",
    ("snap", "Radau"): f"the seed's did not converge; {_SADDLE}",
    ("snap", "trapezoidal"): f"the seed calls its 10.22 far sub-optimal; {_SADDLE}",
}


def _tolerance(objective: str, method: str) -> float:
    if method == "trapezoidal":
        return 5e-5
    return 1e-5 if objective in ("jerk", "snap") else 1e-6


CART_POLE_DERIVATIVES = Table(
    "8.9",
    "cart-pole swing-up, Table 8.3",
    "The seed names neither its meshes nor its limit of the force; 25 N fits its figures and "
    "values. 25 segments of DirCol5i, 20 of Radau with four points, 49 trapezoids (50 points).",
    tuple(
        Row(
            f"{objective.replace('_', ' ')}, {method}",
            f"cart_pole_dircol5i_{objective}",
            {"method": settings},
            printed=printed,
            printed_seconds=seconds,
            optimum=_OPTIMA[objective],
            tolerance=_tolerance(objective, method),
            why=_WHY.get((objective, method), ""),
        )
        for objective, cells in _TABLE_8_3.items()
        for (method, settings), cell in zip(_METHODS.items(), cells, strict=True)
        for printed, _, seconds in (cell.partition(" "),)
    ),
)
