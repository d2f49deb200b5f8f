"""A urdf system whose contacts and joint limits push by forces that are controls.

The friction cone is that of some directions around the normal: a polygon in the circle, which comes
to it as the directions get many. Friction takes as much energy as such a cone allows: where all of
it is spent, it pushes along the directions against which the slip is fastest. In the plane, with
the two directions that are there, these are equations 8 to 13 of 000.
"""

import math
from collections.abc import Iterator

from schemas.expressions import Call, Expression, Name, Number, Tree, derivative
from schemas.methods import ContactImplicit
from schemas.phases import Constraint
from schemas.urdf import Urdf
from solver.complementarity import Pair
from solver.contact.adding import Forces, bound, effort, same
from solver.contact.names import LimitNames, SpaceNames
from solver.hybrid.modes import limited
from solver.mechanics.trees import less, plus, times

Direction = tuple[float, float]


def spatial_forces(system: Urdf, method: ContactImplicit, size: float) -> Forces:
    """The forces of a system; ``size`` is a typical one, N."""
    found, define = Forces(system), dict(system.define)
    for name in system.touching:
        define |= _touch(found, name, system.ground.friction.tree, method, size)
    for joint, lower, upper in stopped(system) if method.stops else ():
        tree, names = effort(joint, lower, upper), LimitNames(joint)
        if tree is not None:
            define[names.effort] = Expression(names.effort, tree)
        if math.isfinite(lower):
            found.stop(joint, "lower", Call("-", (Name(joint), Number(lower))), size)
        if math.isfinite(upper):
            found.stop(joint, "upper", Call("-", (Number(upper), Name(joint))), size)
    found.system = _copy(
        system,
        mode=dict.fromkeys(system.touching, "split"),
        controls=[*system.controls, *found.bounds],
        define=define,
    )
    found.starts += _norms(system)
    return found


def around(count: int) -> list[Direction]:
    """Unit vectors along the ground, an even number, x first; opposite ones are exactly so."""
    angles = [2 * math.pi * k / count for k in range(count // 2)]
    half = [(math.cos(one), math.sin(one)) for one in angles]
    exact = [(round(x, 15), round(y, 15)) for x, y in half]  # axes without dust
    return [*exact, *((-x, -y) for x, y in exact)]


def stopped(system: Urdf) -> Iterator[tuple[str, float, float]]:
    """Joints with limits of their coordinates, and these."""
    for name, limits in system.intervals.items():
        if name in system.coordinates:
            yield name, *limits


def _touch(
    found: Forces, name: str, friction: Tree, method: ContactImplicit, size: float
) -> dict[str, Expression]:
    """Gap, slip, friction cone, and their pairs; the friction along x and y."""
    names, most = SpaceNames(name), method.slip_bound
    directions = around(method.directions)
    gap = f"contact.{name}.gap"
    found.gaps.append(gap)
    found.bounds |= {names.normal: bound(0.0), names.gap: bound(0.0), names.spare: bound(0.0)}
    found.bounds |= {names.speed: bound(0.0, most)}
    found.bounds |= {slip: bound(-most, most) for slip in names.slips}
    found.rows.append(same(f"{name} gap", names.gap, Name(gap)))
    by_ends = method.discretisation == "backward_euler"  # else a slip's row spans the step
    for axis, slip in zip("xy", names.slips, strict=True) if by_ends else ():
        found.rows.append(same(f"{name} slip {axis}", slip, Name(f"contact.{name}.slip_{axis}")))
    pushes = [names.push(k) for k in range(len(directions))]
    for k, (push, direction) in enumerate(zip(pushes, directions, strict=True)):
        found.bounds |= {push: bound(0.0), names.ahead(k): bound(0.0, 2 * most)}
        along = _sum(direction, names.slips)
        found.rows.append(same(f"{name} ahead {k}", names.ahead(k), plus(Name(names.speed), along)))
    spent = plus(*(Name(push) for push in pushes))
    cone = less(times(friction, Name(names.normal)), spent)
    found.rows.append(same(f"{name} cone", names.spare, cone))
    found.pairs += _pairs(names, pushes, method, size)
    columns = zip(names.tangential, zip(*directions, strict=True), strict=True)
    return {word: Expression(word, _sum(column, pushes)) for word, column in columns}


def _pairs(
    names: SpaceNames, pushes: list[str], method: ContactImplicit, size: float
) -> Iterator[Pair]:
    pair, sizes = names.pair, (1.0, size)
    yield Pair(0, f"{pair} opens", names.gap, names.normal, sizes, "gap")
    if method.friction == "no_slip":
        yield Pair(0, f"{pair} sticks", names.speed, names.normal, sizes, "slip")
        return
    for k, push in enumerate(pushes):
        yield Pair(0, f"{pair} slides {k}", names.ahead(k), push, sizes, "slip")
    yield Pair(0, f"{pair} sticks", names.speed, names.spare, sizes, "cone")


def _sum(factors: tuple[float, ...], names: list[str] | tuple[str, ...]) -> Tree:
    """The sum of some names, each by its factor."""
    terms = zip(factors, names, strict=True)
    return plus(*(times(Number(factor), Name(name)) for factor, name in terms if factor))


def _norms(system: Urdf) -> Iterator[tuple[tuple[str, ...], Constraint]]:
    """Quaternions start with the norm 1, and at rest along it."""
    for first in system.balls:
        prefix = first.rpartition(".")[0]
        parts = tuple(f"{prefix}.{name}" for name in ("qw", "qx", "qy", "qz"))
        norm, label = f"{prefix}.norm", f"start of {prefix}.norm"
        yield parts, limited(label, label, Name(f"initial.{norm}"), (1.0, 1.0))
        rates, label = tuple(map(derivative, parts)), f"start of {derivative(norm)}"
        yield rates, limited(label, label, Name(f"initial.{derivative(norm)}"), (0.0, 0.0))


def _copy(system: Urdf, **changed: object) -> Urdf:
    """The system with other parts, and nothing kept of what it worked out before."""
    own = {name: getattr(system, name) for name in Urdf.model_fields}
    return Urdf.model_construct(**{**own, **changed})
