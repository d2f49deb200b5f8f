"""Small mechanisms that touch the ground."""

from typing import Any

Document = dict[str, Any]


def pendulum(*, pinned: bool, method: Document) -> Document:
    """A rod swings by a torque: on a hinge, or free in the plane and held at its end."""
    system: Document = {
        "kind": "mechanism",
        "bodies": {"rod": {"mass": 1.0, "inertia": 0.05, "com": [0, -0.5]}},
        "joints": {"hinge": {"kind": "revolute", "child": "rod"}},
        "angles": "absolute",
        "controls": ["u"],
        "torques": {"drive": {"body": "rod", "value": "u"}},
    }
    initial: Document = {"rod.angle": 0, "rod.d(angle)": 0}
    if not pinned:
        system |= {
            "joints": {"base": {"kind": "floating", "child": "rod"}},
            "contacts": {"pin": {"body": "rod"}},
            "mode": {"pin": "sticking"},
        }
        initial["rod.x"] = 0
    return {
        "name": "pendulum",
        "phases": [
            {
                "name": "swing",
                "system": system,
                "time": {"final": 0.7},
                "initial": initial,
                "final": {"rod.angle": 1.0, "rod.d(angle)": 0},
                "integrals": {"effort": "u^2"},
            }
        ],
        "objective": {"minimize": "effort"},
        "method": method,
        "refinement": None,
    }


def flat_foot(contacts: Document) -> Document:
    """A leg leans from one side to the other on a rigid foot with a toe and a heel."""
    bodies = {
        "foot": {"mass": 1.0, "inertia": 0.01, "com": [0, 0.02]},
        "leg": {"mass": 5.0, "inertia": 0.2, "com": [0, 0.5]},
    }
    ankle = {"kind": "revolute", "parent": "foot", "child": "leg", "at": [0, 0.05]}
    return {
        "name": "leaning",
        "phases": [
            {
                "name": "lean",
                "system": {
                    "kind": "mechanism",
                    "bodies": bodies,
                    "joints": {"base": {"kind": "floating", "child": "foot"}, "ankle": ankle},
                    "motors": {"ankle": {"joint": "ankle"}},
                    "contacts": {
                        "toe": {"body": "foot", "at": [0.15, 0]},
                        "heel": {"body": "foot", "at": [-0.1, 0]},
                    },
                },
                "time": {"final": 0.8},
                "initial": {"foot.x": 0, "ankle": 0.05, "d(ankle)": 0},
                "final": {"ankle": -0.05, "d(ankle)": 0},
                "integrals": {"effort": "motor.ankle.torque^2"},
            }
        ],
        "objective": {"minimize": "effort"},
        "method": {
            "kind": "hybrid",
            "transcription": {"kind": "hermite_simpson", "segments": 20},
            "sequence": [{"name": "stand", "contacts": contacts}],
        },
        "refinement": None,
    }


def slider(sequence: list[Document], **changes: Any) -> Document:
    """A block with a motor of its own that pushes it along or up; one contact under it."""
    phase: Document = {
        "name": "move",
        "system": {
            "kind": "mechanism",
            "bodies": {"block": {"mass": 2.0, "inertia": 0.1}},
            "joints": {"base": {"kind": "floating", "child": "block"}},
            "controls": ["push", "lift", "turn"],
            "forces": {
                "along": {"body": "block", "at": [0, 0], "direction": [1, 0], "value": "push"},
                "up": {"body": "block", "at": [0, 0], "direction": [0, 1], "value": "lift"},
            },
            "torques": {"turning": {"body": "block", "value": "turn"}},
            "contacts": {"foot": {"body": "block", "at": [0, -0.1]}},
            "surfaces": {"ground": {"friction": 0.5}},
        },
        "time": {"final": 1.0},
        "integrals": {"effort": "push^2 + lift^2 + turn^2"},
    }
    return {
        "name": "block",
        "phases": [phase | changes],
        "objective": {"minimize": "effort"},
        "method": {
            "kind": "hybrid",
            "transcription": {"kind": "hermite_simpson", "segments": 12},
            "sequence": sequence,
        },
        "refinement": None,
    }


def wheel(height: str) -> Document:
    """A wheel that a torque rolls half a metre along ground of some height."""
    turned = {"wheel.x": [0, 0.5], "wheel.y": [0.12, 0.15], "wheel.angle": [0, -5]}
    system = {
        "kind": "mechanism",
        "bodies": {"wheel": {"mass": 2, "inertia": 0.02}},
        "joints": {"base": {"kind": "floating", "child": "wheel"}},
        "contacts": {"rim": {"body": "wheel", "radius": 0.1}},
        "surfaces": {"ground": {"height": height, "friction": 1}},
        "controls": ["u"],
        "torques": {"drive": {"body": "wheel", "value": "u"}},
    }
    phase = {
        "name": "roll",
        "system": system,
        "time": {"final": 1.0},
        "initial": {"wheel.x": 0, "wheel.angle": 0, "wheel.d(angle)": 0},
        "final": {"wheel.x": 0.5, "wheel.d(angle)": 0},
        "integrals": {"effort": "u^2"},
        "guess": {"kind": "points", "time": [0, 1], "values": turned},
    }
    return {
        "name": "wheel",
        "phases": [phase],
        "objective": {"minimize": "effort"},
        "method": {
            "kind": "hybrid",
            "transcription": {"kind": "radau", "segments": 6},
            "sequence": [{"name": "rolling", "contacts": {"rim": "sticking"}}],
        },
        "refinement": {"tolerance": 1e-6},
    }
