"""What the balance of momentum over a finite step is made of: what moves, and what pushes it.

The equations of motion speak of an instant; here nothing is differentiated. Every force comes
with the quantity along which it acts, so that its work over a step is the force times the change
of that quantity, whatever the step (``solver.discrete``).
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from schemas.expressions import Name, Tree
from schemas.mechanisms import Mechanism, motor_control
from solver.mechanics.actuation import Actuation
from solver.mechanics.frames import Frames
from solver.mechanics.series import centres, places, whole
from solver.mechanics.sliding import Slide, slide_of
from solver.mechanics.touching import touches
from solver.mechanics.trees import (
    ZERO,
    Vec,
    apart,
    scaled,
    times,
    unit,
    vector,
)


@dataclass(frozen=True, slots=True)
class Inert:
    """A body that has a mass: kg, kg m^2, the place of its centre in the world, its angle."""

    name: str
    mass: Tree
    inertia: Tree
    centre: tuple[Tree, ...]
    angle: Tree


@dataclass(frozen=True, slots=True)
class Spin:
    """How a body turns in space.

    The rows of its rotation to the world; its inertia about its centre in its own axes, kg m^2.
    """

    rows: tuple[tuple[Tree, Tree, Tree], ...]
    inertia: tuple[tuple[float, float, float], ...]


@dataclass(frozen=True, slots=True)
class Push:
    """A force ``effort``, N or N m, along what it moves, m or rad."""

    name: str
    along: Tree
    effort: Tree


@dataclass(frozen=True, slots=True)
class Coil:
    """A spring or tendon along its ``length``."""

    name: str
    length: Tree
    stiffness: Tree
    rest: Tree
    damping: Tree
    engaged: Tree
    pulling_only: bool


@dataclass(frozen=True, slots=True)
class Principle:
    """A mechanism as momenta and forces.

    Attributes
    ----------
    coordinates, controls
        Names, those of the user's controls and motors.
    definitions
        Names over coordinates, rates and each other.
    gravity
        m/s^2.
    pushes
        Motors, the user's forces and torques (joint limits that push are torques, too), the
        forces of contacts along their gaps, ``contact.P.normal``, and of loops along their
        spreads, ``loop.L.x`` and ``loop.L.y``.
    slides
        One a permitted pair; the force is ``contact.P#right - contact.P#left``. In space two, along
        x and y.
    spins
        Bodies in space, whose turning has an inertia.
    norms
        Where quaternions are among the coordinates: their norms are 1 at the ends of steps.
    hinges
        In space, coordinates that turn something, and how many times: rad.
    """

    coordinates: tuple[str, ...]
    controls: tuple[str, ...]
    definitions: Mapping[str, Tree]
    gravity: tuple[Tree, ...]
    bodies: tuple[Inert, ...]
    pushes: tuple[Push, ...]
    springs: tuple[Coil, ...]
    slides: tuple[Slide, ...]
    spins: tuple[Spin, ...] = ()
    norms: tuple[tuple[int, ...], ...] = ()
    hinges: tuple[tuple[int, float], ...] = ()

    @property
    def pairs(self) -> tuple[str, ...]:
        """The permitted pairs, in the order of the slips."""
        return tuple(slide.pair for slide in self.slides)


def principle_of(mechanism: Mechanism) -> Principle:
    """The balance of a checked mechanism whose every permitted pair may touch and slide."""
    frames = Frames.of(mechanism)
    actuation = Actuation.of(frames)
    slides = tuple(slide_of(frames, touch) for touch in touches(frames).values())
    bodies = tuple(_inert(frames, name, at) for name, at in centres(frames).items())
    pushes = (
        *_drives(mechanism),
        *_forces(frames),
        *(_normal(slide.pair) for slide in slides),
        *_loops(frames),
    )
    trees = places(frames) | whole(frames, actuation.energies) | actuation.trees | frames.trees
    trees |= {f"contact.{slide.pair}.tangential": slide.effort for slide in slides}
    return Principle(
        tuple(mechanism.coordinates),
        tuple(mechanism.control_names),
        trees | {name: one.tree for name, one in mechanism.define.items()},
        vector(mechanism.gravity),
        bodies,
        pushes,
        tuple(_coils(mechanism)),
        slides,
    )


def _inert(frames: Frames, name: str, centre: Vec) -> Inert:
    body = frames.mechanism.bodies[name]
    mass, inertia = (ZERO if one is None else one.tree for one in (body.mass, body.inertia))
    return Inert(name, mass, inertia, centre, frames.angle(name))


def _drives(mechanism: Mechanism) -> Iterator[Push]:
    """Motors and the user's torques."""
    for name, motor in mechanism.motors.items():
        torque = Name(f"motor.{name}.torque")
        effort = (
            torque if motor.losses else times(motor.gear.tree, Name(motor_control(name, motor)))
        )
        yield Push(f"motor.{name}", Name(motor.joint), effort)
    for name, one in mechanism.torques.items():
        turned_by = one.joint or f"{one.body}.angle"
        yield Push(f"torque.{name}", Name(turned_by), one.value.tree)


def _forces(frames: Frames) -> Iterator[Push]:
    """The user's forces, by their components in the world."""
    for name, force in frames.mechanism.forces.items():
        along = unit(vector(force.direction))
        if force.frame == "body":
            along = frames.direction(along, force.body)
        place = frames.world(vector(force.at), force.body)
        for word, at, push in zip("xy", place, scaled(force.value.tree, along), strict=True):
            yield Push(f"force.{name}.{word}", at, push)


def _normal(pair: str) -> Push:
    return Push(f"contact.{pair}", Name(f"contact.{pair}.gap"), Name(f"contact.{pair}.normal"))


def _loops(frames: Frames) -> Iterator[Push]:
    """A pin's force acts on the second place's body, and back on that of the first."""
    for name, loop in frames.mechanism.loops.items():
        first, second = (frames.place(place) for place in loop.between)
        for word, spread in zip("xy", apart(second, first), strict=True):
            yield Push(f"loop.{name}.{word}", spread, Name(f"loop.{name}.{word}"))


def _coils(mechanism: Mechanism) -> Iterator[Coil]:
    for name, spring in mechanism.springs.items():
        yield Coil(
            name,
            Name(f"spring.{name}.length"),
            spring.stiffness.tree,
            spring.rest.tree,
            spring.damping.tree,
            spring.engaged.tree,
            spring.pulling_only,
        )
