"""Systems in space for the steps of the discrete gradient: small, and of every kind of joint."""

from typing import Any

from schemas.urdf import Urdf
from tests.support.robots import LOOSE, PENDULUM, TREE, link, robot, system

BOX = robot(link("box", 2.0))
PUSH = {"at": [0.1, -0.2, 0.3], "direction": [0.3, 0.4, 1.2], "value": "2*u + 1"}
SPOTS: dict[str, Any] = {
    "foot": {"link": "skew", "at": [0.1, 0.2, -0.3], "radius": 0.2},
    "tip": {"link": "welded", "at": [0.1, 0, 0.4]},
}
GROUND = {"height": 0.1, "friction": 0.7}


def pushed(on: str, frame: str) -> dict[str, Any]:
    force = {"link": on, "frame": frame, **PUSH}
    return {"controls": ["u"], "forces": {"push": force}}


def ball(radius: float) -> Urdf:
    """A body with a sphere about a place of its own."""
    rim = {"link": "box", "at": [0, 0, 0], "radius": radius}
    return system(BOX, base="floating", ground=GROUND, contacts={"rim": rim})


SYSTEMS: dict[str, Urdf] = {
    "pendulum": system(PENDULUM),
    "box": system(BOX, base="floating", **pushed("box", "world")),
    "ball": ball(0.3),
    "tree": system(
        TREE, base="floating", ground=GROUND, contacts=SPOTS, **pushed("skew", "link")
    ),
    "planar tree": system(TREE, base="planar", ground=GROUND, contacts=SPOTS),
    "loose": system(LOOSE),
}  # fmt: skip
