"""Links and joints out of a text's elements, with the defaults of the URDF standard."""

import math
import re

from schemas.expressions.errors import quoted
from schemas.urdf.algebra import NOTHING, Matrix, Vector, rotation, scaled, similar
from schemas.urdf.algebra import least_minors as minors
from schemas.urdf.robot import MOVING, Joint, Limits, Link, Mimic, Pose
from schemas.urdf.xml import Element

KINDS = ("fixed", *MOVING)
_LONGEST = 64
_SLACK = 1e-9
"""How far below zero a tensor's minors may be, relative to its size: texts are rounded."""
_NOTHING = 1e-30
"""kg m^2; rounding of a converter."""
_OPEN = 1e9
"""A limit of this size is none."""


def plain(element: Element, attribute: str) -> str:
    """A name of the text as one that may stand in expressions."""
    given = element.text(attribute)
    name = re.sub(r"[^A-Za-z0-9_]", "_", given)
    name = f"_{name}" if name[0].isdigit() else name
    if len(name) > _LONGEST:
        element.refuse(f"the name {quoted(given)} is over {_LONGEST} characters", "shorten it")
    return name


def link(element: Element) -> Link:
    """A ``<link>``; without ``<inertial>`` it is a mere frame."""
    name, inertial = plain(element, "name"), element.only("inertial")
    if inertial is None:
        return Link(name, line=element.line)
    pose, mass = _pose(inertial), inertial.only("mass")
    value = 0.0 if mass is None else mass.number("value")
    if value < 0:
        inertial.refuse(f"the mass of '{name}' is {value:g}", "a mass is positive, in kg")
    tensor = _inertia(inertial, name)
    return Link(name, value, pose.origin, similar(pose.axes, tensor), element.line)


def _inertia(inertial: Element, name: str) -> Matrix:
    element = inertial.only("inertia")
    if element is None:
        return NOTHING
    xx, xy, xz, yy, yz, zz = (
        element.number(word, "0") for word in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
    )
    tensor = (xx, xy, xz), (xy, yy, yz), (xz, yz, zz)
    if max(abs(entry) for row in tensor for entry in row) < _NOTHING:
        return NOTHING
    size = max(abs(entry) for row in tensor for entry in row)
    if size and any(
        minor < -_SLACK * size**order for order, minor in enumerate(minors(tensor), start=1)
    ):
        mend = "it is about the centre of mass, in kg m^2; look for signs and exchanged entries"
        element.refuse(f"the inertia of '{name}' is not positive definite", mend)
    return tensor


def joint(element: Element) -> Joint:
    """A ``<joint>``."""
    name, kind = plain(element, "name"), element.text("type")
    if kind not in KINDS:
        element.refuse(f"{quoted(kind)} is no type of a joint", f"one of {', '.join(KINDS)}")
    ends = [element.only(tag) for tag in ("parent", "child")]
    if ends[0] is None or ends[1] is None:
        missing = "child" if ends[0] else "parent"
        element.refuse(f"'{name}' has no {missing}", f'write <{missing} link="..."/>')
    dynamics = element.only("dynamics")
    damping = 0.0 if dynamics is None else dynamics.number("damping", "0")
    if damping < 0:
        element.refuse(f"the damping of '{name}' is {damping:g}", "it is not negative")
    return Joint(
        name,
        kind,
        parent=plain(ends[0], "link"),
        child=plain(ends[1], "link"),
        pose=_pose(element),
        axis=_axis(element, kind),
        limits=_limits(element, kind),
        damping=damping,
        mimic=_mimic(element, kind),
        line=element.line,
    )


def _pose(element: Element) -> Pose:
    """``<origin xyz rpy>``: zeros where it is not given."""
    origin = element.only("origin")
    if origin is None:
        return Pose()
    x, y, z = origin.numbers("xyz", 3, "0 0 0")
    return Pose((x, y, z), rotation(origin.numbers("rpy", 3, "0 0 0")))


def _axis(element: Element, kind: str) -> Vector:
    axis = element.only("axis")
    if axis is None or kind in ("fixed", "floating"):
        return 1.0, 0.0, 0.0
    x, y, z = axis.numbers("xyz", 3, "1 0 0")
    length = math.hypot(x, y, z)
    if not length:
        axis.refuse("an axis of zero length", "write a direction, such as 0 0 1")
    return scaled(1 / length, (x, y, z))


def _limits(element: Element, kind: str) -> Limits:
    """Limits; zeros, which exporters write where nothing is known, count as not given."""
    given = element.only("limit")
    if given is None:
        return Limits()
    lower, upper = given.number("lower", "0"), given.number("upper", "0")
    if lower > upper:
        given.refuse(f"the lower limit {lower:g} is above the upper limit {upper:g}", "swap them")
    most = [given.number(word, "0") for word in ("velocity", "effort")]
    if min(most) < 0:
        given.refuse("'velocity' and 'effort' are sizes", "give them without a sign")
    velocity, effort = (_closed(size) if size else None for size in most)
    if kind not in ("revolute", "prismatic") or lower == upper:
        return Limits(None, None, velocity, effort)
    return Limits(_closed(lower), _closed(upper), velocity, effort)


def _closed(limit: float) -> float | None:
    return limit if abs(limit) < _OPEN else None


def _mimic(element: Element, kind: str) -> Mimic | None:
    mimic = element.only("mimic")
    if mimic is None or kind == "fixed":
        return None
    if kind in ("floating", "planar"):
        mimic.refuse(f"a {kind} joint cannot mimic", "hinges and sliders can")
    factor, offset = mimic.number("multiplier", "1"), mimic.number("offset", "0")
    return Mimic(plain(mimic, "joint"), factor, offset)
