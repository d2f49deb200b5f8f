"""Mechanisms that touch, and their simulation, for tests."""

from typing import Any

import examples
from schemas.simulated import SimulationEvent, SimulationResult
from schemas.simulations import read_simulation
from solver.simulation import simulate

EVENTS = {"kind": "events"}


def run(
    system: dict[str, Any], duration: float, method: dict[str, Any] | None = None, **more: Any
) -> SimulationResult:
    """Simulate a system, by events if nothing else is said."""
    document = {"system": system, "duration": duration, "method": method or EVENTS, **more}
    return simulate(read_simulation(document))


def example(name: str, method: dict[str, Any] | None = None, **parameters: Any) -> SimulationResult:
    """Simulate an example, perhaps with other parameters or another method."""
    document = examples.load(name)
    document["system"].setdefault("parameters", {}).update(parameters)
    if method is not None:
        document["method"] = method
    return simulate(read_simulation(document))


def last(result: SimulationResult) -> dict[str, float]:
    """The last state."""
    values = result.phases[0].groups["states"].values
    return {name: float(row[-1] or 0.0) for name, row in values.items()}


def forces(result: SimulationResult, name: str) -> list[float]:
    """The values of a force."""
    return [float(one or 0.0) for one in result.phases[0].groups["forces"].values[name]]


def told(result: SimulationResult, kind: str) -> list[SimulationEvent]:
    """The events of a kind."""
    return [event for event in result.events if event.kind == kind]


def modes(result: SimulationResult) -> list[dict[str, str]]:
    """What touched, in order."""
    return [one.contacts for one in result.mode_sequence.modes] if result.mode_sequence else []


def block(friction: float, slope: float = 0.0, **more: Any) -> dict[str, Any]:
    """A point of 2 kg on a slope, with a control that pushes it along x and one along y."""
    return {
        "kind": "mechanism",
        "bodies": {"block": {"mass": 2, "inertia": 1}},
        "joints": {
            "across": {"kind": "prismatic", "child": "carriage", "axis": [1, 0]},
            "up": {"kind": "prismatic", "parent": "carriage", "child": "block", "axis": [0, 1]},
        },
        "contacts": {"skin": {"body": "block"}},
        "surfaces": {"ground": {"height": f"{slope}*x", "friction": friction}},
        "controls": ["fx", "fy"],
        "forces": {
            "right": {"body": "block", "at": [0, 0], "direction": [1, 0], "value": "fx"},
            "lift": {"body": "block", "at": [0, 0], "direction": [0, 1], "value": "fy"},
        },
        **more,
    } | {"bodies": {"carriage": {}, "block": {"mass": 2, "inertia": 1}}}


def box(friction: float = 0.6, **more: Any) -> dict[str, Any]:
    """A box of 1 m by 0.5 m that stands on two corners: more contact forces than equations."""
    return {
        "kind": "mechanism",
        "bodies": {"box": {"mass": 3, "inertia": 0.4}},
        "joints": {"free": {"kind": "floating", "child": "box"}},
        "contacts": {
            "left": {"body": "box", "at": [-0.5, -0.25]},
            "right": {"body": "box", "at": [0.5, -0.25]},
        },
        "surfaces": {"ground": {"friction": friction}},
        **more,
    }
