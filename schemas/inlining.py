"""What a problem only names, put into it before it is stored: it is self-contained from then on.

``{"kind": "library", "name": "cart_pole"}`` stands for the system of an example's first phase,
``{"from_job": id}`` for a guess, or the controls of a simulation, made of an earlier result. What
the names lead to comes from whoever calls (`Sources`): this module knows no gallery and no store.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from schemas.errors import BadProblem, FootfallError, Issue
from schemas.expressions.errors import quoted
from schemas.pointers import Part, pointer
from schemas.suggest import did_you_mean

Document = dict[str, Any]

_GROUPS = ("states", "controls", "rates")
"""The groups of curves that a guess is made of."""


@dataclass(frozen=True, slots=True)
class Sources:
    """Where names lead. ``examples`` lists those of the gallery, ``example`` gives one's problem.

    ``result`` gives the result of a job as JSON values, and raises a `FootfallError` with the
    reason and the mend where there is none to be had.
    """

    examples: Callable[[], list[str]]
    example: Callable[[str], Document]
    result: Callable[[str], Mapping[str, Any]]


def inlined(document: Document, sources: Sources) -> Document:
    """The document with every name replaced; the very same object if there is none.

    Raises
    ------
    BadProblem
        With each name that leads nowhere: its place, the reason, the mend.
    """
    work = _Work(sources)
    whole = work.guess(document, ())
    phases = document.get("phases")
    if isinstance(phases, list):
        made = [work.phase(phase, ("phases", index)) for index, phase in enumerate(phases)]
        if any(new is not old for new, old in zip(made, phases, strict=True)):
            whole = {**whole, "phases": made}
    if work.issues:
        raise BadProblem(work.issues)
    return whole


def inlined_simulation(document: Document, sources: Sources) -> Document:
    """As `inlined`, of a simulation: its system, its controls and its feedback's reference."""
    work = _Work(sources)
    whole = work.simulation(document)
    if work.issues:
        raise BadProblem(work.issues)
    return whole


def solution_guess(result: Mapping[str, Any]) -> Document:
    """The ``solution`` guess that a result makes: its curves and its free parameters."""
    phases = [
        {
            "name": phase["name"],
            "curves": {name: phase["curves"][name] for name in _GROUPS if name in phase["curves"]},
        }
        for phase in result["phases"]
    ]
    static = result.get("static") or {}
    return {
        "kind": "solution",
        "phases": phases,
        "static": {name: value for name, value in static.items() if value is not None},
    }


@dataclass(slots=True)
class _Work:
    sources: Sources
    issues: list[Issue] = field(default_factory=list)
    _guesses: dict[str, Document] = field(default_factory=dict)

    def phase(self, phase: Any, parts: tuple[Part, ...]) -> Any:
        if not isinstance(phase, dict):
            return phase
        return self._library(self.guess(phase, parts), parts)

    def simulation(self, document: Document) -> Document:
        whole = self.guess(self._library(document, ()), (), "controls")
        feedback = whole.get("feedback")
        if not isinstance(feedback, dict):
            return whole
        named = self.guess(feedback, ("feedback",), "reference")
        return whole if named is feedback else {**whole, "feedback": named}

    def guess(self, holder: Document, parts: tuple[Part, ...], field: str = "guess") -> Document:
        """The problem or phase (or what has such a field) with its ``from_job`` replaced."""
        guess = holder.get(field)
        if not (isinstance(guess, dict) and "from_job" in guess):
            return holder
        place = (*parts, field)
        self._refuse_others(guess, ("from_job",), place)
        return {**holder, field: self._earlier(guess["from_job"], (*place, "from_job"))}

    def _library(self, holder: Document, parts: tuple[Part, ...]) -> Document:
        system = holder.get("system")
        if isinstance(system, dict) and system.get("kind") == "library":
            return {**holder, "system": self._system(system, (*parts, "system"))}
        return holder

    def _earlier(self, job_id: Any, parts: tuple[Part, ...]) -> Document:
        if not isinstance(job_id, str):
            self._refuse(parts, "expected the id of a job, as a text")
            return {}
        if job_id not in self._guesses:
            try:
                self._guesses[job_id] = self._made(job_id, parts)
            except FootfallError as error:
                self._refuse(parts, error.message, error.hint)
        return self._guesses.get(job_id, {})

    def _made(self, job_id: str, parts: tuple[Part, ...]) -> Document:
        guess = solution_guess(self.sources.result(job_id))
        if not guess["phases"]:
            self._refuse(parts, "the job's result has no trajectory", "Take a job that has one.")
        return guess

    def _system(self, system: Document, parts: tuple[Part, ...]) -> Document:
        self._refuse_others(system, ("kind", "name", "parameters"), parts)
        name, names = system.get("name"), self.sources.examples()
        if name not in names:
            given = quoted(name) if isinstance(name, str) else "this"
            hint = did_you_mean(name, names) if isinstance(name, str) else ""
            hint = hint or "the gallery (GET /v1/examples) has " + ", ".join(names)
            self._refuse((*parts, "name"), f"{given} is not the name of an example", hint)
            return system
        example = self.sources.example(str(name))
        plain: Document = example.get("system") or example["phases"][0]["system"]
        changes = system.get("parameters", {})
        known = plain.get("parameters", {})
        if not isinstance(changes, dict):
            self._refuse((*parts, "parameters"), "expected an object, {...}")
            return plain
        for word in changes:
            if word not in known:
                hint = did_you_mean(word, known) or _listed("its parameters are", list(known))
                message = f"the system '{name}' has no parameter {quoted(word)}"
                self._refuse((*parts, "parameters", word), message, hint)
        return {**plain, "parameters": {**known, **changes}} if known or changes else plain

    def _refuse_others(
        self, given: Document, fields: tuple[str, ...], parts: tuple[Part, ...]
    ) -> None:
        for word in given:
            if word not in fields:
                hint = did_you_mean(word, fields) or _listed("the fields here are", list(fields))
                self._refuse((*parts, word), f"unknown field {quoted(word)}", hint)

    def _refuse(self, parts: tuple[Part, ...], message: str, hint: str = "") -> None:
        self.issues.append(Issue(pointer(*parts), message, hint))


def _listed(words: str, names: list[str]) -> str:
    return f"{words} {', '.join(names)}" if names else "it has none"
