"""URDF texts: the standard's defaults, and what is refused, with line, reason and mend."""

import math

import pytest

from schemas.urdf.algebra import IDENTITY
from schemas.urdf.reading import read_robot
from schemas.urdf.xml import UrdfError
from tests.support.robots import LOOSE, TREE, joint, link, robot, system

TWO = (link("a"), link("b"))


def refused(text: str) -> UrdfError:
    with pytest.raises(UrdfError) as caught:
        read_robot(text)
    assert caught.value.hint or "needs" in caught.value.message
    return caught.value


def test_what_is_missing_is_as_the_standard_says() -> None:
    found = read_robot(robot('<link name="a"/>', link("b"), joint("j", "continuous", "a", "b")))
    one = found.joints[0]
    assert one.axis == (1.0, 0.0, 0.0)
    assert one.pose.origin == (0.0, 0.0, 0.0)
    assert one.pose.axes == IDENTITY
    assert found.links["a"].mass == 0
    assert one.limits.effort is None
    mimic = '<mimic joint="j"/>'
    text = robot(*TWO, link("c"), joint("j", "prismatic", "a", "b"))
    led = joint("k", "prismatic", "b", "c", mimic)
    follower = read_robot(text.replace("</robot>", led + "</robot>")).joints[1].mimic
    assert follower == ("j", 1.0, 0.0)


def test_roll_pitch_and_yaw_are_about_fixed_axes() -> None:
    turned = '<origin rpy="0 0 1.5707963267948966" xyz="1 2 3"/>'
    pose = read_robot(robot(*TWO, joint("j", "fixed", "a", "b", turned))).joints[0].pose
    assert pose.origin == (1.0, 2.0, 3.0)
    assert pose.axes[1][0] == 1.0  # x points along y
    assert pose.axes[0][0] == 0.0  # to the last digit: rounding is taken off


def test_zeros_of_exporters_are_no_limits() -> None:
    zeros = '<limit lower="0" upper="0" effort="0" velocity="0"/>'
    text = robot(*TWO, joint("j", "revolute", "a", "b", zeros))
    assert system(text).intervals == {}


def test_limits_bound_the_joint_its_rate_and_its_motor() -> None:
    assert system(TREE).intervals == {
        "swing": (-1, 2),
        "d(swing)": (-3, 3),
        "motor.swing.torque": (-40, 40),
    }
    assert system(TREE, limits=False).intervals == {}
    assert "motor.swing.torque" not in system(TREE, motors=["slide"]).intervals


def test_names_become_fit_for_expressions() -> None:
    text = robot(
        link("left-foot/1"), link("2nd"), joint("hip yaw", "continuous", "left-foot/1", "2nd")
    )
    found = read_robot(text)
    assert list(found.links) == ["left_foot_1", "_2nd"]
    assert system(text).coordinates == ["hip_yaw"]


def test_meshes_are_left_aside_and_told() -> None:
    drawn = '<visual><geometry><mesh filename="file:///etc/passwd"/></geometry></visual>'
    found = read_robot(robot(link("a", more=drawn)))
    assert "meshes" in found.remarks[0]


@pytest.mark.parametrize(
    ("base", "names"),
    [
        ("fixed", []),
        ("planar", ["base.x", "base.z", "base.pitch"]),
        ("floating", [f"base.{one}" for one in ("x", "y", "z", "qw", "qx", "qy", "qz")]),
    ],
)
def test_coordinates_of_the_base_come_first(base: str, names: list[str]) -> None:
    assert system(TREE, base=base).coordinates == [*names, "slide", "swing", "askew"]


def test_coordinates_of_free_joints() -> None:
    expected = ["plane.u", "plane.v", "plane.angle", "loose.x", "loose.y", "loose.z"]
    assert system(LOOSE).coordinates[:6] == expected
    assert system(LOOSE).balls == ["loose.qw"]


