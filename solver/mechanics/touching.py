"""Contacts: gap, normal, tangent and slip of every permitted pair, and the forces of touching ones.

The normal points from the surface or the shape to the contact's body, the tangent is the normal
turned by -90 degrees. Gaps are distances in metres to first order (an
unnormalised one mis-scales the friction cone): ``(y - h) / sqrt(1 + h'^2)`` over a surface, and
``g (g - 1) / |G|`` about an ellipse, with ``g^2 = (x/a)^2 + (y/b)^2`` and ``G = (x/a^2, y/b^2)`` in
its own frame, exact for circles.
"""

from dataclasses import dataclass
from typing import Literal

from schemas.expressions import Call, Name, Number, Tree, names_in
from schemas.expressions.differentiation import total_derivative
from schemas.mechanisms import Mode, Pair, Place, Shape, Surface
from schemas.mechanisms.contacts import HEIGHT_NAME
from solver.mechanics.frames import Frames, rate, rates
from solver.mechanics.loads import Load
from solver.mechanics.trees import (
    ONE,
    ZERO,
    Vec,
    apart,
    both,
    call,
    cross,
    dot,
    less,
    minus,
    over,
    plus,
    scaled,
    square,
    times,
    turned,
    vector,
)


@dataclass(frozen=True, slots=True)
class Touch:
    """A permitted pair in the world.

    Attributes
    ----------
    centre
        Of the contact's circle, or the contact point.
    normal, friction, radius
        As the user gave them; the normal is a unit vector.
    other
        The shape's body and the lever from its place ``seat`` to the point of contact, in the
        world; None for a surface.
    level
        Whether the surface is straight, so that a place along it exists.
    press
        The direction of the normal force where it is not the normal: of a circle on curved
        ground, whose gap is a distance to first order. Along the gap's slope it does no work.
    """

    name: str
    contact: Place
    centre: Vec
    normal: Vec
    radius: Tree
    friction: Tree
    other: tuple[Place, Vec] | None = None
    level: bool = False
    press: Vec | None = None

    @property
    def tangent(self) -> Vec:
        """The normal turned by -90 degrees."""
        return self.normal[1], minus(self.normal[0])

    def loads(self, normal: Tree, tangential: Tree) -> list[Load]:
        """The forces on both bodies."""
        press = self.normal if self.press is None else self.press
        force = both(scaled(normal, press), scaled(tangential, self.tangent))
        found = [
            Load(self.contact.body, vector(self.contact.at), force, times(self.radius, tangential))
        ]
        if self.other is not None:
            seat, lever = self.other
            back = minus(force[0]), minus(force[1])
            found.append(Load(seat.body, vector(seat.at), back, cross(lever, back)))
        return found


def touches(frames: Frames) -> dict[str, Touch]:
    """Every permitted pair; definitions of gaps, slips and normals go to ``frames.trees``."""
    mechanism = frames.mechanism
    found: dict[str, Touch] = {}
    for name, pair in mechanism.touching.items():
        if pair.against in mechanism.surfaces:
            found[name] = _on_surface(frames, name, pair, mechanism.surfaces[pair.against])
        else:
            found[name] = _on_shape(frames, name, pair, mechanism.shapes[pair.against])
    return found


def tangential_force(mode: Mode | Literal["split"], touch: Touch) -> Tree | None:
    """The force along the tangent where the mode gives it; None where it is unknown: sticking.

    A ``split`` one is the difference of two controls (``solver.contact``).
    """
    normal, slip = Name(f"contact.{touch.name}.normal"), Name(f"contact.{touch.name}.slip")
    rubbing = times(touch.friction, normal)
    match mode:
        case "sticking":
            return None
        case "sliding_right":
            return minus(rubbing)
        case "sliding_left":
            return rubbing
        case "sliding":
            return minus(times(rubbing, Call("sign", (slip,))))
        case "frictionless":
            return ZERO
        case "split":
            pair = f"contact.{touch.name}"
            return less(Name(f"{pair}#right"), Name(f"{pair}#left"))


def _on_surface(frames: Frames, name: str, pair: Pair, surface: Surface) -> Touch:
    contact = frames.mechanism.contacts[pair.contact]
    x, y = Name(f"{pair.contact}.x"), Name(f"{pair.contact}.y")
    height, slope = _height(surface.height.tree, x), _slope(surface.height.tree, x)
    level = not any(one.name == HEIGHT_NAME for one in names_in(_raw_slope(surface.height.tree)))
    slope = frames.shared(f"contact.{name}#slope", slope)
    size = frames.shared(f"contact.{name}#size", call("sqrt", plus(ONE, square(slope))))
    normal = minus(over(slope, size)), over(ONE, size)
    radius = contact.radius.tree
    gap = less(over(less(y, height), size), radius)
    touch = Touch(
        name,
        contact,
        (x, y),
        _shared_normal(frames, name, normal),
        radius,
        (pair.friction or surface.friction).tree,
        level=level,
        press=None if level or radius == ZERO else _steepest(frames, name, surface, (x, y)),
    )
    slip = plus(dot(rates((x, y)), touch.tangent), times(radius, _spin(frames, contact.body)))
    frames.trees |= {f"contact.{name}.gap": gap, f"contact.{name}.slip": slip}
    return touch


