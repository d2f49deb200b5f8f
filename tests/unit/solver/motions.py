"""Motions whose optima are known on paper, as documents that tests put together."""

from typing import Any

EXPLICIT: dict[str, Any] = {
    "kind": "second_order",
    "coordinates": ["q"],
    "controls": ["u"],
    "accelerations": {"q": "u"},
}
IMPLICIT: dict[str, Any] = {
    "kind": "second_order",
    "coordinates": ["q"],
    "controls": ["u"],
    "residual": ["2*dd(q) - 2*u"],
}
COAST: dict[str, Any] = {
    "kind": "closed_form",
    "states": {"q": "initial.q + initial.v*(t - initial.t)", "v": "initial.v"},
}
REST = {"q": 0, "d(q)": 0}


def move(name: str = "move", **changes: Any) -> dict[str, Any]:
    """A unit mass from rest to rest over one metre in one second; the least effort is 12."""
    phase = {
        "name": name,
        "system": EXPLICIT,
        "time": {"final": 1},
        "initial": REST,
        "final": {"q": 1, "d(q)": 0},
        "integrals": {"effort": "u^2"},
    }
    return phase | changes


def problem(*phases: dict[str, Any], **changes: Any) -> dict[str, Any]:
    """Phases on one mesh, judged for what they are; the effort of all of them is minimized."""
    efforts = [f"{phase['name']}.effort" for phase in phases if "effort" in phase["integrals"]]
    document = {
        "phases": list(phases),
        "objective": {"minimize": " + ".join(efforts)},
        "method": {"kind": "radau", "segments": 4, "points": 4},
        "refinement": None,
        "certificate": {"tolerance": 0.05},
    }
    return document | changes


def equal(left: str, right: str) -> dict[str, Any]:
    """A linkage."""
    return {"name": "link", "expression": f"{left} - ({right})", "lower": 0, "upper": 0}


def joined(one: str, two: str, *names: str) -> list[dict[str, Any]]:
    """Linkages that carry series over from one phase to the next."""
    return [
        equal(f"{one}.final.{name}", f"{two}.initial.{name}") | {"name": f"link{index}"}
        for index, name in enumerate(names)
    ]
