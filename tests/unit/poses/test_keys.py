"""Key poses of a guess: places by inverse kinematics, and what is out of reach is told."""

from typing import Any

import numpy as np
import pytest

from schemas.errors import BadProblem
from schemas.mechanisms import Mechanism
from schemas.problem import Problem
from schemas.reading import read_problem
from solver.pipeline import solve
from solver.poses import posed
from solver.poses.tapes import Tapes
from tests.unit.poses.test_poses import arm, four_bar

REST = {"at": 0, "values": {"shoulder": 0.5, "elbow": 0.5}}
START = {"shoulder": 0.5, "elbow": 0.5, "d(shoulder)": 0, "d(elbow)": 0}


def document(guess: dict[str, Any], system: dict[str, Any], **phase: Any) -> dict[str, Any]:
    only = {"system": {"kind": "mechanism", **system}, "time": {"final": 1}, **phase}
    return {"phases": [only], "guess": guess, "method": {"kind": "radau", "segments": 2}}


def keyed(*poses: dict[str, Any], system: dict[str, Any] | None = None, **phase: Any) -> Problem:
    guess = {"kind": "poses", "poses": list(poses)}
    return read_problem(document(guess, system or arm(), **phase))


def columns(problem: Problem) -> dict[str, list[float]]:
    guess = posed(problem).problem.phases[0].guess
    assert guess is not None
    assert guess.kind == "points"
    return {name: [float(str(one.dump())) for one in row] for name, row in guess.values.items()}


def values(problem: Problem, *names: str) -> np.ndarray:
    """Names at the key poses, (names, poses)."""
    found, system = columns(problem), problem.phases[0].system
    assert isinstance(system, Mechanism)
    tapes = Tapes(system, {})
    return tapes.at(tapes.tape(names), np.array([found[name] for name in system.coordinates]))


def test_places_are_reached_and_nothing_is_inside_of_the_ground() -> None:
    problem = keyed(
        REST, {"at": 1, "places": {"tip": [1.2, 0.4]}}, {"at": 3, "places": {"tip": [1.2, 0]}}
    )
    assert not posed(problem).remarks
    tip = values(problem, "tip.x", "tip.y", "contact.tip.gap")
    np.testing.assert_allclose(tip[:, 1:], [[1.2, 1.2], [0.4, 0.0], [0.4, 0.0]], atol=1e-8)
    found = columns(problem)
    assert found["shoulder"][0] == pytest.approx(0.5)
    assert all(0 <= one <= 2 for one in found["elbow"])  # the joint's limits


def test_a_null_leaves_a_side_open_and_pairs_bound() -> None:
    problem = keyed(REST, {"at": 1, "places": {"tip": [None, 0]}, "values": {"elbow": [1.0, 1.2]}})
    (height, elbow) = values(problem, "tip.y", "elbow")
    assert height[1] == pytest.approx(0, abs=1e-8)
    assert 1.0 - 1e-8 <= elbow[1] <= 1.2 + 1e-8


def test_what_is_left_out_stays_near_the_pose_before() -> None:
    problem = keyed(REST, {"at": 1}, {"at": 2, "values": {"shoulder": 0.6}})
    found = columns(problem)
    np.testing.assert_allclose(found["elbow"], 0.5, atol=1e-9)
    np.testing.assert_allclose(found["shoulder"], [0.5, 0.5, 0.6], atol=1e-9)


def test_velocities_are_those_of_the_lines_in_seconds_of_the_guess() -> None:
    poses = [REST, {"at": 2, "values": {"shoulder": 1.5, "elbow": 0.5}}]
    guess = {"kind": "poses", "poses": poses, "duration": 4}
    problem = read_problem(document(guess, arm(), time={"final": [0.1, 10]}))
    np.testing.assert_allclose(columns(problem)["d(shoulder)"], 0.25, atol=1e-8)


