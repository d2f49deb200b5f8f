"""Frames: poses along published curves, the scene, forces in the world."""

import math
from typing import Any

import numpy as np
import pytest

from footfall.curves import Curves
from schemas.frames import Frames, PlanarPoses, SpatialArrow, SpatialPoses
from schemas.mechanisms import Mechanism
from schemas.results import CurveGroup, Group, PhaseResult
from schemas.systems import Ode
from schemas.urdf import Urdf
from solver.simulation.frames import with_frames

CRANE: dict[str, Any] = {
    "kind": "mechanism",
    "parameters": {"reach": 0.5},
    "bodies": {
        "trolley": {"mass": 2, "inertia": 1, "outline": [[-0.1, 0], [0.1, 0], [0, 0.1]]},
        "boom": {"mass": 1, "inertia": "reach", "com": ["reach", 0]},
        "frame": {},
    },
    "joints": {
        "x": {"kind": "prismatic", "child": "trolley", "axis": [3, 0], "at": [0, 1]},
        "lift": {"kind": "revolute", "parent": "trolley", "child": "boom", "angle": "pi/2"},
        "fix": {"kind": "welded", "parent": "boom", "child": "frame"},
    },
    "contacts": {"tip": {"body": "boom", "at": ["2*reach", 0], "radius": 0.25}},
    "surfaces": {
        "slope": {"height": "x/2 - 3"},
        "unused": {},
    },
    "shapes": {"knob": {"body": "trolley", "circle": "reach/5"}},
    "pairs": {"touch": {"contact": "tip", "against": "slope"}},
    "springs": {
        "rope": {"between": [{"body": "ground", "at": [0, 2]}, {"body": "boom", "at": [1, 0]}]}
    },
}
END = 2.0


def crane(**changes: Any) -> Mechanism:
    return Mechanism.model_validate(CRANE | changes)


def moved(end: float = END, forces: dict[str, Any] | None = None) -> PhaseResult:
    """x goes from 0 to 1 and lift from 0 to pi/2, each on a straight line."""
    names, ends = ["x", "lift"], [[0.0, 0.0], [1.0, math.pi / 2]]
    curves = Curves.through(names, [0.0, end], [-1, 1], [ends]).to_dict()
    groups = {"forces": Group(time=[0, end], values=forces)} if forces else {}
    return PhaseResult(
        name="lifting", knots=[0.0, end], groups=groups, curves={"states": CurveGroup(**curves)}
    )


def frames(result: PhaseResult, mechanism: Mechanism | None = None) -> Frames:
    found = with_frames(result, mechanism or crane(), {}).frames
    assert found is not None
    return found


def poses(found: Frames, body: str) -> np.ndarray:
    one = found.bodies[body]
    assert isinstance(one, PlanarPoses)
    return np.array([one.x, one.y, one.angle], dtype=float)


def test_bodies_are_where_the_conventions_put_them() -> None:
    found = frames(moved())
    share = np.array(found.time) / END
    zero = np.zeros_like(share)
    assert poses(found, "trolley") == pytest.approx(np.array([share, zero + 1, zero]), abs=1e-6)
    turned = math.pi / 2 * (1 + share)
    assert poses(found, "boom") == pytest.approx(np.array([share, zero + 1, turned]), abs=1e-6)
    assert poses(found, "frame") == pytest.approx(poses(found, "boom"))


@pytest.mark.parametrize(("end", "count"), [(1e-3, 20), (1.0, 61), (2.0, 121), (1000.0, 600)])
def test_there_are_enough_frames_and_not_too_many(end: float, count: int) -> None:
    time = frames(moved(end)).time
    assert len(time) == count
    assert (time[0], time[-1]) == (0, end)


def test_a_knot_has_a_frame() -> None:
    bent = moved().model_copy(update={"knots": [0.0, 0.1234, END]})
    assert 0.1234 in frames(bent).time


def test_the_scene_is_in_numbers() -> None:
    scene = frames(moved()).scene
    assert scene.bodies["trolley"].outline == [[-0.1, 0], [0.1, 0], [0, 0.1]]
    assert scene.bodies["boom"].places == [[0, 0], [1, 0]]
    assert scene.bodies["boom"].com == [0.5, 0]
    assert scene.bodies["frame"].com is None
    rail = scene.joints["x"]
    assert (rail.kind, rail.body, rail.child) == ("prismatic", "ground", "trolley")
    assert (rail.at, rail.end) == ([0, 1], [1, 1])
    assert scene.joints["lift"].kind == "revolute"
    assert "fix" not in scene.joints
    assert scene.contacts["tip"].radius == 0.25
    assert scene.shapes["knob"].axes == pytest.approx([0.1, 0.1])
    assert [end.body for end in scene.springs["rope"]] == ["ground", "boom"]


def test_surfaces_that_may_be_touched_span_the_motion() -> None:
    surfaces = frames(moved()).scene.surfaces
    assert list(surfaces) == ["slope"]
    (start, end) = surfaces["slope"]
    assert start[0] < -1
    assert end[0] > 1
    assert [y for _, y in (start, end)] == pytest.approx([x / 2 - 3 for x, _ in (start, end)])


