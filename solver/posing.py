"""From the posted problem to the one that is solved, and the one that is judged."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Self

import numpy as np

from schemas.methods import ContactImplicit
from schemas.problem import Problem
from schemas.reading import spec_sha256
from schemas.results import ModeSequence, Solution
from solver.complementarity import Complementary
from solver.contact import Contacts, as_stepped, contacts_of, losses, with_contacts
from solver.contact.sequence import contact_sequence, guessed_sequence, joined
from solver.hybrid import Expansion, expand, mode_guesses, mode_sequence
from solver.lowering import smoothed
from solver.mechanics import limited
from solver.model import Model
from solver.poses import check_clear, loosened, posed
from solver.prepare import prepare
from solver.trajectory import Trajectory
from solver.transcribe import Setting


@dataclass(frozen=True, slots=True)
class Posing:
    """A posted problem, and what the engine makes of it before anything is transcribed.

    Attributes
    ----------
    contacts
        The problem with forces and pairs of contact-implicit phases.
    expansion
        That with modes of hybrid phases as phases.
    solved
        What is solved: that with smooth functions, limits of joints, loose forces.
    shown, judged
        The same without forces and pairs of our own: what results are called after, and what the
        certificate reads.
    remarks
        What is to be said of key poses.
    """

    posted: Problem
    contacts: Contacts
    expansion: Expansion
    solved: Problem
    shown: Problem
    judged: Problem
    remarks: list[str]

    @classmethod
    def of(cls, problem: Problem) -> Self:
        """Rewrite a problem, step by step."""
        keyed = posed(problem)
        stepped = as_stepped(keyed.problem)
        contacts = contacts_of(stepped)
        expansion = expand(contacts.problem)
        solved = _plain(expansion.problem)
        if not contacts.methods:
            return cls(
                problem, contacts, expansion, solved, expansion.problem, solved, keyed.remarks
            )
        shown = expand(stepped).problem
        return cls(problem, contacts, expansion, solved, shown, _plain(shown), keyed.remarks)

    def prepared(self) -> tuple[Model, Setting]:
        """The model, and the setting of its first mesh.

        Raises
        ------
        InvalidModel
            As ``prepare`` does.
        """
        check_clear(self.judged)
        model, setting = prepare(self.solved, self._guesses)
        return model, replace(setting, complementary=self._complementary())

    def _complementary(self) -> Complementary | None:
        contacts = self.contacts
        if not contacts.methods:
            return None
        settings = next(iter(contacts.methods.values())).relaxation
        refinement, allowed = self.solved.refinement, self._allowed()
        scale = refinement.tolerance / allowed if refinement else 1.0
        return Complementary(contacts.pairs, settings, partial(losses, self.judged, scale))

    def _allowed(self) -> float:
        """What steps may lose."""
        return min(method.dissipation for method in (self.contacts.methods or {}).values())

    def _guesses(self, model: Model) -> list[Trajectory]:
        lines = mode_guesses(self.expansion, self.contacts.problem, model)
        return with_contacts(self.contacts, self.posted, model, lines)

    def told(self, solution: Solution, guesses: Sequence[Trajectory]) -> Solution:
        """What the user learns: the hash is that of what was posted, the modes those of phases.

        ``guesses`` are those of the first mesh, whose sequence is told beside.
        """
        if self.expansion.problem is self.posted:
            return solution
        digest = {"spec_sha256": spec_sha256(self.posted)}
        changed: dict[str, object] = {
            "reproduce": solution.reproduce.model_copy(update=digest),
            "mode_sequence": mode_sequence(self.expansion, solution.phases),
            "warnings": [*solution.warnings, *self.remarks],
        }
        if self.contacts.methods:
            changed |= self._sequences(solution, guesses)
        return solution.model_copy(update=changed)

    def _sequences(
        self, solution: Solution, guesses: Sequence[Trajectory]
    ) -> dict[str, ModeSequence | None]:
        """What contacts did in the solution, and in the guess."""
        statics = {name: math.nan if x is None else x for name, x in solution.static.items()}
        found, before = list[ModeSequence | None](), list[ModeSequence | None]()
        for phase, result, guess in zip(self.shown.phases, solution.phases, guesses, strict=True):
            if not isinstance(phase.method, ContactImplicit):
                continue
            knots = np.array(result.knots)
            fractions = (knots - knots[0]) / ((knots[-1] - knots[0]) or 1.0)
            found.append(contact_sequence(phase, result, statics))
            before.append(guessed_sequence(phase, guess, fractions, statics))
        return {"mode_sequence": joined(found), "guessed_sequence": joined(before)}


def _plain(problem: Problem) -> Problem:
    return loosened(limited(smoothed(problem)))
