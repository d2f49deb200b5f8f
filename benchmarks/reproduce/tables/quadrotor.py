"""003, section 8.7: the quadrotor's lateral transfer."""

from benchmarks.reproduce.rows import Row, Table

_METHODS = {
    "Hermite-Simpson, 20 segments": {"kind": "hermite_simpson", "segments": 20},
    "Radau, 10 segments of 4 points": {"kind": "radau", "segments": 10, "points": 4},
}

QUADROTOR = Table(
    "8.7",
    "quadrotor",
    "The seed prints times (DirCol5i: 7.15 s and 13.6 s on two meshes; GPOPS-II: 2.02 s) and that "
    "its two values differ by 4.9e-6, but no value. As printed the equations divide the thrust by "
    "one of the two masses; a consistent geometry is solved beside it.",
    tuple(
        Row(
            f"{title}, {name}",
            example,
            {"method": method},
            printed_seconds="2.02" if method["kind"] == "radau" and title == "as printed" else "",
            optimum=optimum,
        )
        for title, example, optimum in (
            ("as printed", "quadrotor", 9.8353243),
            ("consistent", "quadrotor_consistent", 14.8080214),
        )
        for name, method in _METHODS.items()
    ),
)
