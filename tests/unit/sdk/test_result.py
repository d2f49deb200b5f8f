"""A result as numpy arrays and as continuous curves."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from footfall import Result
from footfall.errors import BadFile
from footfall.summary import published_mesh
from schemas.results import Solution


@pytest.fixture
def result(solved: dict[str, Any]) -> Result:
    return Result(solved)


def test_what_is_wrapped_is_a_solution(solved: dict[str, Any]) -> None:
    Solution.model_validate(solved)


def test_the_head_of_a_result(result: Result) -> None:
    assert result.converged
    assert result.status == "converged"
    assert result.objective == pytest.approx(58.80767, abs=1e-4)
    assert result.certificate["verdict"] == "certified"
    assert result.mesh[-1]["max_error"] <= 1e-6
    assert result.name == "cart-pole swing-up"
    assert "converged" in repr(result)


def test_curves_pass_through_the_nodes(result: Result) -> None:
    phase = result.phase["swing_up"]
    assert set(phase.nodes) - set(phase.curves) == {"costates"}  # known at their nodes only
    for group, nodes in ((group, phase.nodes[group]) for group in phase.curves):
        for name, values in nodes.values.items():
            np.testing.assert_allclose(phase.curves[group][name](nodes.time), values, atol=1e-9)


def test_series_are_found_by_name(result: Result) -> None:
    assert result["q2"](2.0) == pytest.approx(np.pi, abs=1e-8)
    assert list(result.phases[0]) == ["q1", "q2", "v1", "v2", "u"]
    slope = result["q1"].derivative()(np.linspace(0.05, 1.95, 50))
    np.testing.assert_allclose(slope, result["v1"](np.linspace(0.05, 1.95, 50)), atol=1e-4)


def test_a_wrong_name_lists_the_right_ones(result: Result) -> None:
    with pytest.raises(KeyError, match="q1, q2"):
        result["q9"]


def test_states_come_before_other_groups(solved: dict[str, Any]) -> None:
    document = json.loads(json.dumps(solved))
    phase = document["phases"][0]
    phase["curves"]["costates"] = {
        "breaks": [0.0, 2.0],
        "coefficients": {"q1": [[99.0]], "lam": [[1.0]]},
    }
    found = Result(document).phases[0]
    assert found["q1"](2.0) == pytest.approx(1.0)
    assert found.curves["costates"]["q1"](2.0) == 99.0
    assert found["lam"](1.0) == 1.0


def test_sampling_gives_times_and_all_series(result: Result) -> None:
    sampled = result.sample(11)
    assert list(sampled) == ["time", "q1", "q2", "v1", "v2", "u"]
    assert all(values.shape == (11,) for values in sampled.values())
    assert result.sample(np.array([0.5]))["time"] == 0.5


def test_null_is_nan(solved: dict[str, Any]) -> None:
    document = json.loads(json.dumps(solved))
    document["phases"][0]["groups"]["states"]["values"]["q1"][3] = None
    assert np.isnan(Result(document).phases[0].nodes["states"].values["q1"][3])


def test_several_phases_need_a_name(solved: dict[str, Any]) -> None:
    document = solved | {"phases": solved["phases"] + [solved["phases"][0] | {"name": "again"}]}
    with pytest.raises(KeyError, match=r"result\.phase\[name\]"):
        Result(document)["q1"]


def test_save_and_load(result: Result, tmp_path: Path) -> None:
    result.save(tmp_path / "r.json")
    assert Result.load(tmp_path / "r.json").document == result.document


def test_loading_something_else_is_told(tmp_path: Path) -> None:
    (tmp_path / "p.json").write_text('{"name": "a problem"}')
    with pytest.raises(BadFile, match="no result"):
        Result.load(tmp_path / "p.json")


def test_the_mesh_told_is_that_of_the_published_curves(solved: dict[str, Any]) -> None:
    refinement = solved["mesh_refinement"]
    worse = refinement["iterations"][-1] | {"segments": 999, "max_error": 0.5}
    refinement = refinement | {"iterations": [*refinement["iterations"], worse]}
    assert published_mesh(solved | {"mesh_refinement": refinement})["segments"] == (
        len(solved["phases"][0]["knots"]) - 1
    )
    assert published_mesh(solved | {"phases": []}) == {}


def test_the_summary_says_what_matters(result: Result, infeasible: dict[str, Any]) -> None:
    text = result.summary()
    assert "objective    58.8076" in text
    assert "certified" in text
    words = Result(infeasible).summary()
    assert "locally infeasible" in words
    assert "worst" in words
