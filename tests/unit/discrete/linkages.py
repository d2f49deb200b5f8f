"""Mechanisms with loops and stops, for steps."""

from typing import Any

from schemas.mechanisms import Mechanism
from tests.support import machines
from tests.support.machines import machine

LOSSES = {"constant": 2.0, "coulomb": 0.3, "viscous": 0.2, "friction": 0.1, "smoothing": 0.5}


def four_bar(**more: Any) -> Mechanism:
    """Three bars on the ground whose ends a pin holds together, in absolute angles."""
    bar = {"mass": 0.9, "inertia": 0.07, "com": [0.4, 0.1]}
    return machine(
        {
            "angles": "absolute",
            "bodies": {"crank": bar, "coupler": bar, "rocker": bar},
            "joints": {
                "a": {"kind": "revolute", "child": "crank"},
                "b": {"kind": "revolute", "parent": "crank", "child": "coupler", "at": [0.8, 0]},
                "c": {"kind": "revolute", "child": "rocker", "at": [1, 0]},
            },
            "loops": {
                "pin": {
                    "between": [{"body": "coupler", "at": [1, 0]}, {"body": "rocker", "at": [1, 0]}]
                }
            },
            "motors": {"drive": {"joint": "b", "losses": LOSSES}},
            **more,
        }
    )


def limited(**more: Any) -> Mechanism:
    """A floating chain whose hinge and slider have stops: torques of the engine's own."""
    stops = {
        f"{joint}_stop": {"joint": joint, "value": f"{joint}_lower - {joint}_upper"}
        for joint in ("hinge", "slide")
    }
    sides = ("hinge_lower", "hinge_upper", "slide_lower", "slide_upper")
    return machines.chain(controls=[*sides], torques=stops, **more)