def test_the_ends_of_the_phase_hold_for_the_first_and_the_last_pose() -> None:
    problem = keyed({"at": 0}, {"at": 1}, initial=START, final={"tip.x": 1.0, "tip.y": 0.5})
    found = values(problem, "shoulder", "tip.x", "tip.y")
    np.testing.assert_allclose(found[0, 0], 0.5)
    np.testing.assert_allclose(found[1:, 1], [1.0, 0.5], atol=1e-8)


def test_loops_are_closed() -> None:
    problem = keyed(
        {"at": 0, "values": {"one": 0.3}}, {"at": 1, "values": {"one": 0.9}}, system=four_bar()
    )
    np.testing.assert_allclose(values(problem, "loop.pin#x", "loop.pin#y"), 0, atol=1e-8)


def test_what_is_out_of_reach_is_told_with_its_distance() -> None:
    far = {"at": 1, "places": {"tip": [3.0, 0.0]}}
    (remark,) = posed(keyed(REST, far)).remarks
    assert "'tip' misses it by 1 in the closest one" in remark
    assert "at 1 in phase phase" in remark


def test_a_solve_starts_from_the_poses_and_repeats_the_remark() -> None:
    system = arm(
        motors={"shoulder": {"joint": "shoulder"}, "elbow": {"joint": "elbow"}}, gravity=[0, 0]
    )
    far = {"at": 1, "places": {"tip": [0.0, 2.5]}}
    final = {"tip.x": 0.5, "tip.y": 1.5, "d(shoulder)": 0, "d(elbow)": 0}
    effort = {"effort": "motor.shoulder.torque^2 + motor.elbow.torque^2"}
    problem = keyed(REST, far, system=system, initial=START, integrals=effort)
    problem = read_problem(
        document(
            {"kind": "poses", "poses": [REST, far]},
            system,
            initial=START,
            final=final,
            integrals=effort,
        )
        | {"objective": {"minimize": "effort"}}
    )
    found = solve(problem)
    assert found.status == "converged"
    assert any("'tip' misses it by" in line for line in found.warnings)


def test_noise_about_poses_is_about_poses() -> None:
    poses = {"kind": "poses", "poses": [REST, {"at": 1, "places": {"tip": [1.0, 0.0]}}]}
    noisy = {"kind": "random", "seed": 1, "spread": 0.1, "about": poses}
    found = posed(read_problem(document(noisy, arm()))).problem.phases[0].guess
    assert found is not None
    assert found.kind == "random"
    assert found.about is not None
    assert found.about.kind == "points"


@pytest.mark.parametrize(
    ("pose", "place", "message"),
    [
        ({"at": 0}, "/guess/poses/1/at", "times increase, but 0 follows 0"),
        ({"at": 1, "places": {"tipp": [0, 0]}}, "/guess/poses/1/places/tipp", "is no place"),
        (
            {"at": 1, "values": {"d(elbow)": 0}},
            "/guess/poses/1/values/d(elbow)",
            "nothing that a pose",
        ),
        (
            {"at": 1, "values": {"elbow": [2, 1]}},
            "/guess/poses/1/values/elbow",
            "is above the upper",
        ),
        ({"at": 1, "places": {"tip": ["oops", 0]}}, "/guess/poses/1/places/tip/0", "oops"),
    ],
)
def test_poses_that_say_nothing_are_refused(pose: dict[str, Any], place: str, message: str) -> None:
    with pytest.raises(BadProblem) as error:
        keyed(REST, pose)
    (issue,) = error.value.issues
    assert issue.pointer == place
    assert message in issue.message


def test_poses_are_of_mechanisms() -> None:
    system = {"kind": "second_order", "coordinates": ["q"], "accelerations": {"q": "0"}}
    guess = {"kind": "poses", "poses": [{"at": 0}, {"at": 1}]}
    bare = {"phases": [{"system": system, "time": {"final": 1}}], "guess": guess}
    with pytest.raises(BadProblem, match="planar mechanisms"):
        read_problem(bare)