def test_a_bent_surface_keeps_its_shape() -> None:
    hills = {"slope": {"height": "exp(-50*(x - 0.3)^2)"}}
    line = np.array(frames(moved(), crane(surfaces=hills)).scene.surfaces["slope"]).T
    x = np.linspace(line[0, 0], line[0, -1], 1000)
    assert np.interp(x, *line) == pytest.approx(np.exp(-50 * (x - 0.3) ** 2), abs=2e-3)
    assert len(line.T) < 400


def test_forces_are_vectors_at_the_contact() -> None:
    """The slope's normal is (-1, 2)/sqrt(5), its tangent (2, 1)/sqrt(5)."""
    pushed = {"contact.touch.normal": [10, 10], "contact.touch.tangential": [5, -5]}
    found = frames(moved(forces=pushed))
    arrow = found.forces["touch"]
    root = math.sqrt(5)
    assert arrow.fx[0] == pytest.approx((-10 + 10) / root, abs=1e-6)
    assert arrow.fy[0] == pytest.approx((20 + 5) / root, abs=1e-6)
    assert arrow.fx[-1] == pytest.approx((-10 - 10) / root, abs=1e-6)
    assert (arrow.x[0], arrow.y[0]) == pytest.approx((0.25 / root, 2 - 0.5 / root), abs=1e-6)


def test_without_forces_there_are_no_arrows() -> None:
    assert frames(moved()).forces == {}


def test_what_is_no_number_is_null() -> None:
    broken = moved()
    rows: list[list[float | None]] = [[None, None]]
    group = broken.curves["states"]
    coefficients = {**group.coefficients, "x": rows}
    lost = group.model_copy(update={"coefficients": coefficients})
    found = frames(broken.model_copy(update={"curves": {"states": lost}}))
    assert np.isnan(poses(found, "trolley")[0]).all()
    assert "NaN" not in found.model_dump_json()


ROBOT = """<robot name="r"><link name="post"/><link name="arm"><inertial>
<origin xyz="0.5 0 0"/><mass value="1"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="lift" type="continuous"><origin xyz="0 0 1"/><parent link="post"/>
<child link="arm"/><axis xyz="0 1 0"/></joint></robot>"""


def test_links_in_space_have_quaternions_that_do_not_jump() -> None:
    """Four turns about y; the quaternion of an angle is (cos a/2, 0, sin a/2, 0), up to sign."""
    contacts = {"hand": {"link": "arm", "at": [1, 0, 0]}}
    robot = Urdf.model_validate({"kind": "urdf", "text": ROBOT, "contacts": contacts})
    curves = Curves.through(["lift"], [0.0, END], [-1, 1], [[[0.0], [8 * math.pi]]]).to_dict()
    states = {"states": CurveGroup(**curves)}
    turning = PhaseResult(name="turning", knots=[0.0, END], groups={}, curves=states)
    found = with_frames(turning, robot, {}).frames
    assert found is not None
    arm = found.bodies["arm"]
    assert isinstance(arm, SpatialPoses)
    assert set(arm.z) == {1.0}
    rows, half = np.array(arm.quaternion, dtype=float), 4 * math.pi * np.array(found.time) / END
    zero = np.zeros_like(half)
    assert rows * np.sign(rows[0, 0]) == pytest.approx(
        np.column_stack([np.cos(half), zero, np.sin(half), zero]), abs=1e-6
    )
    assert found.scene.bodies["arm"].places == [[0, 0, 0], [1, 0, 0]]
    assert found.scene.bodies["post"].places == [[0, 0, 0], [0, 0, 1]]
    assert found.scene.joints["lift"].at == [0, 0, 1]
    assert [point[2] for point in found.scene.surfaces["ground"]] == [0, 0]


def test_forces_in_space_act_below_the_middle_of_a_sphere() -> None:
    contacts = {"hand": {"link": "arm", "at": [1, 0, 0], "radius": 0.25}, "free": {"link": "arm"}}
    robot = Urdf.model_validate({"kind": "urdf", "text": ROBOT, "contacts": contacts})
    lift = Curves.through(["lift"], [0.0, END], [-1, 1], [[[0.0], [math.pi / 2]]])
    pushes: dict[str, list[list[float | None]]] = {
        "contact.hand.normal": [[10.0]],
        "contact.hand.tangential_y": [[-2.0]],
    }
    force = CurveGroup(breaks=[0.0, END], coefficients=pushes)
    curves = {"states": CurveGroup(**lift.to_dict()), "forces": force}
    swung = PhaseResult(name="swung", knots=[0.0, END], groups={}, curves=curves)
    found = with_frames(swung, robot, {}).frames
    assert found is not None
    assert set(found.forces) == {"hand"}
    arrow = found.forces["hand"]
    assert isinstance(arrow, SpatialArrow)
    first, last = (
        [rows[end] for rows in (arrow.x, arrow.y, arrow.z, arrow.fx, arrow.fy, arrow.fz)]
        for end in (0, -1)
    )
    assert first == pytest.approx([1, 0, 0.75, 0, -2, 10])
    assert last == pytest.approx([0, 0, -0.25, 0, -2, 10], abs=1e-12)


def test_a_system_without_bodies_has_no_frames() -> None:
    ode = Ode.model_validate({"kind": "ode", "states": ["x"], "derivatives": {"x": "1"}})
    assert with_frames(moved(), ode, {}).frames is None
    one = moved().model_copy(update={"knots": [0.0]})
    assert with_frames(one, crane(), {}).frames is None
