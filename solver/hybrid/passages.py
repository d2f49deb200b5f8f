"""From one phase's end to another's start: states that go on, and impacts between them."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from schemas.expressions import Call, Expression, Name, Number, Tree, derivative, stem
from schemas.mechanisms import Mechanism, Mode
from schemas.periodic import Periodic
from schemas.phases import Constraint, Phase
from schemas.problem import Static
from schemas.systems import System
from schemas.values import Bound, Scalar
from solver.hybrid.modes import cone, friction, limited
from solver.mechanics.impact import PIN, Shock, freed, pin_of
from solver.poses.loose import loose_forces
from solver.switches.rename import equal

_NEITHER = Bound(None, None)
_PRESSES = Bound(Scalar(0.0), None)
_BELOW = (-float("inf"), 0.0)


@dataclass(frozen=True, slots=True)
class Touchdown:
    """An impact, its contacts called as before it: what each does afterwards, who lets go."""

    after: Mapping[str, Mode]
    lands: Sequence[str]
    leaves: Sequence[str]


@dataclass(frozen=True, slots=True)
class Passage:
    """From the end of phase ``before`` to the start of phase ``after``.

    ``renamed`` says which names change on the way; ``touchdown`` is None where velocities go on.
    ``chain`` are controls, and derivatives of them, that are states; ``statics`` the problem's.
    """

    before: str
    after: str
    system: System
    renamed: Periodic = field(default_factory=Periodic)
    touchdown: Touchdown | None = None
    chain: Sequence[str] = ()
    statics: Collection[str] = ()

    def there(self, name: str) -> str:
        """The name at the start of the later phase of what is called ``name`` before it."""
        return f"{self.after}.initial.{self.renamed.swapped(name)}"

    def here(self, name: str) -> str:
        """A name at the end of the earlier phase."""
        return f"{self.before}.final.{name}"


@dataclass(frozen=True, slots=True)
class Joined:
    """What a passage adds to a problem; ``loose`` are impulses that nothing else settles."""

    linkages: list[Constraint]
    statics: dict[str, Static] = field(default_factory=dict)
    loose: tuple[str, ...] = ()


def join(passage: Passage, states: Sequence[str]) -> Joined:
    """The linkages of a passage; ``states`` are those of the system, called as before it."""
    free = {passage.renamed.swapped(name) for name in passage.renamed.free}
    free |= set(passage.renamed.free)
    going = [name for name in (*states, *passage.chain) if name not in free]
    if passage.touchdown is None or not isinstance(passage.system, Mechanism):
        return Joined([_continues(passage, name) for name in going])
    rates = {derivative(name) for name in passage.system.coordinates}
    rows = [_continues(passage, name) for name in going if name not in rates]
    impact = _Impact.of(passage, passage.system, passage.touchdown)
    return Joined([*rows, *impact.rows()], impact.statics(), impact.loose())


def _continues(passage: Passage, name: str) -> Constraint:
    return equal(f"{name} goes on", passage.here(name), passage.there(name))


@dataclass(frozen=True, slots=True)
class _Impact:
    """An impact at the end of a phase, over the names that linkages see."""

    passage: Passage
    mechanism: Mechanism
    touchdown: Touchdown
    shock: Shock
    pins: tuple[str, ...]

    @classmethod
    def of(cls, passage: Passage, mechanism: Mechanism, touchdown: Touchdown) -> "_Impact":
        """At the end of a period, a contact that lets go at a joint to the ground frees that."""
        leaves = [] if passage.renamed.impact is None else touchdown.leaves
        pinned = [pin_of(mechanism, name) for name in leaves]
        joint = next((name for name in pinned if name is not None), None)
        whole = mechanism if joint is None else freed(mechanism, joint)
        return cls(passage, mechanism, touchdown, Shock.of(whole), () if joint is None else PIN)

    def statics(self) -> dict[str, Static]:
        """Impulses, and the velocity of a pin that lets go."""
        found = {f"{self._name('pin')}.v{name[-1]}": _NEITHER for name in self.pins}
        for pair, mode in self.touchdown.after.items():
            found[f"{self._name(pair)}.normal"] = _PRESSES
            if mode == "sticking":
                found[f"{self._name(pair)}.tangential"] = _NEITHER
        return {name: Static(bounds=bound, guess=Scalar(0.0)) for name, bound in found.items()}

    def loose(self) -> tuple[str, ...]:
        """Impulses that others can stand in for, as under the toe and the heel of one foot."""
        if len(self.touchdown.after) < 2:
            return ()
        given = dict.fromkeys(self.passage.statics, 1.0)
        landed = self.mechanism.model_copy(update={"mode": dict(self.touchdown.after)})
        forces = loose_forces(landed, given)
        pairs = [name.removeprefix("contact.") for name in forces if name.startswith("contact.")]
        return tuple(self._name(name) for name in pairs)

    def rows(self) -> Iterator[Constraint]:
        """The jump of every coordinate, what comes to rest, cones, and who comes and goes."""
        change = self._change()
        impulses = {pair: self._impulses(pair) for pair in self.touchdown.after}
        for name in self.shock.mechanism.coordinates:
            tree = self._placed(self.shock.jump(name, change, impulses))
            yield limited(f"impact {name}", f"impact of {name}", tree, (0.0, 0.0))
        if self.pins:
            yield from self._rests()
        for pair, mode in self.touchdown.after.items():
            if mode == "sticking":
                mu = friction(self.mechanism, pair)
                held = Expression(mu.text, self._placed(mu.tree))
                yield from cone(pair, held, self._name(pair), "impact of ")
        yield from self._signs()

    def _signs(self) -> Iterator[Constraint]:
        for pair in self.touchdown.lands:
            name = self.passage.here(derivative(f"contact.{pair}.gap"))
            yield limited(f"{pair} comes down", name, Name(name), _BELOW)
            if self.pins:
                gap = self.passage.here(f"contact.{pair}.gap")
                yield limited(f"{pair} lands", gap, Name(gap), (0.0, 0.0))
        for pair in self.touchdown.leaves:
            name = self.passage.there(derivative(f"contact.{pair}.gap"))
            yield limited(f"{pair} comes off", name, Name(name))

    def _rests(self) -> Iterator[Constraint]:
        """Contacts that touch afterwards, of a mechanism whose pin is let go of.

        Else the phase that follows holds them at its start.
        """
        for pair, mode in self.touchdown.after.items():
            for side in (0, 1) if mode == "sticking" else (0,):
                terms = [
                    Call("*", (push, self._after(name)))
                    for name in self.shock.mechanism.coordinates
                    if (push := self._placed(self.shock.push(pair, name, side))) != Number(0.0)
                ]
                label = f"{pair} rests {('normal', 'tangential')[side]}"
                yield limited(label, label, Call("+", tuple(terms)), (0.0, 0.0))

    def _change(self) -> dict[str, Tree]:
        """v+ - v- of every coordinate; a pin was at rest."""
        return {
            name: after
            if name in self.pins
            else Call("-", (after, Name(self.passage.here(derivative(name)))))
            for name in self.shock.mechanism.coordinates
            for after in [self._after(name)]
        }

    def _after(self, name: str) -> Tree:
        if name in self.pins:
            return Name(f"{self._name('pin')}.v{name[-1]}")
        return Name(self.passage.there(derivative(name)))

    def _impulses(self, pair: str) -> tuple[Tree, Tree]:
        """The normal and the tangential impulse."""
        normal = Name(f"{self._name(pair)}.normal")
        mode = self.touchdown.after[pair]
        if mode == "sticking":
            return normal, Name(f"{self._name(pair)}.tangential")
        rubbing = Call("*", (self._placed(friction(self.mechanism, pair).tree), normal))
        if mode == "sliding_right":
            return normal, Call("neg", (rubbing,))
        return normal, rubbing if mode == "sliding_left" else Number(0.0)

    def _name(self, what: str) -> str:
        return f"{self.passage.before}.impact.{what}"

    def _placed(self, tree: Tree) -> Tree:
        """A tree over the mechanism's own names, at the end of the phase before."""
        if isinstance(tree, Call):
            arguments = tuple(self._placed(one) for one in tree.arguments)
            return Call(tree.function, arguments, tree.column)
        if not isinstance(tree, Name) or ".final." in tree.name or ".initial." in tree.name:
            return tree
        own = f"{self.passage.before}.impact."
        if tree.name.startswith(own) or tree.name in self.passage.statics:
            return tree
        if tree.name in self.mechanism.parameters:
            return Name(f"{self.passage.before}.{tree.name}")
        return Name(self.passage.here(tree.name))


def chained(used: Sequence[str], phase: Phase) -> list[str]:
    """Controls whose derivatives are used, and these but the highest: they do not jump."""
    highest: dict[str, int] = {}
    for order, base in map(stem, used):
        if base in phase.system.control_names:
            highest[base] = max(order, highest.get(base, 0))
    return [derivative(name, k) for name, order in highest.items() for k in range(order)]
