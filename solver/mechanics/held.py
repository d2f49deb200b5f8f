"""What is held along a phase: contacts that touch, and loops; each a row with its force.

Of every row the definitions of what stays, of its rate and of its acceleration: from these the
engine's form keeps contacts and loops from drifting (``solver.model.drift``).
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Literal

from schemas.expressions import Name, derivative
from schemas.mechanisms import Loop
from solver.mechanics.frames import Frames
from solver.mechanics.loads import Load
from solver.mechanics.touching import Touch
from solver.mechanics.trees import ZERO, Vec, apart, dot, minus, plus, times, vector

Kind = Literal["normal", "tangential", "loop"]


@dataclass(frozen=True, slots=True)
class Held:
    """One row that is held.

    Attributes
    ----------
    name
        How reports call it: ``contact.foot.gap``, ``contact.foot.slip``, ``loop.pin.x``.
    kind
        ``normal`` and ``loop`` rows are zero; ``tangential`` ones keep the value of their start.
    force
        The name of its force, N.
    place
        The definition that is held, m; None where a contact that rolls on curved ground has none.
    rate, acceleration
        The definitions of its first and second derivative in time.
    """

    name: str
    kind: Kind
    force: str
    place: str | None
    rate: str
    acceleration: str


def held_rows(frames: Frames, touching: Mapping[str, Touch]) -> tuple[Held, ...]:
    """Normals first, then tangents, then loops; their definitions go to ``frames.trees``."""
    modes = frames.mechanism.mode
    active = [touching[name] for name in modes if name in touching]
    sticking = [touch for touch in active if modes[touch.name] == "sticking"]
    return (
        *(_normal(touch) for touch in active),
        *(_tangential(frames, touch) for touch in sticking),
        *(row for name, loop in frames.mechanism.loops.items() for row in _pin(frames, name, loop)),
    )


def pin_loads(name: str, loop: Loop) -> list[Load]:
    """What a pin's force does: it pushes the body of the second place, and back the first."""
    first, second = loop.between
    push: Vec = Name(f"loop.{name}.x"), Name(f"loop.{name}.y")
    return [
        Load(second.body, vector(second.at), push),
        Load(first.body, vector(first.at), (minus(push[0]), minus(push[1]))),
    ]


def _normal(touch: Touch) -> Held:
    gap = f"contact.{touch.name}.gap"
    return Held(
        name=gap,
        kind="normal",
        force=f"contact.{touch.name}.normal",
        place=gap,
        rate=derivative(gap),
        acceleration=derivative(gap, 2),
    )


def _tangential(frames: Frames, touch: Touch) -> Held:
    slip, place = f"contact.{touch.name}.slip", f"contact.{touch.name}#place"
    if touch.level:
        rolled = times(touch.radius, frames.angle(touch.contact.body))
        frames.trees[place] = plus(dot(touch.centre, touch.tangent), rolled)
    elif touch.other is None and touch.radius == ZERO:
        frames.trees[place] = touch.centre[0]  # along the surface, its x says where
    return Held(
        name=slip,
        kind="tangential",
        force=f"contact.{touch.name}.tangential",
        place=place if place in frames.trees else None,
        rate=slip,
        acceleration=derivative(slip),
    )


def _pin(frames: Frames, name: str, loop: Loop) -> Iterator[Held]:
    """The second place lies on the first."""
    first, second = (frames.place(place) for place in loop.between)
    for word, spread in zip(("x", "y"), apart(second, first), strict=True):
        gap = f"loop.{name}#{word}"
        frames.trees[gap] = spread
        yield Held(
            name=f"loop.{name}.{word}",
            kind="loop",
            force=f"loop.{name}.{word}",
            place=gap,
            rate=derivative(gap),
            acceleration=derivative(gap, 2),
        )