def _steepest(frames: Frames, name: str, surface: Surface, centre: Vec) -> Vec:
    """The unit vector along the slope of the gap ``(y - h) / sqrt(1 + h'^2)``."""
    (x, y), height = centre, surface.height.tree
    slope, size = Name(f"contact.{name}#slope"), Name(f"contact.{name}#size")
    bend = _height(_raw_slope(_raw_slope(height)), x)
    less_steep = over(times(less(y, _height(height, x)), slope, bend), times(size, square(size)))
    across = minus(plus(over(slope, size), less_steep))
    across = frames.shared(f"contact.{name}#across", across)
    length = frames.shared(f"contact.{name}#steep", Call("hypot", (across, over(ONE, size))))
    return _shared_pair(
        frames, f"contact.{name}#press", over_both((across, over(ONE, size)), length)
    )


def _on_shape(frames: Frames, name: str, pair: Pair, shape: Shape) -> Touch:
    contact, seat = frames.mechanism.contacts[pair.contact], Place(body=shape.body, at=shape.at)
    centre: Vec = Name(f"{pair.contact}.x"), Name(f"{pair.contact}.y")
    middle = _shared_pair(frames, f"contact.{name}#seat", frames.place(seat))
    reach = _shared_pair(frames, f"contact.{name}#reach", apart(centre, middle))
    radius = contact.radius.tree
    if shape.circle is not None:
        distance = frames.shared(f"contact.{name}#size", Call("hypot", reach))
        gap, normal = less(distance, plus(shape.circle.tree, radius)), over_both(reach, distance)
    else:
        gap, normal = _ellipse(frames, name, shape, reach)
        gap = less(gap, radius)
    normal = _shared_normal(frames, name, normal)
    lever = apart(reach, scaled(radius, normal))
    friction = ONE if pair.friction is None else pair.friction.tree
    touch = Touch(name, contact, centre, normal, radius, friction, (seat, lever))
    across = dot(apart(rates(centre), rates(middle)), touch.tangent)
    # the shape's own turning moves its material by w x lever
    turning = times(_spin(frames, shape.body), cross(lever, touch.tangent))
    slip = plus(across, times(radius, _spin(frames, contact.body)), minus(turning))
    frames.trees |= {f"contact.{name}.gap": gap, f"contact.{name}.slip": slip}
    return touch


def _ellipse(frames: Frames, name: str, shape: Shape, reach: Vec) -> tuple[Tree, Vec]:
    """Distance to first order and normal, by the level sets of an ellipse."""
    frame = frames.frames[shape.body]
    c, s = turned(frames.heading(frame.turner), frame.bearing)
    a, b = vector(shape.ellipse or [])
    inside = turned((c, minus(s)), reach)
    steep = over(inside[0], square(a)), over(inside[1], square(b))
    steep = _shared_pair(frames, f"contact.{name}#steep", steep)
    level = call("hypot", over(inside[0], a), over(inside[1], b))
    level = frames.shared(f"contact.{name}#level", level)
    size = frames.shared(f"contact.{name}#size", call("hypot", *steep))
    gap = over(times(level, less(level, ONE)), size)
    return gap, turned((c, s), over_both(steep, size))


def over_both(a: Vec, size: Tree) -> Vec:
    """A vector over a number."""
    return over(a[0], size), over(a[1], size)


def _shared_normal(frames: Frames, name: str, normal: Vec) -> Vec:
    return _shared_pair(frames, f"contact.{name}#normal", normal)


def _shared_pair(frames: Frames, name: str, pair: Vec) -> Vec:
    return frames.shared(f"{name}_x", pair[0]), frames.shared(f"{name}_y", pair[1])


def _spin(frames: Frames, body: str) -> Tree:
    return rate(frames.angle(body))


def _height(tree: Tree, x: Tree) -> Tree:
    if isinstance(tree, Name):
        return x if tree.name == HEIGHT_NAME else tree
    if isinstance(tree, Number):
        return tree
    return Call(tree.function, tuple(_height(one, x) for one in tree.arguments), tree.column)


def _raw_slope(height: Tree) -> Tree:
    return total_derivative(height, lambda name: ONE if name == HEIGHT_NAME else None)


def _slope(height: Tree, x: Tree) -> Tree:
    return _height(_raw_slope(height), x)
