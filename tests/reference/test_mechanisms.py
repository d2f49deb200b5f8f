"""Systems that are given twice, by their equations and as mechanisms, have the same optimum."""

import pytest

import examples
from schemas.reading import read_problem
from solver.pipeline import solve

PAIRS = [("cart_pole", "cart_pole_mechanism"), ("quadrotor_consistent", "quadrotor_mechanism")]


@pytest.mark.parametrize("name", ["hermite_simpson", "radau"])
@pytest.mark.parametrize("pair", PAIRS, ids=[pair[1] for pair in PAIRS])
def test_the_optimum_on_the_same_mesh_is_the_same(pair: tuple[str, str], name: str) -> None:
    method = {"kind": name, "segments": 25}
    values = []
    for one in pair:
        document = {**examples.load(one), "method": method, "refinement": None}
        found = solve(read_problem(document))
        assert found.status == "converged"
        values.append(found.objective)
    assert values[0] == pytest.approx(values[1], rel=1e-9)
