"""Any damage to a contact-implicit problem is harmless, a BadProblem, or an InvalidModel."""

import contextlib
from typing import Any

from hypothesis import given, settings
from hypothesis import strategies as st

from schemas.errors import BadProblem, InvalidModel
from schemas.reading import read_problem
from schemas.remarks import remarks
from solver.mechanics import limited
from solver.poses import check_clear
from tests.properties.test_problems import damaged

_FOOT = (
    "<robot name='hopper'><link name='box'><inertial><mass value='1'/>"
    "<inertia ixx='1' iyy='1' izz='1'/></inertial></link></robot>"
)


def _phase() -> dict[str, Any]:
    time = {"final": 1.0, "duration": [0.5, 2]}
    return {"name": "slide", "time": time, "integrals": {"effort": "1"}}


def sled() -> dict[str, Any]:
    """With a part that is welded on, a shape, pairs, a limit, and all settings of the method."""
    body = {"mass": 1, "inertia": 0.1}
    return {
        "phases": [
            _phase() | {
                "system": {
                    "kind": "mechanism",
                    "parameters": {"e": 0, "mu": 0.5},
                    "bodies": {"sled": dict(body), "plate": dict(body), "arm": dict(body)},
                    "joints": {
                        "free": {"kind": "floating", "child": "sled"},
                        "weld": {"kind": "welded", "parent": "sled", "child": "plate",
                                 "at": [0.5, 0], "to": [0.1, 0], "angle": 0.3},
                        "hip": {"kind": "revolute", "parent": "plate", "child": "arm",
                                "limits": [-1, 1]},
                    },
                    "contacts": {
                        "heel": {"body": "sled", "at": [-0.5, -0.2]},
                        "sole": {"body": "sled", "at": [0, -0.2], "radius": 0},
                        "toe": {"body": "plate", "at": [0.1, 0.1], "radius": 0},
                        "tip": {"body": "arm", "at": [0, -0.5]},
                    },
                    "shapes": {"round": {"body": "sled", "circle": 0.1}},
                    "surfaces": {"ground": {"height": "0.1*x", "friction": "mu",
                                            "restitution": "e"}},
                    "pairs": {
                        "one": {"contact": "heel", "against": "ground", "restitution": 0},
                        "two": {"contact": "sole", "against": "ground"},
                        "three": {"contact": "toe", "against": "ground", "friction": "mu/2"},
                        "four": {"contact": "tip", "against": "round"},
                    },
                    "define": {"speed": "sled.d(x)"},
                },
                "bounds": {"sled.d(x)": [-5, 5], "hip": [-0.5, 0.5]},
                "initial": {"sled.x": 0, "sled.y": 0.5, "sled.angle": 0, "hip": 0},
                "final": {"sled.x": 1},
                "periodic": {"free": ["sled.x"]},
            }
        ],
        "static": {"length": {"bounds": [0, 1], "guess": 0.5}},
        "objective": {"minimize": "effort"},
        "refinement": {"switches": False},
        "method": {
            "kind": "contact_implicit", "segments": 10, "steps": "pairwise",
            "step_bounds": [0.4, 2.0], "discretisation": "discrete_gradient",
            "relaxation": {"form": "equality", "schedule": [0.1, 0.01], "polish": True},
            "friction": "sliding", "slip_bound": 5.0, "stops": True,
        },
    }  # fmt: skip


def box() -> dict[str, Any]:
    """In space, the steps polished: which is refused, until damage takes that away."""
    contacts = {name: {"link": "box", "at": [x, 1, 0]} for name, x in (("a", 1), ("b", -1))}
    system = {"kind": "urdf", "text": _FOOT, "base": "floating", "contacts": contacts}
    polished = {"kind": "contact_implicit_polished", "steps": {"kind": "contact_implicit"}}
    return {
        "phases": [_phase() | {"system": system}],
        "objective": {"minimize": "effort"},
        "method": polished,
    }


@given(damaged(sled, sled, sled, box))
@settings(max_examples=300, deadline=None)
def test_damage_to_stepped_problems(document: Any) -> None:
    with contextlib.suppress(BadProblem):
        assert all(line.startswith("/") for line in remarks(read_problem(document)))


@given(st.dictionaries(
    st.sampled_from(["sled.x", "sled.y", "sled.angle", "hip", "toe.x", "tip.y"]),
    st.floats(-0.5, 0.5), max_size=6,
))  # fmt: skip
@settings(max_examples=20, deadline=None)
def test_any_end_is_possible_or_an_invalid_model(ends: dict[str, float]) -> None:
    document = sled()
    document["phases"][0] |= {"initial": {}, "final": ends}
    with contextlib.suppress(InvalidModel):
        check_clear(limited(read_problem(document)))


def test_the_sound_problem_is_sound() -> None:
    check_clear(limited(read_problem(sled())))
