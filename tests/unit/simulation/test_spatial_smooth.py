"""Smooth simulations of robots in space."""

import math
from typing import Any

import pytest

from schemas.errors import BadProblem
from schemas.simulated import SimulationResult, SimulationStatus
from schemas.simulations import read_simulation
from solver.simulation import simulate

ROD = """<robot name="rod"><link name="base"/><link name="rod"><inertial>
<origin xyz="0 0 -0.5"/><mass value="1.5"/>
<inertia ixx="0.1" iyy="0.2" izz="0.05" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="j" type="continuous"><parent link="base"/><child link="rod"/>
<axis xyz="0 1 0"/></joint></robot>"""
BODY = """<robot name="body"><link name="body"><inertial><mass value="2"/>
<inertia ixx="0.1" iyy="0.2" izz="0.25" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"""


def run(text: str, duration: float, **more: Any) -> SimulationResult:
    base = more.pop("base", "fixed")
    system = {"kind": "urdf", "text": text, "base": base, **more.pop("system", {})}
    return simulate(read_simulation({"system": system, "duration": duration, **more}))


def last(result: SimulationResult) -> dict[str, float]:
    values = result.phases[0].groups["states"].values
    return {name: float(row[-1] or 0) for name, row in values.items()}


def test_a_rod_swings_as_in_the_plane() -> None:
    result = run(ROD, 2.0, initial={"j": 1.0})
    planar = {
        "kind": "mechanism",
        "bodies": {"rod": {"mass": 1.5, "inertia": 0.2, "com": [0, -0.5]}},
        "joints": {"j": {"kind": "revolute", "child": "rod"}},
    }
    same = simulate(read_simulation({"system": planar, "duration": 2, "initial": {"j": 1.0}}))
    assert last(result)["j"] == pytest.approx(last(same)["j"], abs=1e-8)
    assert result.energy is not None
    assert result.energy.drift is not None
    assert result.energy.drift < 1e-9


def test_a_body_tumbles_with_its_energy_and_flies_a_parabola() -> None:
    start = {"base.d(z)": 3, "base.d(qx)": 0.01, "base.d(qy)": 1.5, "base.d(qz)": 0.02}
    result = run(BODY, 1.0, base="floating", initial=start)
    end = last(result)
    assert end["base.z"] == pytest.approx(3 - 9.81 / 2)
    norm = math.hypot(*(end[f"base.q{one}"] for one in "wxyz"))
    assert norm == pytest.approx(1, abs=1e-8)
    assert result.energy is not None
    assert result.energy.drift is not None
    assert result.energy.drift < 1e-8


def test_controls_see_the_names_of_the_robot() -> None:
    damping = {"kind": "expressions", "values": {"motor.j.torque": "-2*d(j) - 0*rod.x"}}
    result = run(ROD, 8.0, initial={"j": 0.5}, controls=damping)
    assert abs(last(result)["j"]) < 0.05


def test_a_free_link_without_inertia_has_no_motion() -> None:
    result = run(ROD, 1.0, base="floating")
    assert result.status is SimulationStatus.INVALID_NUMBER


def test_contacts_of_robots_are_held_by_the_mode_only() -> None:
    with pytest.raises(BadProblem, match="robots in space"):
        run(ROD, 1.0, method={"kind": "time_stepping"})
