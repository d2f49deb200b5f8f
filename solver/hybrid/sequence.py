"""The mode sequence of a result: when which contacts touched."""

from collections.abc import Sequence

from schemas.mechanisms import Mechanism
from schemas.results import ModeSequence, ModeSpan, PhaseResult
from solver.hybrid.expand import Expansion


def mode_sequence(expansion: Expansion, results: Sequence[PhaseResult]) -> ModeSequence | None:
    """The modes of all hybrid phases in order of time; None where there are none."""
    found = {result.name: result for result in results}
    contacts: dict[str, None] = {}
    modes: list[ModeSpan] = []
    for split in expansion.splits:
        if split is None or not isinstance(split.phase.system, Mechanism):
            continue
        contacts |= dict.fromkeys(split.phase.system.touching)
        for name, mode in zip(split.names, split.modes, strict=True):
            knots = found[name].knots
            modes.append(ModeSpan(start=knots[0], end=knots[-1], contacts=dict(mode.contacts)))
    if not modes:
        return None
    different = {frozenset(mode.contacts) for mode in modes}
    return ModeSequence(
        contacts=list(contacts),
        modes=modes,
        distinct=len(different),
        possible=2 ** len(contacts),
    )
