"""Mechanisms as forms: dotted names vary, forces are found with the accelerations."""

from typing import Any

import numpy as np

from schemas.reading import read_problem
from solver.lowering import Form, lower, lower_native
from solver.numeric import named
from tests.support.machines import double_pendulum


def ball(**more: Any) -> dict[str, Any]:
    return {
        "kind": "mechanism",
        "bodies": {"ball": {"mass": 2, "inertia": 0.1}},
        "joints": {"free": {"kind": "floating", "child": "ball"}},
        "contacts": {"foot": {"body": "ball", "at": [0, -0.5]}},
        "controls": ["push"],
        "forces": {"push": {"body": "ball", "at": [0, 0], "direction": [1, 0], "value": "push"}},
        **more,
    }


def forms(system: dict[str, Any], *series: str, **phase: Any) -> tuple[Form, ...]:
    path = [{"name": f"row{i}", "expression": one, "upper": 9} for i, one in enumerate(series)]
    only = {"system": system, "time": {"final": 1}, "path": path, **phase}
    return lower(read_problem({"phases": [only], "method": {"kind": "radau", "segments": 1}}))


def test_dotted_names_are_states_of_the_motion() -> None:
    (form,) = forms(
        ball(),
        "ball.dd(x)",
        boundary=[{"name": "speed", "expression": "final.ball.d(x) - initial.foot.vy", "upper": 1}],
    )
    names = ("ball.x", "ball.y", "ball.angle")
    assert form.states == (*names, *(f"ball.d({one[5:]})" for one in names))
    assert form.controls == ("push",)
    (group,) = form.unknowns
    assert group.names == ("ball.dd(x)", "ball.dd(y)", "ball.dd(angle)")
    assert group.labels == ("dynamics ball.x", "dynamics ball.y", "dynamics ball.angle")
    assert {"foot.vy", "foot.d(y)"} <= form.definitions.keys()


def test_forces_are_found_with_the_accelerations_and_so_are_their_rates() -> None:
    held = ball(mode={"foot": "sticking"})
    (form,) = forms(held, "contact.foot.d(normal)")
    first, second = form.unknowns
    assert first.names[3:] == ("contact.foot.normal", "contact.foot.tangential")
    assert first.labels[3] == "held acceleration contact.foot.gap"
    assert second.names[3:] == ("contact.foot.d(normal)", "contact.foot.d(tangential)")
    assert form.controls == ("d(push)",)  # forces move with the push, their rates with its rate
    kept = [(row.label, row.place, row.anchored) for row in form.holonomic]
    assert kept == [
        ("contact.foot.gap", "contact.foot.gap", True),
        ("contact.foot.slip", "contact.foot#place", False),
    ]


def test_a_standing_ball_is_carried_by_its_foot() -> None:
    (form,) = forms(ball(mode={"foot": "sticking"}), "contact.foot.normal")
    x = np.array([0.3, 0.5, 0.0, 0.0, 0.0, 0.0])
    values = named(form, ["contact.foot.normal", "contact.foot.tangential", "ball.dd(y)"])
    np.testing.assert_allclose(values(0.0, x, np.zeros(1)), [2 * 9.81, 0, 0], atol=1e-12)


def test_the_native_form_differentiates_its_own_curves() -> None:
    system = double_pendulum(motors={"elbow": {"joint": "elbow"}}).model_dump(mode="json")
    problem = read_problem(
        {
            "phases": [
                {
                    "system": system,
                    "time": {"final": 1},
                    "integrals": {
                        "jerk": "ddd(elbow)^2 + lower.ddd(x)^2 + motor.elbow.d(torque)^2"
                    },
                }
            ],
            "objective": {"minimize": "jerk"},
            "method": {"kind": "dircol5i", "segments": 3},
        }
    )
    form = lower_native(problem, 0)
    assert form.states == (
        "shoulder",
        "elbow",
        "d(shoulder)",
        "d(elbow)",
        "dd(shoulder)",
        "dd(elbow)",
    )
    assert form.controls == ("motor.elbow.torque", "motor.elbow.d(torque)")
    assert form.natives[-1] == "motor.elbow.dd(torque)"
    assert list(form.residuals) == ["dynamics shoulder", "dynamics elbow"]
