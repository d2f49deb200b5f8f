"""Mechanisms for tests: small, and between them with everything that moves in a plane."""

from collections.abc import Callable
from typing import Any

from schemas.mechanisms import Mechanism

Build = Callable[..., Mechanism]
"""Makes a mechanism; what it is given replaces fields."""


def machine(document: dict[str, Any]) -> Mechanism:
    """A mechanism from its JSON."""
    return Mechanism.model_validate({"kind": "mechanism", **document})


def double_pendulum(**more: Any) -> Mechanism:
    """Two rods of a metre that hang from the ground."""
    rod = {"mass": "m", "inertia": "m*l^2/12", "com": [0, "-l/2"]}
    return machine(
        {
            "parameters": {"l": 1.0, "m": 1.3},
            "bodies": {"upper": rod, "lower": rod},
            "joints": {
                "shoulder": {"kind": "revolute", "child": "upper"},
                "elbow": {"kind": "revolute", "parent": "upper", "child": "lower", "at": [0, "-l"]},
            },
            **more,
        }
    )


def cart_pole(**more: Any) -> Mechanism:
    """The cart-pole of the seeds, with a point mass at the end of its pole."""
    return machine(
        {
            "parameters": {"m1": 1.0, "m2": 0.3, "l": 0.5},
            "bodies": {
                "cart": {"mass": "m1", "inertia": 0},
                "pole": {"mass": "m2", "inertia": 0, "com": [0, "-l"]},
            },
            "joints": {
                "q1": {"kind": "prismatic", "child": "cart", "axis": [2, 0]},
                "q2": {"kind": "revolute", "parent": "cart", "child": "pole"},
            },
            "motors": {"drive": {"joint": "q1"}},
            **more,
        }
    )


def chain(**more: Any) -> Mechanism:
    """Three links that float in the air, held together by hinges, a slider and springs."""
    link = {"mass": 0.8, "inertia": 0.05, "com": [0.2, 0.05]}
    return machine(
        {
            "gravity": [0.3, -9.81],
            "bodies": {"first": link, "second": link, "third": link},
            "joints": {
                "free": {"kind": "floating", "child": "first"},
                "hinge": {
                    "kind": "revolute",
                    "parent": "first",
                    "child": "second",
                    "at": [0.4, 0],
                    "to": [0, 0.05],
                    "angle": 0.3,
                },
                "slide": {
                    "kind": "prismatic",
                    "parent": "second",
                    "child": "third",
                    "at": [0.4, 0],
                    "axis": [1, 2],
                    "angle": -0.5,
                },
            },
            "springs": {
                "bend": {"joint": "hinge", "stiffness": 5, "rest": 0.2},
                "reach": {"joint": "slide", "stiffness": 40, "rest": 0.1},
                "band": {
                    "between": [{"body": "first"}, {"body": "third", "at": [0.3, 0]}],
                    "stiffness": 30,
                    "rest": 0.7,
                },
            },
            **more,
        }
    )


def crane(**more: Any) -> Mechanism:
    """Sliders on sliders, a weld and a massless frame, with everything that drives and brakes."""
    block = {"mass": 2.0, "inertia": 0.3, "com": [0.1, -0.2]}
    return machine(
        {
            "parameters": {"k": 12.0},
            "bodies": {
                "bridge": block,
                "frame": {},
                "arm": block,
                "tool": {"mass": 0.5, "inertia": 0.02, "com": [0, -0.3]},
                "ball": {"mass": 0.7, "inertia": 0.04},
            },
            "joints": {
                "travel": {"kind": "prismatic", "child": "bridge", "axis": [1, 0.2], "angle": 0.1},
                "lift": {
                    "kind": "prismatic",
                    "parent": "bridge",
                    "child": "frame",
                    "axis": [0, 1],
                    "at": [0.5, 0],
                    "to": [0.1, 0.2],
                },
                "swing": {
                    "kind": "revolute",
                    "parent": "frame",
                    "child": "arm",
                    "at": [0, 0.1],
                    "to": [0.05, 0.5],
                    "angle": 0.4,
                },
                "grip": {
                    "kind": "welded",
                    "parent": "arm",
                    "child": "tool",
                    "at": [0, -0.6],
                    "angle": 0.7,
                },
                "loose": {"kind": "floating", "child": "ball"},
            },
            "points": {"tip": {"body": "tool", "at": [0.1, -0.5]}},
            "motors": {"winch": {"joint": "lift", "gear": 3}, "turn": {"joint": "swing"}},
            "controls": ["push"],
            "define": {"lean": "tip.x + 0.3*d(swing)"},
            "springs": {
                "tendon": {
                    "between": [{"body": "bridge", "at": [1, 1]}, {"body": "tool"}],
                    "stiffness": "k",
                    "rest": 0.9,
                    "damping": 0.6,
                    "pulling_only": True,
                    "engaged": "1 + 0.5*sin(t)",
                },
                "brake": {"joint": "swing", "stiffness": 2, "rest": 0.5, "damping": 0.4},
            },
            "forces": {
                "wind": {
                    "body": "ball",
                    "at": [0.1, 0.2],
                    "direction": [3, 4],
                    "value": "push - 0.2*ball.vx^2",
                    "frame": "world",
                },
                "jet": {
                    "body": "tool",
                    "at": [0, -0.3],
                    "direction": [1, 1],
                    "value": "0.3*lean",
                },
            },
            "torques": {
                "drag": {"joint": "swing", "value": "-0.1*d(swing)*abs(d(swing))"},
                "spin": {"body": "ball", "value": "0.2*push"},
            },
            **more,
        }
    )


def rolling(height: Any = 0, **more: Any) -> Mechanism:
    """A wheel and a stick that may touch the ground, a disc that swings, and an ellipse on it."""
    return machine(
        {
            "bodies": {
                "wheel": {"mass": 1, "inertia": 0.02},
                "stick": {"mass": 1, "inertia": 0.1},
                "disc": {"mass": 1, "inertia": 0.1},
            },
            "joints": {
                "one": {"kind": "floating", "child": "wheel"},
                "two": {"kind": "floating", "child": "stick"},
                "swing": {"kind": "revolute", "child": "disc", "at": [0, 2], "to": [0, 1]},
            },
            "contacts": {
                "rim": {"body": "wheel", "at": [0.05, 0.02], "radius": 0.3},
                "toe": {"body": "stick", "at": [0.5, 0]},
                "heel": {"body": "stick", "at": [-0.5, 0]},
            },
            "surfaces": {"ground": {"height": height, "friction": 0.6}},
            "shapes": {
                "edge": {"body": "disc", "at": [0.1, 0.2], "circle": 0.4},
                "egg": {"body": "disc", "at": [-0.1, 0.1], "ellipse": [0.5, 0.3]},
            },
            "pairs": {
                "rolls": {"contact": "rim", "against": "ground"},
                "toe": {"contact": "toe", "against": "ground"},
                "heel": {"contact": "heel", "against": "ground"},
                "bump": {"contact": "rim", "against": "edge", "friction": 0.2},
                "poke": {"contact": "toe", "against": "egg"},
            },
            **more,
        }
    )
