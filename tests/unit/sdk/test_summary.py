"""The summary on a terminal: phases, static values, stages and minima, where there are any."""

from typing import Any

from footfall.summary import in_words, mesh_table, pass_table, summarize


def enriched(solved: dict[str, Any]) -> dict[str, Any]:
    """A result by hand that has everything: the solved phase twice, one behind the other."""
    phase = solved["phases"][0]
    later = phase | {
        "name": "rest",
        "knots": [time + 2.0 for time in phase["knots"]],
        "curves": {
            group: curves | {"breaks": [time + 2.0 for time in curves["breaks"]]}
            for group, curves in phase["curves"].items()
        },
    }
    stage = {"nlp_iterations": 7, "segments": 11, "seconds": 0.125}
    minimum = {"status": "converged", "static": {}, "phases": []}
    meshes = solved["mesh_refinement"]
    degrees = [[4, 4], [3, 8, 5], []]
    iterations = [
        mesh | {"degrees": degrees[index]} for index, mesh in enumerate(meshes["iterations"][:3])
    ]
    return solved | {
        "phases": [phase, later],
        "static": {"stiffness": 12.5, "lost": None},
        "stages": [
            stage | {"status": "iteration_limit", "objective": None},
            stage | {"status": "converged", "objective": 2.5},
        ],
        "minima": [
            minimum | {"objective": 57.94478, "verdict": "certified", "seeds": [1, 4, 9]},
            minimum | {"objective": 303.25, "verdict": "not_certified", "seeds": [2]},
        ],
        "mesh_refinement": meshes | {"iterations": iterations},
        "solver": solved["solver"] | {"strategy": "adaptive_mu"},
    }


def test_phases_static_values_stages_and_minima_are_counted(solved: dict[str, Any]) -> None:
    lines = summarize(enriched(solved)).splitlines()
    count = len(solved["phases"][0]["knots"]) - 1
    for line in (
        f"  phase        swing_up: 0 to 2 s, {count} segments",
        f"  phase        rest: 2 to 4 s, {count} segments",
        "  static       stiffness = 12.5",
        "  static       lost = -",
        "  stages       2 solved in a row",
        "  minima       2 distinct, from 4 guesses that led to a motion",
    ):
        assert line in lines
    assert any(line.endswith("on the last mesh, strategy adaptive mu") for line in lines)


def test_switches_are_told_with_their_times(solved: dict[str, Any]) -> None:
    meshes = solved["mesh_refinement"]
    split = [mesh | {"switches": [0.38196601125, 2.5]} for mesh in meshes["iterations"]]
    text = summarize(solved | {"mesh_refinement": meshes | {"iterations": split}})
    assert "  switches     controls switch at t = 0.381966, 2.5 s" in text.splitlines()


def test_a_plain_result_says_no_more_than_before(solved: dict[str, Any]) -> None:
    plain = summarize(solved)
    for word in ("phase  ", "static", "stages", "minima", "strategy"):
        assert word not in plain
    assert "Stages" not in in_words(solved)


def test_the_tables_of_stages_and_minima(solved: dict[str, Any]) -> None:
    rows = [line.split() for line in in_words(enriched(solved)).splitlines()]
    for row in (
        "1 - 11 7 0.125 iteration limit",
        "2 2.5 11 7 0.125 converged",
        "1 57.94478 converged certified 1, 4, 9",
        "2 303.25 converged NOT certified 2",
    ):
        assert row.split() in rows
    assert ["Trajectory", "of", "rest", "(t", "in", "s)"] in rows


def test_degrees_of_each_mesh(solved: dict[str, Any]) -> None:
    head, *rows = mesh_table(enriched(solved)).splitlines()
    assert head.split()[:3] == ["mesh", "segments", "degrees"]
    told = [row.split()[2:5] for row in rows]
    assert told[0][0] == "4"
    assert told[1] == ["3", "to", "8"]
    assert all(row[0] == "-" for row in told[2:])


def test_the_homotopy_is_told(solved: dict[str, Any]) -> None:
    one = {"form": "equality", "status": "optimal", "nlp_iterations": 7, "seconds": 0.125}
    found = {
        "form": "equality",
        "passes": [
            one | {"relaxation": 0.1, "objective": 2.5, "residual": 0.1},
            one | {"relaxation": 0.01, "objective": None, "residual": None, "form": "inequality"},
        ],
        "polished": True,
        "residual": 1.25e-9,
        "stationarity": "strong",
        "pinned": 1,
        "dissipation": 0.031,
    }
    result = solved | {"complementarity": found}
    line = (
        "  contact      complementary within 1.25e-09, polished, stationary: strong, "
        "1 pair pinned by the ends, steps lose 3.1 % of the actuators' work"
    )
    assert line in summarize(result).splitlines()
    rows = pass_table(result).splitlines()
    assert rows[1].split() == ["0.1", "equality", "0.1", "2.5", "7", "0.125", "optimal"]
    assert rows[2].split() == ["0.01", "inequality", "-", "-", "7", "0.125", "optimal"]
    assert rows[1] in in_words(result)
    rough = found | {"polished": False, "stationarity": None, "pinned": 0, "dissipation": None}
    line = "  contact      complementary within 1.25e-09, not polished"
    assert line in summarize(solved | {"complementarity": rough}).splitlines()
    assert "contact" not in summarize(solved)
