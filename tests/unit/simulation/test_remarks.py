"""What is hardly meant stands among a result's warnings."""

from schemas.simulations import read_simulation
from solver.simulation import simulate


def test_a_result_says_what_looks_like_degrees() -> None:
    system = {
        "kind": "mechanism",
        "bodies": {"rod": {"mass": 1, "inertia": 0.01, "com": [0, -0.5]}},
        "joints": {"pivot": {"kind": "revolute", "child": "rod"}},
    }
    given = {"system": system, "initial": {"pivot": 45}, "duration": 0.01}
    assert any("looks like degrees" in text for text in simulate(read_simulation(given)).warnings)
    assert not simulate(read_simulation({**given, "initial": {"pivot": 0.5}})).warnings
