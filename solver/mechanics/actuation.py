"""Motors, springs, and the user's own forces: what they are called, and what they push."""

from collections import defaultdict
from dataclasses import dataclass, field

from schemas.expressions import Call, Name, Number, Tree, derivative
from schemas.mechanisms import Force, Losses, Motor, Spring, motor_control
from solver.mechanics.frames import Frames, rate
from solver.mechanics.loads import Load
from solver.mechanics.trees import (
    ZERO,
    Vec,
    apart,
    call,
    less,
    minus,
    over,
    plus,
    scaled,
    square,
    times,
    unit,
    vector,
)

_HALF = Number(0.5)


@dataclass(slots=True)
class Actuation:
    """All of them.

    Attributes
    ----------
    trees
        Names of motors and springs.
    efforts
        Joint -> what acts from parent to child along its coordinate.
    loads
        On bodies.
    energies
        Of the springs, J.
    """

    frames: Frames
    trees: dict[str, Tree] = field(default_factory=dict)
    loads: list[Load] = field(default_factory=list)
    energies: list[Tree] = field(default_factory=list)
    _efforts: dict[str, list[Tree]] = field(default_factory=lambda: defaultdict(list))

    @classmethod
    def of(cls, frames: Frames) -> "Actuation":
        """Everything that drives the mechanism and holds it back, but contacts and loops."""
        self, mechanism = cls(frames), frames.mechanism
        for name, motor in mechanism.motors.items():
            self._motor(name, motor)
        for name, spring in mechanism.springs.items():
            self._spring(name, spring)
        for force in mechanism.forces.values():
            self._force(force)
        for torque in mechanism.torques.values():
            if torque.joint is not None:
                self._efforts[torque.joint].append(torque.value.tree)
            elif torque.body is not None:
                self.loads.append(Load(torque.body, couple=torque.value.tree))
        return self

    @property
    def efforts(self) -> dict[str, Tree]:
        """The sum at every joint that has any."""
        return {joint: plus(*some) for joint, some in self._efforts.items()}

    def _motor(self, name: str, motor: Motor) -> None:
        own = f"motor.{name}"
        speed = Name(f"{own}.speed")
        self.trees[speed.name] = Name(derivative(motor.joint))
        control, torque = Name(motor_control(name, motor)), Name(f"{own}.torque")
        if motor.losses is None:
            effort = times(motor.gear.tree, torque)
            self.trees[f"{own}.power"] = times(effort, speed)
        else:
            effort = torque
            self.trees |= _with_losses(own, motor.losses, control, speed)
        self._efforts[motor.joint].append(effort)

    def _spring(self, name: str, spring: Spring) -> None:
        length, force = Name(f"spring.{name}.length"), Name(f"spring.{name}.force")
        reach = self._between(name, spring)
        if spring.joint is not None:
            self.trees[length.name] = Name(spring.joint)
            self._efforts[spring.joint].append(force)
        else:
            self.trees[length.name] = Call("hypot", reach)
            self._pull(spring, scaled(over(force, length), reach))
        self.trees[force.name] = _force_of(spring, length)
        self.energies.append(_energy_of(spring, length))

    def _between(self, name: str, spring: Spring) -> Vec:
        """From the first place to the second, in the world."""
        if spring.between is None:
            return ZERO, ZERO
        first, second = (self.frames.place(one) for one in spring.between)
        x, y = apart(second, first)
        share = self.frames.shared
        return share(f"spring.{name}#x", x), share(f"spring.{name}#y", y)

    def _pull(self, spring: Spring, force: Vec) -> None:
        first, second = spring.between or []
        self.loads.append(Load(second.body, vector(second.at), force))
        self.loads.append(Load(first.body, vector(first.at), (minus(force[0]), minus(force[1]))))

    def _force(self, force: Force) -> None:
        along = unit(vector(force.direction))
        if force.frame == "body":
            along = self.frames.direction(along, force.body)
        push = scaled(force.value.tree, along)
        self.loads.append(Load(force.body, vector(force.at), push))


def _with_losses(own: str, losses: Losses, current: Tree, speed: Tree) -> dict[str, Tree]:
    """Torque and electrical power of 003, equations 2.1 and 2.2, signs smoothed."""
    side, size = Name(f"{own}#side"), Call("abs", (current,))
    rubbing = plus(losses.coulomb.tree, times(losses.friction.tree, losses.constant.tree, size))
    torque = plus(
        times(losses.constant.tree, current),
        minus(times(losses.viscous.tree, speed)),
        minus(times(rubbing, side)),
    )
    voltage = plus(
        times(current, losses.resistance.tree),
        times(side, losses.brush.tree),
        times(losses.constant.tree, speed),
    )
    return {
        side.name: call("tanh", over(speed, losses.smoothing.tree)),
        f"{own}.torque": torque,
        f"{own}.power": times(voltage, current),
    }


def _force_of(spring: Spring, length: Name) -> Tree:
    """``stiffness (rest - z) - damping d(z)``, never above zero where it pulls only."""
    force = plus(
        times(spring.stiffness.tree, less(spring.rest.tree, length)),
        minus(times(spring.damping.tree, rate(length))),
    )
    if spring.pulling_only:
        force = Call("min", (force, ZERO))
    return times(spring.engaged.tree, force)


def _energy_of(spring: Spring, length: Name) -> Tree:
    stretch = less(length, spring.rest.tree)
    if spring.pulling_only:
        stretch = Call("max", (stretch, ZERO))
    return times(_HALF, spring.engaged.tree, spring.stiffness.tree, square(stretch))
