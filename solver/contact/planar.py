"""A mechanism whose contacts, joint limits and loops push by forces that are controls."""

import math
from collections.abc import Iterator

from schemas import resolve
from schemas.expressions import (
    Call,
    Expression,
    ExpressionError,
    Name,
    Number,
    Tree,
    constant,
    derivative,
)
from schemas.mechanisms import Mechanism, Prismatic, Revolute, Torque
from schemas.methods import ContactImplicit
from schemas.urdf import Urdf
from solver.complementarity import Pair
from solver.contact.adding import OPEN, Forces, Start, bound, effort, same
from solver.contact.names import ContactNames, LimitNames
from solver.hybrid.modes import friction, limited


def planar_forces(system: Mechanism, method: ContactImplicit, size: float) -> Forces:
    """The forces of a mechanism; ``size`` is a typical one, N."""
    found = Forces(system)
    for pair in system.touching:
        _touch(found, system, pair, method, size)
    if method.stops:
        _stops(found, system, size)
    for name in system.loops:
        _loop(found, name)
    found.system = system.model_copy(
        update={
            "mode": dict.fromkeys(system.touching, "split"),
            "loose": list(found.bounds),
            **(_pushed(system) if method.stops else {}),
        }
    )
    return found


def _touch(
    found: Forces, system: Mechanism, pair: str, method: ContactImplicit, size: float
) -> None:
    """Gap, slip, friction cone, and their pairs: 000, equations 8 to 13."""
    names = ContactNames(pair)
    most = method.slip_bound
    gap, slip = f"contact.{pair}.gap", Name(names.slip)
    found.gaps.append(gap)
    found.bounds |= {name: bound(0.0) for name in (names.normal, names.right, names.left)}
    found.bounds[names.slip] = bound(-most, most)
    found.bounds |= {names.gap: bound(0.0), names.speed: bound(0.0, most)}
    found.bounds |= {name: bound(0.0, 2 * most) for name in (names.ahead, names.behind)}
    found.bounds[names.spare] = bound(0.0)
    cone = _times(friction(system, pair).tree, Name(names.normal))
    found.rows += [
        same(f"{pair} gap", names.gap, Name(gap)),
        same(f"{pair} ahead", names.ahead, Call("+", (Name(names.speed), slip))),
        same(f"{pair} behind", names.behind, Call("-", (Name(names.speed), slip))),
        same(
            f"{pair} cone",
            names.spare,
            Call("-", (Call("-", (cone, Name(names.right))), Name(names.left))),
        ),
    ]
    if method.discretisation == "backward_euler":
        found.rows.append(same(f"{pair} slip", names.slip, Name(f"contact.{pair}.slip")))
    found.pairs.append(Pair(0, f"{pair} opens", names.gap, names.normal, (1.0, size), "gap"))
    if _smooth(system, pair):  # a cone without width leaves no room for a relaxation
        return
    if method.friction == "no_slip":
        found.pairs.append(
            Pair(0, f"{pair} sticks", names.speed, names.normal, (1.0, size), "slip")
        )
        return
    found.pairs += [
        Pair(0, f"{pair} slides left", names.ahead, names.right, (1.0, size), "slip"),
        Pair(0, f"{pair} slides right", names.behind, names.left, (1.0, size), "slip"),
        Pair(0, f"{pair} sticks", names.speed, names.spare, (1.0, size), "cone"),
    ]


def _smooth(system: Mechanism, pair: str) -> bool:
    """Whether a pair has no friction."""
    try:
        return constant(friction(system, pair).tree, resolve.parameters(system)) == 0
    except ExpressionError:  # the solver chooses it
        return False


def _stops(found: Forces, system: Mechanism, size: float) -> None:
    for joint, lower, upper in _limited_joints(system):
        if math.isfinite(lower):
            found.stop(joint, "lower", Call("-", (Name(joint), Number(lower))), size)
        if math.isfinite(upper):
            found.stop(joint, "upper", Call("-", (Number(upper), Name(joint))), size)


def _limited_joints(system: Mechanism) -> Iterator[tuple[str, float, float]]:
    constants = resolve.parameters(system)
    for name, joint in system.joints.items():
        if isinstance(joint, Revolute | Prismatic) and joint.limits is not None:
            lower, upper = resolve.interval(joint.limits, constants)
            yield name, lower, upper


def _pushed(system: Mechanism) -> dict[str, object]:
    """The mechanism with its stops as torques instead of limits."""
    torques, joints = dict(system.torques), dict(system.joints)
    for joint, lower, upper in _limited_joints(system):
        names, tree = LimitNames(joint), effort(joint, lower, upper)
        if tree is None:
            continue
        value = Expression(names.effort, tree)
        torques[names.effort] = Torque.model_construct(joint=joint, body=None, value=value)
        joints[joint] = system.joints[joint].model_copy(update={"limits": None})
    return {"torques": torques, "joints": joints}


def _loop(found: Forces, name: str) -> None:
    """A pin holds at every step's end."""
    for word in ("x", "y"):
        found.bounds[f"loop.{name}.{word}"] = bound(-OPEN)
        spread = f"loop.{name}#{word}"
        found.rows.append(limited(f"loop {name} {word}", spread, Name(spread), (0.0, 0.0)))
        found.starts += list(_closed(found.system, name, spread))


def _closed(system: Mechanism | Urdf, name: str, spread: str) -> Iterator[Start]:
    """A loop is closed where the phase begins, and stays so as it begins to move."""
    coordinates = tuple(system.coordinates)
    rates = tuple(derivative(one) for one in coordinates)
    for label, names, row in (
        (f"start of loop {name}", coordinates, spread),
        (f"start of loop {name} at rate", rates, derivative(spread)),
    ):
        yield names, limited(label, row, Name(f"initial.{row}"), (0.0, 0.0))


def _times(a: Tree, b: Tree) -> Tree:
    return Call("*", (a, b))
