"""Exact solutions are certified, whatever the shape of the problem."""

import ast
import time
from pathlib import Path

import numpy as np
import pytest

from schemas.reading import read_problem
from schemas.results import Certificate, Check, PhaseResult
from solver.certificate import CHECKS, certify
from solver.certificate.case import COARSE_TOLERANCE
from solver.certificate.certify import AUDIT, REPORTED
from solver.certificate.held import contacts_and_loops
from solver.certificate.rollout import rollout
from tests.architecture.files import ROOT, modules
from tests.support.exact import block_problem, block_result, result


def row(certificate: Certificate, name: str) -> Check:
    return next(check for check in certificate.checks if check.name == name)


def names(certificate: Certificate) -> list[str]:
    return [check.name for check in certificate.checks]


def test_an_exact_motion_is_certified_by_the_checks_that_apply() -> None:
    certificate = certify(block_problem(), [block_result()], 12.0)
    assert certificate.verdict == "certified"
    assert names(certificate) == [
        *("interval defect", "continuity", "end values", "time", "objective"),
        "open-loop rollout",
    ]
    assert all(check.value is not None and check.value < 1e-12 for check in certificate.checks)
    assert not row(certificate, "open-loop rollout").judged


def test_every_check_has_its_row() -> None:
    problem = block_problem(
        bounds={"v": [-2, 2], "u": [-7, 7]},
        path=[{"name": "room", "expression": "x", "lower": -0.1, "upper": 1.1}],
        boundary=[{"name": "gain", "expression": "final.x - initial.x", "lower": 1}],
        linkages=[{"name": "far", "expression": "move.final.x - goal", "lower": 0}],
        static={"goal": {"bounds": [0, 1]}},
    )
    certificate = certify(problem, [block_result()], 12.0, statics={"goal": 1.0})
    assert certificate.verdict == "certified"
    apply = set(CHECKS) - {*AUDIT, *REPORTED, contacts_and_loops} | {rollout}
    assert len(certificate.checks) == len(apply)
    assert len(set(names(certificate))) == len(apply)


def test_a_single_segment_has_no_breaks_to_jump_at() -> None:
    certificate = certify(block_problem(), [block_result(segments=1)], 12.0)
    assert certificate.verdict == "certified"
    assert "continuity" not in names(certificate)


def test_a_system_may_have_no_controls_and_no_objective() -> None:
    problem = read_problem(
        {
            "phases": [
                {
                    "system": {
                        "kind": "ode",
                        "parameters": {"rate": 2, "half": "rate/2"},
                        "states": ["x"],
                        "define": {"loss": "half*x"},
                        "derivatives": {"x": "-loss + half*cos(t) + half*sin(t)"},
                    },
                    "time": {"initial": 1, "final": 3},
                }
            ]
        }
    )
    published = result({"x": np.sin}, {}, np.linspace(1, 3, 11), degree=9)
    certificate = certify(problem, [published], None)
    assert certificate.verdict == "certified"
    assert "objective" not in names(certificate)


def bang_bang(breaks: np.ndarray) -> PhaseResult:
    """The quickest metre with abs(u) <= 1: full ahead to t = 1, full astern to t = 2."""
    states = {
        "x": lambda t: np.where(t < 1, t**2 / 2, 1 - (2 - t) ** 2 / 2),
        "v": lambda t: np.where(t < 1, t, 2 - t),
    }
    return result(states, {"u": lambda t: np.where(t < 1, 1.0, -1.0)}, breaks, 2, "move")


def test_both_limits_are_taken_where_a_control_jumps() -> None:
    problem = block_problem(
        time={"initial": 0, "final": [0.1, 10]},
        bounds={"u": [-1, 1]},
        objective={"minimize": "duration"},
    )
    certificate = certify(problem, [bang_bang(np.linspace(0, 2, 5))], 2.0)
    assert certificate.verdict == "certified"
    assert all(check.value is not None and check.value < 1e-12 for check in certificate.checks)


def test_states_and_controls_may_have_different_breaks() -> None:
    coarse, fine = bang_bang(np.array([0.0, 1.0, 2.0])), bang_bang(np.linspace(0, 2, 9))
    mixed = coarse.model_copy(
        update={"curves": {"states": fine.curves["states"], "controls": coarse.curves["controls"]}}
    )
    problem = block_problem(time={"initial": 0, "final": 2}, objective={"minimize": "duration"})
    assert certify(problem, [mixed], 2.0).verdict == "certified"


@pytest.mark.parametrize(
    ("settings", "expected"),
    [
        ({"refinement": {"tolerance": 1e-6}}, 1e-5),
        ({"refinement": None}, COARSE_TOLERANCE),
        ({"refinement": None, "certificate": {"tolerance": 0.25}}, 0.25),
        ({"certificate": {"tolerance": 0.25}}, 0.25),
    ],
)
def test_the_tolerance_follows_the_settings(settings: dict, expected: float) -> None:
    certificate = certify(block_problem(**settings), [block_result()], 12.0)
    for name in ("interval defect", "continuity", "objective"):
        assert row(certificate, name).tolerance == pytest.approx(expected)


def test_it_judges_by_other_means_than_the_solver() -> None:
    """Followed through its own imports, the certificate never meets casadi or the engine."""
    queue, seen, foreign = modules("solver/certificate"), set[Path](), set[str]()
    while queue:
        path = queue.pop()
        seen.add(path)
        for name in imported(path):
            target = ROOT / f"{name.replace('.', '/')}.py"
            if name.startswith("solver.") and not target.exists():
                target = ROOT / name.replace(".", "/") / "__init__.py"
            if name.startswith("solver.") and target not in seen:
                queue.append(target)
            foreign.add(name.split(".")[0])
    rooms = {path.relative_to(ROOT).parts[1] for path in seen}
    assert rooms == {"certificate", "lowering", "mechanics", "numeric", "simulation"}
    assert "casadi" not in foreign


def imported(path: Path) -> set[str]:
    tree = ast.parse(path.read_text())
    whole = {
        alias.name
        for node in ast.walk(tree)
        if isinstance(node, ast.Import)
        for alias in node.names
    }
    parts = {node.module for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
    return whole | {name for name in parts if name}


def test_a_check_that_has_no_time_left_fails_and_says_so() -> None:
    late = certify(block_problem(), [block_result()], 12.0, until=time.monotonic() - 1)
    assert late.verdict == "not_certified"
    check = row(late, "interval defect")
    assert not check.passed
    assert check.where == "the time for the certificate is over"
