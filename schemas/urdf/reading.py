"""From a URDF text to a `Robot`: one tree, every name once."""

from collections.abc import Callable, Mapping, Sequence
from typing import TypeVar

from schemas.limits import MODEL_LIMITS
from schemas.suggest import did_you_mean
from schemas.urdf import elements
from schemas.urdf.robot import HINGES, Joint, Link, Robot
from schemas.urdf.xml import Element, UrdfError, read_xml

Named = TypeVar("Named", Link, Joint)

_DRAWN = ("visual", "collision")
_ASIDE = ("gazebo", "transmission", "sensor", "ros2_control")


def read_robot(text: str) -> Robot:
    """The robot that a URDF text describes.

    Raises
    ------
    UrdfError
        With line, reason and mend.
    """
    root = read_xml(text)
    if root.tag != "robot":
        root.refuse(f"the root element is <{root.tag}>", 'URDF is <robot name="...">...</robot>')
    links = _by_name(root, "link", elements.link)
    joints = _by_name(root, "joint", elements.joint)
    if not links:
        root.refuse("there is no <link>", 'a robot has at least one <link name="..."/>')
    _known(links, joints)
    top, ordered = _tree(links, list(joints.values()))
    _followers(joints)
    _inertias(links, ordered)
    name = root.attributes.get("name", "robot")
    return Robot(name, top, links, tuple(ordered), tuple(_remarks(root)))


def _by_name(root: Element, tag: str, read: Callable[[Element], Named]) -> dict[str, Named]:
    found: dict[str, Named] = {}
    given = root.all(tag)
    most = MODEL_LIMITS.urdf_links
    if len(given) > most:
        root.refuse(f"over the limit: {len(given)} of <{tag}>, at most {most}")
    for element in given:
        one = read(element)
        if one.name in found:
            first = found[one.name].line
            mend = f"give each its own name; the first is at line {first}"
            element.refuse(f"a second {tag} '{one.name}'", mend)
        found[one.name] = one
    return found


def _known(links: Mapping[str, Link], joints: Mapping[str, Joint]) -> None:
    """Parents and children are links; no link hangs on two joints, or on itself."""
    carried: dict[str, str] = {}
    for joint in joints.values():
        for end, name in (("parent", joint.parent), ("child", joint.child)):
            if name not in links:
                mend = did_you_mean(name, links) or f'add <link name="{name}"/>'
                message = f"the {end} of '{joint.name}', '{name}', is no link"
                raise UrdfError(message, mend, joint.line)
        if joint.parent == joint.child:
            raise UrdfError(f"'{joint.name}' joins a link to itself", "name two", joint.line)
        if joint.child in carried:
            message = f"'{joint.child}' hangs on two joints, {carried[joint.child]} and "
            mend = "URDF has trees only: cut the loop at one of them"
            raise UrdfError(message + joint.name, mend, joint.line)
        carried[joint.child] = joint.name


def _tree(links: Mapping[str, Link], joints: Sequence[Joint]) -> tuple[str, list[Joint]]:
    """The one root, and the joints in an order that starts there."""
    children = {joint.child for joint in joints}
    roots = [name for name in links if name not in children]
    if len(roots) > 1:
        message = f"two roots: no joint carries '{roots[0]}', nor '{roots[1]}'"
        raise UrdfError(message, "join them, if by a fixed joint", links[roots[1]].line)
    hanging: dict[str, list[Joint]] = {}
    for joint in joints:
        hanging.setdefault(joint.parent, []).append(joint)
    ordered: list[Joint] = []
    pending = list(reversed(hanging.get(roots[0], []))) if roots else []
    while pending:
        joint = pending.pop()
        ordered.append(joint)
        pending.extend(reversed(hanging.get(joint.child, [])))
    if len(ordered) < len(joints):
        reached = {joint.name for joint in ordered}
        lost = next(joint for joint in joints if joint.name not in reached)
        message = f"a cycle: '{lost.child}' is carried by what it carries itself"
        raise UrdfError(message, "every link but the root has one parent, above it", lost.line)
    return roots[0], ordered


def _followers(joints: Mapping[str, Joint]) -> None:
    """Joints that mimic follow a hinge or slider that follows nobody."""
    for joint in joints.values():
        if joint.mimic is None:
            continue
        led = joints.get(joint.mimic.joint)
        if led is None or led.kind not in (*HINGES, "prismatic"):
            mend = did_you_mean(joint.mimic.joint, joints) or "name a hinge or a slider"
            message = f"'{joint.name}' mimics '{joint.mimic.joint}', no joint that moves"
            raise UrdfError(message, mend, joint.line)
        if led.mimic is not None:
            mend = f"write what it comes to in terms of '{led.mimic.joint}'"
            message = f"'{joint.name}' mimics '{led.name}', which mimics another one"
            raise UrdfError(message, mend, joint.line)


def _inertias(links: Mapping[str, Link], joints: Sequence[Joint]) -> None:
    """No joint moves what has no mass at all: its acceleration would be anything."""
    carried = {name: link.mass + link.inertia[0][0] for name, link in links.items()}
    for joint in reversed(joints):
        if joint.kind != "fixed" and not carried[joint.child]:
            message = f"'{joint.name}' moves '{joint.child}', which has no mass, nor what hangs on"
            mend = f"add <inertial> to '{joint.child}', or make the joint fixed"
            raise UrdfError(f"{message} it", mend, joint.line)
        carried[joint.parent] += carried[joint.child]


def _remarks(root: Element) -> list[str]:
    """What the text says and nothing here listens to."""
    found = []
    drawn = sum(len(link.all(tag)) for link in root.all("link") for tag in _DRAWN)
    if drawn:
        found.append(f"{drawn} visual and collision elements, with their meshes, are left aside")
    others = sorted({child.tag for child in root.children if child.tag in _ASIDE})
    if others:
        found.append(f"<{'>, <'.join(others)}> are left aside")
    dynamics = [joint.only("dynamics") for joint in root.all("joint")]
    if any(one is not None and one.attributes.get("friction", "0") != "0" for one in dynamics):
        found.append("the friction of joints is left aside; their damping counts")
    return found
