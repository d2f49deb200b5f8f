"""The modes of one phase, each a phase of its own: contacts held, forces within their cones."""

import math
from collections.abc import Iterator, Sequence

from schemas import resolve
from schemas.expressions import Call, Expression, Name, Number, Tree
from schemas.mechanisms import Mechanism, Mode
from schemas.methods import Hybrid, HybridMode
from schemas.phases import Constraint, Phase, Time
from schemas.values import Bound, Scalar

SHORTEST = 1e-3
"""Seconds that a mode lasts at the least, unless it says so itself."""

FEWEST = 3
"""Segments of a mode at the least, unless the phase itself has fewer."""

_ABOVE = (0.0, math.inf)


def part_names(phase: Phase, method: Hybrid) -> list[str]:
    """The modes' phases: names that no user can write."""
    return [f"{phase.name}/{mode.name}" for mode in method.sequence]


def mode_phases(
    phase: Phase, mechanism: Mechanism, method: Hybrid, shares: Sequence[float]
) -> list[Phase]:
    """One phase for each mode of the sequence; ``shares`` of its segments."""
    names = part_names(phase, method)
    return [
        phase.model_copy(
            update={
                "name": name,
                "system": mechanism.model_copy(update={"mode": mode.contacts}),
                "time": _time(phase, method, index),
                "initial": phase.initial if index == 0 else {},
                "final": phase.final if index == len(names) - 1 else {},
                "boundary": [],
                "path": [*phase.path, *_contact_rows(mechanism, mode)],
                "periodic": None,
                "method": _transcription(method, share),
                "guess": None,
            }
        )
        for index, (name, mode, share) in enumerate(
            zip(names, method.sequence, shares, strict=True)
        )
    ]


def _transcription(method: Hybrid, share: float) -> object:
    """The same with its share of the segments."""
    whole = method.transcription
    segments = max(round(share * whole.segments), min(FEWEST, whole.segments))
    return whole.model_copy(update={"segments": segments})


def durations(phase: Phase, method: Hybrid) -> list[float]:
    """How the phase's time is shared among its modes at first."""
    constants = resolve.parameters(phase.system)
    wanted = [_typical(resolve.interval(mode.duration, constants)) for mode in method.sequence]
    known = [one for one in wanted if one is not None]
    mean = sum(known) / len(known) if known else 1.0
    lengths = [mean if one is None else one for one in wanted]
    return [length / sum(lengths) for length in lengths]


def _typical(limits: tuple[float, float]) -> float | None:
    lower, upper = max(limits[0], 0.0), limits[1]
    return (lower + upper) / 2 if math.isfinite(upper) else None


def _time(phase: Phase, method: Hybrid, index: int) -> Time:
    own, count = method.sequence[index].duration, len(method.sequence)
    duration = own or Bound(Scalar(SHORTEST), None)
    if count == 1 and own is None and phase.time.duration is not None:
        duration = phase.time.duration
    return Time(
        initial=phase.time.initial if index == 0 else None,
        final=phase.time.final if index == count - 1 else None,
        duration=duration,
    )


def _contact_rows(mechanism: Mechanism, mode: HybridMode) -> Iterator[Constraint]:
    """What contacts ask for along a mode."""
    for pair in mechanism.touching:
        if pair not in mode.contacts:
            yield limited(f"{pair} stays open", f"contact.{pair}.gap", Name(f"contact.{pair}.gap"))
            continue
        normal = Name(f"contact.{pair}.normal")
        yield limited(f"{pair} presses", normal.name, normal)
        if mode.contacts[pair] == "sticking":
            yield from cone(pair, friction(mechanism, pair), f"contact.{pair}")
        yield from _slips(pair, mode.contacts[pair])


def _slips(pair: str, mode: Mode) -> Iterator[Constraint]:
    slip = Name(f"contact.{pair}.slip")
    if mode == "sliding_right":
        yield limited(f"{pair} slides", slip.name, slip)
    if mode == "sliding_left":
        yield limited(f"{pair} slides", f"-{slip.name}", Call("neg", (slip,)))


def cone(pair: str, mu: Expression, force: str, prefix: str = "") -> Iterator[Constraint]:
    """The tangential force within the friction cone of the normal one, both sides of it."""
    normal, tangential = Name(f"{force}.normal"), Name(f"{force}.tangential")
    most = Call("*", (mu.tree, normal))
    for way, sign in (("right", "-"), ("left", "+")):
        text = f"({mu.text})*{normal.name} {sign} {tangential.name}"
        yield limited(f"{prefix}{pair} sticks {way}", text, Call(sign, (most, tangential)))


def friction(mechanism: Mechanism, pair: str) -> Expression:
    """A pair's coefficient of friction."""
    one = mechanism.touching[pair]
    if one.friction is not None:
        return one.friction
    surface = mechanism.surfaces.get(one.against)
    return Expression("1", Number(1.0)) if surface is None else surface.friction


def limited(name: str, text: str, tree: Tree, limits: tuple[float, float] = _ABOVE) -> Constraint:
    """A constraint that no user wrote; zero or more unless told."""
    lower, upper = (Scalar(limit) if math.isfinite(limit) else None for limit in limits)
    return Constraint.model_construct(
        name=name, expression=Expression(text, tree), lower=lower, upper=upper
    )
