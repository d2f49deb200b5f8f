"""Stages: merge patches on a problem (RFC 7396), each of which makes the next problem to solve.

Three things go beyond the RFC. An object whose ``kind`` changes is replaced, for its fields were
those of the other kind. In lists of named items, such as phases, an object patches items by their
names. And ``refinement: null`` is a value, one mesh, and no removal.
"""

from collections.abc import Iterator
from typing import Any

from pydantic import ValidationError

from schemas.errors import Issue
from schemas.expressions.errors import quoted
from schemas.pointers import Part, parts_of, pointer
from schemas.problem import Problem
from schemas.suggest import did_you_mean

_OF_THE_WHOLE = ("stages", "halvings", "multistart", "limits", "known")
"""Fields that say something about all stages together."""


def apply_stage(problem: Problem, index: int) -> Problem:
    """The problem of a stage: the patches up to its own applied, one after the other.

    It has no stages itself, and from the second stage on no guess: the solution of the stage
    before is one. ``problem`` was read, so its stages are good.
    """
    return Problem.model_validate(stage_document(problem, index))


def stage_document(problem: Problem, index: int) -> dict[str, Any]:
    """The stage's problem as JSON values, not checked."""
    exclude: dict[str, Any] = {"stages": True}
    if index > 0:
        exclude |= {"guess": True, "phases": {"__all__": {"guess"}}}
    document: dict[str, Any] = problem.model_dump(mode="json", exclude=exclude)
    for patch in problem.stages[: index + 1]:
        document = merged(document, patch)
        if "refinement" in patch and patch["refinement"] is None:
            document["refinement"] = None
    return document


def halfway(before: Problem, after: Problem) -> Problem | None:
    """The later one of two stages' problems with its numbers halfway from the earlier one's.

    None where that is no good problem, or no number differs.
    """
    document = _between(before.model_dump(mode="json"), after.model_dump(mode="json"))
    try:
        between = Problem.model_validate(document)
    except ValidationError:
        return None
    return None if between == after else between


def _between(before: Any, after: Any) -> Any:
    if isinstance(before, dict) and isinstance(after, dict):
        return {name: _between(before.get(name, value), value) for name, value in after.items()}
    if isinstance(before, list) and isinstance(after, list) and len(before) == len(after):
        return [_between(*pair) for pair in zip(before, after, strict=True)]
    if not (_is_number(before) and _is_number(after)):
        return after
    whole = isinstance(before, int) and isinstance(after, int)
    return (before + after) // 2 if whole else (before + after) / 2


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def merged(target: Any, patch: Any) -> Any:
    """The target with the patch applied; neither is changed."""
    if not isinstance(patch, dict):
        return patch
    if isinstance(target, list) and all(isinstance(item, dict) for item in target):
        named = {str(item.get("name")): item for item in target}
        new = {name: {"name": name} for name in patch if name not in named}
        return list(merged(new | named, patch).values())
    kept = isinstance(target, dict) and _same_kind(target, patch)
    result: dict[str, Any] = dict(target) if kept else {}
    for key, value in patch.items():
        if value is None:
            result.pop(key, None)
        else:
            result[key] = merged(result.get(key), value)
    return result


def _same_kind(target: dict[str, Any], patch: dict[str, Any]) -> bool:
    kinds = target.get("kind"), patch.get("kind")
    return kinds[0] == kinds[1] or not all(isinstance(kind, str) for kind in kinds)


def out_of_place(problem: Problem) -> Iterator[Issue]:
    """Fields of patches that no stage has of its own, and phases that there are not."""
    known = [phase.name for phase in problem.phases]
    for index, patch in enumerate(problem.stages):
        yield from _phases(patch.get("phases"), known, ("stages", index, "phases"))
        for field in _OF_THE_WHOLE:
            if field in patch:
                yield Issue(
                    pointer("stages", index, field),
                    f"'{field}' is one for all stages together",
                    "give it beside 'stages'",
                )
        if index > 0 and "guess" in patch:
            yield Issue(
                pointer("stages", index, "guess"),
                "a stage starts from the solution of the one before",
                "give a guess to the first stage only, or to the problem",
            )


def _phases(patch: Any, known: list[str], place: tuple[Part, ...]) -> Iterator[Issue]:
    """Patches of phases that are neither there nor whole; ``known`` grows by those that are."""
    if isinstance(patch, list) and any(
        isinstance(phase, dict) and "system" not in phase for phase in patch
    ):
        yield Issue(
            pointer(*place),
            "a list takes the place of all phases",
            'to change one, patch it by its name: {"' + known[0] + '": {...}}',
        )
    for name, phase in patch.items() if isinstance(patch, dict) else ():
        if name not in known and isinstance(phase, dict) and "system" not in phase:
            near = did_you_mean(name, known) or "the phases are " + ", ".join(known[:12])
            yield Issue(pointer(*place, name), f"there is no phase {quoted(name)}", near)
        known.append(name)


def blamed(issue: Issue, index: int, patch: dict[str, Any]) -> Issue:
    """An issue of a stage's problem, at the place in the patch that comes nearest to it."""
    parts: list[Part] = []
    place: Any = patch
    wanted = parts_of(issue.pointer)
    for part in wanted:
        if isinstance(place, list) and part.isdigit() and int(part) < len(place):
            place = place[int(part)]
        elif isinstance(place, dict) and part in place:
            place = place[part]
        else:
            break
        parts.append(part)
    where = pointer("stages", index, *parts)
    if len(parts) == len(wanted):
        return Issue(where, issue.message, issue.hint, issue.column)
    return Issue(where, f"with this stage, {issue.pointer}: {issue.message}", issue.hint)
