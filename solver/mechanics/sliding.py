"""How the material of a pair moves along its tangent over a finite step.

No audit of work can tell a wrong tangent, since friction opposes whatever slips: rolling can.
"""

from dataclasses import dataclass

from schemas.expressions import Call, Name, Tree
from solver.mechanics.frames import Frames
from solver.mechanics.touching import Touch
from solver.mechanics.trees import ZERO, Vec, less, minus, over, turned


@dataclass(frozen=True, slots=True)
class Slide:
    """A pair that may slide, and its tangential force, N.

    The slip over a step is the sum of the changes of what moves, each times the mean of its
    factor over the step: ``terms`` are pairs (factor, what moves). ``axis`` tells the slips of one
    pair apart, where there are two. What rolls in space comes beside them: ``rolls`` add up to what
    a radius does over the sine of the angle by which its body turns, and grow to what it does over
    the angle; ``axes`` are the nine entries of its rotation, which tell how large that is.
    """

    pair: str
    effort: Tree
    terms: tuple[tuple[Tree, Tree], ...]
    axis: str = ""
    rolls: tuple[tuple[Tree, Tree], ...] = ()
    axes: tuple[Tree, ...] = ()

    @property
    def slack(self) -> str:
        """The variable that the slip is."""
        return f"contact.{self.pair}#slip{self.axis}"


def slide_of(frames: Frames, touch: Touch) -> Slide:
    """How the material of a pair moves along the tangent.

    With the contact's circle of radius r, angle a, over a shape's angle b: on a surface
    ``t . dc + r da``; about a circle at distance R in the direction f, ``-R df + r da +
    (R - r) db``, arcs and not chords; about an ellipse, with the contact's place p in the shape's
    own frame, ``t . dp + r (da - db)``, so that what moves with the shape slips nowhere.
    """
    name, r = touch.name, touch.radius
    pair = f"contact.{name}"
    effort = less(Name(f"{pair}#right"), Name(f"{pair}#left"))
    turn = r, frames.angle(touch.contact.body)
    terms = _along(touch.tangent, touch.centre) if touch.other is None else _about(frames, touch)
    return Slide(name, effort, tuple(one for one in (*terms, turn) if ZERO not in one))


def _along(tangent: Vec, moving: Vec) -> list[tuple[Tree, Tree]]:
    return list(zip(tangent, moving, strict=True))


def _about(frames: Frames, touch: Touch) -> list[tuple[Tree, Tree]]:
    mechanism, pair = frames.mechanism, f"contact.{touch.name}"
    shape = mechanism.shapes[mechanism.touching[touch.name].against]
    reach: Vec = Name(f"{pair}#reach_x"), Name(f"{pair}#reach_y")
    size, turn = Name(f"{pair}#size"), frames.angle(shape.body)
    if shape.circle is not None:
        arc = minus(size), Call("atan2", (reach[1], reach[0]))
        return [arc, (less(size, touch.radius), turn)]
    frame = frames.frames[shape.body]
    c, s = turned(frames.heading(frame.turner), frame.bearing)
    inside = turned((c, minus(s)), reach)
    normal = tuple(over(Name(f"{pair}#steep_{word}"), size) for word in "xy")
    tangent = normal[1], minus(normal[0])
    return [*_along(tangent, inside), (minus(touch.radius), turn)]
