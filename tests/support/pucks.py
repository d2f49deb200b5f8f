"""Small urdf systems on the ground, stepped through contact: a point mass, and a solid ball."""

import math
from collections.abc import Mapping
from typing import Any

from schemas.problem import Problem
from schemas.reading import read_problem

G = 9.81
FRICTION = 0.3
RADIUS = 0.1

POINT = """<robot name="puck"><link name="ground"/><link name="along"/><link name="across"/>
<link name="puck"><inertial><mass value="1"/></inertial></link>
<joint name="x" type="prismatic"><parent link="ground"/><child link="along"/>
<axis xyz="1 0 0"/><limit lower="-9" upper="9" effort="99" velocity="99"/></joint>
<joint name="y" type="prismatic"><parent link="along"/><child link="across"/>
<axis xyz="0 1 0"/><limit lower="-9" upper="9" effort="99" velocity="99"/></joint>
<joint name="z" type="prismatic"><parent link="across"/><child link="puck"/>
<axis xyz="0 0 1"/><limit lower="-0.1" upper="9" effort="99" velocity="99"/></joint></robot>"""

BALL = """<robot name="ball"><link name="ball"><inertial><mass value="1"/>
<inertia ixx="0.004" iyy="0.004" izz="0.004" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"""


def sliding(speed: float = 2.0, wind: float = 0.0, turn: float = 0.0, **method: Any) -> Problem:
    """A point mass that slides at ``speed``, with a force across, N, all turned about z."""
    c, s = math.cos(turn), math.sin(turn)
    start = {"x": 0, "y": 0, "z": 0, "d(x)": speed * c, "d(y)": speed * s, "d(z)": 0}
    force = {"link": "puck", "direction": [-s, c, 0], "value": wind}
    system = {
        "kind": "urdf",
        "text": POINT,
        "limits": False,
        "motors": [],
        "contacts": {"rim": {"link": "puck"}},
        "forces": {"wind": force},
    }
    return _problem(system, start, **method)


def falling(**method: Any) -> Problem:
    """The point mass above its lower stop, with no ground below it."""
    start = {"x": 0, "y": 0, "z": 0, "d(x)": 0, "d(y)": 0, "d(z)": 0}
    return _problem({"kind": "urdf", "text": POINT, "motors": []}, start, **method)


def ball(**method: Any) -> Problem:
    """A solid ball that slides at first, along 3:4, and then rolls."""
    start = {"base.x": 0, "base.y": 0, "base.z": RADIUS, "base.qw": 1}
    start |= dict.fromkeys(("base.qx", "base.qy", "base.qz"), 0)
    start |= {"base.d(x)": 0.6, "base.d(y)": 0.8, "base.d(z)": 0}
    start |= {f"base.d({one})": 0 for one in ("qw", "qx", "qy", "qz")}
    contact = {"link": "ball", "radius": RADIUS}
    system = {"kind": "urdf", "text": BALL, "base": "floating", "contacts": {"cloth": contact}}
    return _problem(system, start, **method)


def _problem(system: dict[str, Any], start: Mapping[str, float], **method: Any) -> Problem:
    kind = {"kind": "contact_implicit", "segments": 10, "steps": "fixed"}
    phase = {
        "name": "slide",
        "system": {**system, "ground": {"friction": FRICTION}},
        "time": {"final": 0.6},
        "initial": start,
    }
    return read_problem(
        {"name": "sliding", "phases": [phase], "method": {**kind, **method}, "refinement": None}
    )
