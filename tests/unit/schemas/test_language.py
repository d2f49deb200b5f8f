"""The examples of docs/language.md are problems."""

import json
import re
from pathlib import Path
from typing import Any

import pytest

from schemas.limits import MODEL_LIMITS
from schemas.reading import canonical, read_problem
from schemas.stages import merged

TEXT = (Path(__file__).parents[3] / "docs/language.md").read_text()
EXAMPLES = [json.loads(block) for block in re.findall(r"```json\n(.*?)```", TEXT, re.DOTALL)]


def whole(index: int) -> Any:
    """The example, put into the last one before it that is a problem of its own."""
    if isinstance(EXAMPLES[index].get("phases"), list):
        return EXAMPLES[index]
    start = max(k for k in range(index) if isinstance(EXAMPLES[k].get("phases"), list))
    return merged(EXAMPLES[start], EXAMPLES[index])


@pytest.mark.parametrize("index", range(len(EXAMPLES)))
def test_an_example_is_a_problem(index: int) -> None:
    problem = read_problem(whole(index))
    assert canonical(read_problem(canonical(problem))) == canonical(problem)


def test_there_are_examples_of_everything() -> None:
    assert {field for example in EXAMPLES for field in example} >= {
        *("phases", "linkages", "static", "objective", "nonsmooth", "guess", "stages"),
    }


@pytest.mark.parametrize(
    ("words", "limit"),
    [("phases", "phases"), ("statics", "static"), ("stages", "stages"), ("starts", "multistart"),
     ("linkages", "constraints"), ("states", "states"), ("integrals", "integrals")],
)  # fmt: skip
def test_the_limits_are_those_of_the_schema(words: str, limit: str) -> None:
    assert f"{getattr(MODEL_LIMITS, limit)} {words}" in TEXT
