"""The simulator beside MuJoCo with stiff contacts: a box and a stick that slide, land and topple.

Run: python -m benchmarks.against_mujoco. MuJoCo is installed into an environment of its own. Its
contacts are critically damped springs, which rebound, and its contact points have a millimetre of
radius; the two agree to what that makes of it.
"""

import json
import os
import subprocess
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.peers.installing import NotInstallable, python_of
from schemas.simulations import read_simulation
from solver.simulation import simulate

SCRIPT = Path(__file__).parent / "peers" / "with_mujoco.py"
NAMES = ("body.x", "body.y", "body.angle", "body.d(x)", "body.d(y)", "body.d(angle)")
CORNERS = [[-0.5, -0.25], [0.5, -0.25]]
BOX = {"mass": 3.0, "inertia": 0.4, "gravity": -9.81}
STICK = {"mass": 1.0, "inertia": 1 / 3, "gravity": -1.0}

SOLREFS = (0.004, 0.001)
"""Time constants of the contacts, s: the stiffer, the nearer to rigid."""

REBOUND = float(np.exp(-2))
"""A critically damped spring that does not pull lets go at this share of the speed."""

SCENES: dict[str, dict[str, Any]] = {
    "a box slides to rest": {
        "points": CORNERS,
        "numbers": {**BOX, "friction": 0.4},
        "initial": [0, 0.25, 0, 1, 0, 0],
        "duration": 0.6,
    },
    "a box lands and slips on": {
        "points": CORNERS,
        "numbers": {**BOX, "friction": 0.1},
        "initial": [0, 1.0, 0.2, 3, 0, 0],
        "duration": 0.4,
    },
    "a box lands, slip reverses meanwhile": {
        "points": CORNERS,
        "numbers": {**BOX, "friction": 0.3},
        "initial": [0, 1.0, 0.2, 1, 0, 0],
        "duration": 0.45,
    },
    "a box comes to rest": {
        "points": CORNERS,
        "numbers": {**BOX, "friction": 0.9},
        "initial": [0, 0.7, 0.1, 0, 0, -1],
        "duration": 1.0,
    },
    "a stick topples and slips": {
        "points": [[0, -1]],
        "numbers": {**STICK, "friction": 0.3},
        "initial": [-np.sin(0.5), np.cos(0.5), 0.5, 0, 0, 0],
        "duration": 1.3,
    },
}


def main() -> None:
    """Print the largest differences of places and speeds."""
    try:
        python = python_of("mujoco")
    except NotInstallable as reason:
        print(f"MuJoCo cannot be installed here: {reason}")
        return
    scenes = [
        {**scene, "numbers": {**scene["numbers"], "solref": solref}}
        for scene in SCENES.values()
        for solref in SOLREFS
    ]
    command = [str(python), str(SCRIPT)]
    done = subprocess.run(  # noqa: S603 - our own command
        command,
        check=True,
        capture_output=True,
        text=True,
        input=json.dumps(scenes),
        env={**os.environ, "MUJOCO_GL": "disable"},
    )
    found = iter(json.loads(done.stdout))
    title = "against MuJoCo, largest difference"
    print(f"{title:40}{'solref':>10}{'m, rad':>10}{'per s':>10}")
    for name, scene in SCENES.items():
        state = ours(scene)
        for solref, other in zip(SOLREFS, found, strict=False):
            off = np.abs(state - np.array(other))
            print(f"{name:40}{solref:10g}{off[:3].max():10.2g}{off[3:].max():10.2g}")


def ours(scene: dict[str, Any]) -> Any:
    """The last state, by events."""
    numbers = scene["numbers"]
    points = {f"p{k}": {"body": "body", "at": at} for k, at in enumerate(scene["points"])}
    document = {
        "system": {
            "kind": "mechanism",
            "gravity": [0, numbers["gravity"]],
            "bodies": {"body": {key: numbers[key] for key in ("mass", "inertia")}},
            "joints": {"free": {"kind": "floating", "child": "body"}},
            "contacts": points,
            "surfaces": {"ground": {"friction": numbers["friction"]}},
        },
        "initial": dict(zip(NAMES, map(float, scene["initial"]), strict=True)),
        "duration": scene["duration"],
        "method": {"kind": "events", "restitution": REBOUND},
    }
    states = simulate(read_simulation(document)).phases[0].groups["states"].values
    return np.array([states[name][-1] for name in NAMES], dtype=float)


if __name__ == "__main__":
    main()
