"""003, section 7.9: the five-link biped."""

from benchmarks.reproduce.rows import Patch, Row, Table

_COARSE: Patch = {"method": {"kind": "hermite_simpson", "segments": 25}}
_FINE: Patch = {"tolerance": 1e-8, "max_iterations": 6, "max_segments": 400, "seconds": 20}

BIPED = Table(
    "7.9",
    "five-link biped",
    "Table 7.2, a step of 0.5 m in 0.7 s, from the paper's guess. The seed prints no cost. Its "
    "text puts the torso's centre of mass 0.2 m above the hip, the author's published code "
    "0.425 m: both are here. The floating base has hybrid modes and lands by an impact.",
    (
        Row(
            "minimal coordinates, Hermite-Simpson",
            "five_link_biped",
            _COARSE,
            optimum=390.790538,
            tolerance=1e-8,
            refinement=_FINE,
        ),
        Row(
            "minimal coordinates, Radau",
            "five_link_biped",
            {"method": {"kind": "radau", "segments": 8}},
            optimum=390.790538,
            tolerance=1e-8,
            refinement=_FINE,
        ),
        Row(
            "floating base, hybrid",
            "five_link_biped_floating",
            optimum=390.790538,
            tolerance=1e-8,
            refinement=_FINE,
        ),
        Row(
            "the code's torso",
            "five_link_biped_high_torso",
            _COARSE,
            optimum=469.50198,
            tolerance=1e-7,
            refinement=_FINE,
            why="469.5011 on 25 segments",
        ),
    ),
)
