"""How long a humanoid of 35 degrees of freedom takes from its URDF to the start of the solve.

Run: python -m benchmarks.humanoid. Reading, lowering, the functions of all stages with their
derivatives, and the search for redundant equalities, on ten segments; processor seconds.
"""

import time
from collections.abc import Iterator
from typing import Any

from schemas.events import EngineEvent, StageStarted
from schemas.reading import read_problem
from solver import solve

RUNS = 3
"""The best counts: others use the machine, too."""
AIM = 3.0
"""Seconds."""

_AXES = {"roll": "1 0 0", "pitch": "0 1 0", "yaw": "0 0 1"}
_ARM = [("shoulder", "pitch"), ("shoulder", "roll"), ("shoulder", "yaw"), ("elbow", "pitch")]
_ARM += [("wrist", "yaw"), ("wrist", "pitch"), ("wrist", "roll")]
_LEG = [("hip", "yaw"), ("hip", "roll"), ("hip", "pitch"), ("knee", "pitch")]
_LEG += [("ankle", "pitch"), ("ankle", "roll")]
_WAIST = [("waist", axis) for axis in ("yaw", "roll", "pitch")]


def main() -> None:
    """Print the seconds until the solver is called."""
    print(f"\na humanoid from URDF, best of {RUNS}, aim {AIM:g} s until the solver is called")
    for method in ("hermite_simpson", "radau"):
        seconds = min(_seconds(method) for _ in range(RUNS))
        print(f"{method:20}{seconds:8.2f} s")


def _seconds(method: str) -> float:
    began, ended = time.process_time(), list[float]()

    def hear(event: EngineEvent) -> None:
        if isinstance(event, StageStarted) and event.stage == "solve":
            ended.append(time.process_time())

    solve(read_problem(document(method)), hear, should_stop=lambda: bool(ended))
    return ended[0] - began


def document(method: str) -> dict[str, Any]:
    """A fifth of a second of flight at least torque: 6 + 29 degrees of freedom."""
    chains = [
        ("", _WAIST),
        *((side, limb) for side in ("left_", "right_") for limb in (_ARM, _LEG)),
    ]
    motors = [f"{side}{part}_{axis}" for side, limb in chains for part, axis in limb]
    start = dict.fromkeys([f"base.{one}" for one in ("x", "y", "z", "qx", "qy", "qz")], 0)
    return {
        "phases": [
            {
                "system": {"kind": "urdf", "base": "floating", "text": text()},
                "time": {"duration": 0.2},
                "initial": {**start, "base.qw": 1},
                "integrals": {"effort": " + ".join(f"motor.{one}.torque^2" for one in motors)},
            }
        ],
        "objective": {"minimize": "effort"},
        "method": {"kind": method, "segments": 10},
    }


def text() -> str:
    """Pelvis, waist, two arms, two legs; a joint is a link of its own."""
    parts = [_link("pelvis", 5.0), *_chain("pelvis", "", _WAIST, "0 0 0.1")]
    for side, across in (("left_", 0.1), ("right_", -0.1)):
        parts += _chain("waist_pitch_link", side, _ARM, f"0 {2 * across} 0.4")
        parts += _chain("pelvis", side, _LEG, f"0 {across} -0.1")
    return f'<robot name="humanoid">{"".join(parts)}</robot>'


def _chain(parent: str, side: str, limb: list[tuple[str, str]], place: str) -> Iterator[str]:
    for part, axis in limb:
        name = f"{side}{part}_{axis}"
        yield _link(f"{name}_link", 1.5)
        yield (
            f'<joint name="{name}" type="revolute"><parent link="{parent}"/>'
            f'<child link="{name}_link"/><origin xyz="{place}"/><axis xyz="{_AXES[axis]}"/></joint>'
        )
        parent, place = f"{name}_link", "0.01 0 -0.12"


def _link(name: str, mass: float) -> str:
    return (
        f'<link name="{name}"><inertial><origin xyz="0.01 0.005 -0.06"/><mass value="{mass}"/>'
        '<inertia ixx="0.01" iyy="0.01" izz="0.004" ixy="0.0003" ixz="0.0002" iyz="0.0001"/>'
        "</inertial></link>"
    )


if __name__ == "__main__":
    main()
