"""Where a problem has corners, and what else its author is told."""

from api.advice import warnings
from schemas.corners import corners
from schemas.problem import Problem
from schemas.reading import read_problem
from schemas.remarks import untied
from tests.support.problems import hop


def with_corners(**fields: object) -> Problem:
    document = hop() | {"stages": []} | fields
    document["phases"][0]["integrals"]["effort"] = "abs(u)"
    document["phases"][2]["system"]["residual"] = ["dd(y) - f + max(y, 1)"]
    document["linkages"][0]["expression"] += " + sqrt(stance.final.y)"
    return read_problem(document)


def test_corners_are_told_wherever_they_are() -> None:
    assert [line.split()[:2] for line in corners(with_corners())] == [
        ["/phases/0/integrals/effort:", "abs"],
        ["/phases/2/system/residual/0:", "max"],
        ["/linkages/0/expression:", "sqrt"],
    ]


def test_corners_that_are_treated_are_not() -> None:
    smooth = with_corners(nonsmooth={"abs": {"tanh": 0.1}})
    assert [line.split()[1] for line in corners(smooth)] == ["sqrt"]
    exact = with_corners(nonsmooth={"abs": "slack"})
    assert [line.split()[1] for line in corners(exact)] == ["max", "sqrt"]


def test_advice_on_several_starts() -> None:
    problem = read_problem(hop() | {"multistart": 5})
    (line,) = warnings(problem, problem.limits)
    assert line.startswith("/multistart: ")
    assert "seeds 1 to 4" in line
    drawn = read_problem(hop() | {"multistart": 5, "guess": {"kind": "random", "seed": 3}})
    assert warnings(drawn, drawn.limits) == []


def test_phases_that_nothing_ties_together_are_told() -> None:
    assert list(untied(read_problem(hop()))) == []
    loose = read_problem(hop() | {"linkages": hop()["linkages"][:1]})
    (line,) = untied(loose)
    assert line.startswith("/linkages: nothing ties 'landing'")
    assert "link landing.initial.NAME to flight.final.NAME" in line
    assert len(list(untied(read_problem(hop() | {"linkages": []})))) == 2