BAD = {
    "200,000 nested tags": ("<robot>" + "<a>" * 200_000 + "</a>" * 200_000 + "</robot>", "nested"),
    "too many elements": ("<robot>" + "<a/>" * 60_000 + "</robot>", "more than 50000"),
    "too long": ("<robot>" + " " * 2_000_001 + "</robot>", "at most 2000000"),
    "billion laughs": (
        '<!DOCTYPE r [<!ENTITY a "ha"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;">]><robot>&b;</robot>',
        "document types",
    ),
    "quadratic blowup": (
        f'<!DOCTYPE r [<!ENTITY a "{"x" * 50_000}">]><robot name="{"&a;" * 20_000}"/>',
        "document types",
    ),
    "external entity": (
        '<!DOCTYPE r [<!ENTITY a SYSTEM "file:///etc/passwd">]><robot>&a;</robot>',
        "document types",
    ),
    "external subset": ('<!DOCTYPE robot SYSTEM "http://x/y.dtd"><robot/>', "document types"),
    "unknown entity": ("<robot>&a;</robot>", "not XML"),
    "no XML": ("robot", "not XML"),
    "cut off": ("<robot><link name='a'>", "not XML"),
    "an attribute twice": ("<robot name='a' name='b'/>", "not XML"),
    "lone surrogate": ("<robot name='\ud800'/>", "no <link>"),
    "nothing": ("  ", "empty"),
    "another root": ("<sdf/>", "<sdf>"),
    "xacro": ("<robot><xacro:macro name='a'/></robot>", "no <link>"),
    "no links": ("<robot/>", "no <link>"),
    "link without name": ("<robot><link/></robot>", "no 'name'"),
    "a link twice": (robot(link("a"), link("a")), "second link 'a'"),
    "a joint twice": (
        robot(*TWO, link("c"), joint("j", "fixed", "a", "b"), joint("j", "fixed", "a", "c")),
        "second joint 'j'",
    ),
    "names that become one": (robot(link("a-b"), link("a_b")), "second link"),
    "two roots": (robot(*TWO), "two roots"),
    "a cycle": (
        robot(link("o"), *TWO, joint("j", "fixed", "a", "b"), joint("k", "fixed", "b", "a")),
        "cycle",
    ),
    "no root": (robot(*TWO, joint("j", "fixed", "a", "b"), joint("k", "fixed", "b", "a")), "cycle"),
    "itself": (robot(*TWO, joint("j", "fixed", "a", "a")), "to itself"),
    "two parents": (
        robot(*TWO, link("c"), joint("j", "fixed", "a", "c"), joint("k", "fixed", "b", "c")),
        "hangs on two joints",
    ),
    "unknown parent": (robot(*TWO, joint("j", "fixed", "A", "b")), "is no link"),
    "no child": (
        robot(*TWO, '<joint name="j" type="fixed"><parent link="a"/></joint>'),
        "no child",
    ),
    "unknown type": (robot(*TWO, joint("j", "hinge", "a", "b")), "no type"),
    "no axis": (
        robot(*TWO, joint("j", "revolute", "a", "b", '<axis xyz="0 0 0"/>')),
        "zero length",
    ),
    "two numbers": (robot(*TWO, joint("j", "fixed", "a", "b", '<origin xyz="1 2"/>')), "3 numbers"),
    "nan": (robot(link("a", math.nan)), "no number"),
    "infinite": (robot(*TWO, joint("j", "fixed", "a", "b", '<origin xyz="1e999 0 0"/>')), "number"),
    "underscores": (robot(link("a").replace('"1.0"', '"1_0"')), "no number"),
    "negative mass": (robot(link("a", -1)), "mass of 'a'"),
    "indefinite inertia": (
        robot(link("a").replace('ixy="0.002"', 'ixy="0.2"')),
        "positive definite",
    ),
    "negative inertia": (robot(link("a").replace('"0.03"', '"-0.03"')), "positive definite"),
    "a leaf without mass": (
        robot(link("a"), '<link name="b"/>', joint("j", "revolute", "a", "b")),
        "no mass",
    ),
    "limits reversed": (
        robot(*TWO, joint("j", "revolute", "a", "b", '<limit lower="1" upper="-1"/>')),
        "above the upper",
    ),
    "mimics nobody": (
        robot(*TWO, joint("j", "revolute", "a", "b", '<mimic joint="k"/>')),
        "no joint that moves",
    ),
    "mimics itself": (
        robot(*TWO, joint("j", "revolute", "a", "b", '<mimic joint="j"/>')),
        "mimics",
    ),
    "negative damping": (
        robot(*TWO, joint("j", "revolute", "a", "b", '<dynamics damping="-1"/>')),
        "damping",
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_texts_are_refused_with_place_and_mend(name: str) -> None:
    text, reason = BAD[name]
    error = refused(text)
    assert reason in error.message
    assert error.message.startswith("line ") or name in ("too long", "nothing")
