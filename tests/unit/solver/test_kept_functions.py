"""Functions kept from one problem to the next: those of the same shape, and no others."""

import copy
import itertools
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from typing import Any

import numpy as np
import pytest

import examples
from schemas.reading import read_problem
from solver.frozen import frozen
from solver.mechanics import limited
from solver.model import symbolic
from solver.model.shape import shape_of
from solver.nlp.kept import Kept, forget
from solver.nlp.scaling import typical_scaling
from solver.nlp.task import NlpTask
from solver.prepare import prepare
from solver.transcribe import stage, transcribe
from solver.transcriptions import make_transcriptions
from tests.support.methods import label, variants
from tests.support.problems import cart_pole

Change = Callable[[dict[str, Any]], None]


def numbers(document: dict[str, Any]) -> list[np.ndarray]:
    """Values and derivatives of a problem's first program, and its limits."""
    model, setting = prepare(limited(read_problem(document)))
    program = transcribe(model, setting).program
    task = NlpTask.of(program, typical_scaling(program))
    random = np.random.default_rng(0)
    z = task.start + 0.1 * random.normal(size=task.start.size)
    lam = random.normal(size=task.row_lower.size)
    found = [
        *task.nlp.evaluate(z),
        task.nlp.gradient(z, [])[1],
        task.nlp.jacobian(z, [])[1],
        task.nlp.hessian(z, [], 0.7, lam),
    ]
    return [
        *(np.array(one.nonzeros()) for one in found),
        task.lower,
        task.upper,
        task.row_lower,
        task.row_upper,
    ]


def changed(change: Change) -> dict[str, Any]:
    document = copy.deepcopy(cart_pole())
    document["method"] = {"kind": "radau", "segments": 3, "points": 3}
    change(document)
    return document


def parameter(name: str, value: object) -> Change:
    def change(document: dict[str, Any]) -> None:
        document["phases"][0]["system"]["parameters"][name] = value

    return change


def put(path: str, value: object) -> Change:
    """Set what is at a path such as ``phases/0/time``."""

    def change(document: dict[str, Any]) -> None:
        *above, last = [int(part) if part.isdigit() else part for part in path.split("/")]
        for part in above:
            document = document[part]  # type: ignore[index]
        document[last] = value  # type: ignore[index]

    return change


CHANGES: dict[str, Change] = {
    "nothing": lambda _: None,
    "a parameter": parameter("m2", 0.35),
    "a parameter to zero": parameter("g", 0),
    "a parameter to one": parameter("m2", 1),
    "a parameter that others are made of": parameter("m1", 1.5),
    "a parameter behind others": parameter("l", "m1/4"),
    "an expression": put("phases/0/system/derivatives/q1", "v1 + 0.1*m2*sin(v1)"),
    "a number in an expression": put("phases/0/system/derivatives/q1", "1.1*v1"),
    "an intermediate": put("phases/0/system/define/den", "m1 + m2*s^4"),
    "an exponent": put("phases/0/system/define/s", "sin(q2)^(2*m1)"),
    "a path constraint": put("phases/0/path/0/expression", "q1 - l*cos(q2)"),
    "a path constraint's limit": put("phases/0/path/0/upper", 1.5),
    "a boundary constraint": put("phases/0/boundary/0/expression", "final.q1 - m2*initial.q1"),
    "a bound": put("phases/0/bounds/u", [-10, 20]),
    "no bound": put("phases/0/bounds", {"u": [-20, 20]}),
    "an integral": put("phases/0/integrals/effort", "m2*u^2"),
    "the objective": put("objective/minimize", "effort + m2*duration"),
    "a factor of an integral": put("objective/minimize", "m2*effort"),
    "another factor of it": put("objective/minimize", "swing_up.g*effort"),
    "an integral that is lifted": put("objective/minimize", "effort^2"),
    "a fixed time": put("phases/0/time/final", 2),
    "another fixed time": put("phases/0/time/final", 3),
    "both times fixed": put("phases/0/time", {"initial": 1, "final": 2}),
    "both times free": put("phases/0/time", {"initial": [0, 1], "final": [1.5, 2]}),
    "an option of the method": put("method", {"kind": "radau", "segments": 3, "points": 2}),
    "another method": put("method", {"kind": "hermite_simpson", "segments": 3}),
    "another form of it": put(
        "method", {"kind": "hermite_simpson", "segments": 3, "form": "compressed"}
    ),
    "another mesh": put("method", {"kind": "radau", "segments": 5, "points": 3}),
}


def assert_same(found: list[np.ndarray], expected: list[np.ndarray]) -> None:
    for ours, theirs in zip(found, expected, strict=True):
        np.testing.assert_array_equal(ours, theirs)


def test_whatever_was_built_before_the_numbers_are_those_of_a_cold_start() -> None:
    """Each after all the others, and in the other order: to the last bit."""
    cold = {}
    for name, change in CHANGES.items():
        forget()
        cold[name] = numbers(changed(change))
    for name in [*CHANGES, *reversed(CHANGES)]:
        assert_same(numbers(changed(CHANGES[name])), cold[name])
    same = [pair for pair in itertools.combinations(cold, 2) if equal(*(cold[p] for p in pair))]
    assert same == [], "a change that changes no number tests nothing"


def equal(ours: list[np.ndarray], theirs: list[np.ndarray]) -> bool:
    return all(np.array_equal(a, b) for a, b in zip(ours, theirs, strict=True))


@pytest.mark.parametrize(
    "name", ["a parameter", "an expression", "an option of the method", "another fixed time"]
)
def test_a_cold_process_says_the_same(name: str) -> None:
    numbers(changed(CHANGES["nothing"]))
    warm = numbers(changed(CHANGES[name]))
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        cold = pool.submit(of_change, name).result()
    assert_same(warm, cold)


def of_change(name: str) -> list[np.ndarray]:
    return numbers(changed(CHANGES[name]))


@pytest.mark.parametrize(("name", "idle"), [("five_link_biped", ["l_torso"]), ("cart_pole", [])])
def test_a_point_of_a_sweep_builds_no_function(
    name: str, idle: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Masses and lengths, and a finer mesh, are other numbers for the same functions."""
    document = examples.load(name)
    parameters = document["phases"][0]["system"]["parameters"]
    for parameter in parameters:
        parameters[parameter] *= 1.1
    forget()
    before = numbers(document)

    def never(*_: object, **__: object) -> None:
        raise AssertionError("a function was built again")

    monkeypatch.setattr(stage, "phase_functions", never)
    monkeypatch.setattr(symbolic, "boundary_scope", never)
    monkeypatch.setattr("solver.nlp.kernel._made", never)
    monkeypatch.setattr("solver.transcribe.stage._made", never)
    monkeypatch.setattr("solver.transcribe.junction._made", never)
    for parameter in parameters:
        point = copy.deepcopy(document)
        point["phases"][0]["system"]["parameters"][parameter] *= 1.1
        assert equal(numbers(point), before) == (parameter in idle)
    document["method"]["segments"] = 30
    numbers(document)


def test_what_decides_the_form_of_a_function_is_in_the_shape() -> None:
    def shape(name: str, value: float) -> object:
        model, _ = prepare(read_problem(changed(parameter(name, value))))
        return shape_of(model)[0]

    assert shape("m2", 0.3) == shape("m2", 0.4) == shape("m2", -0.3)
    assert len({shape("m2", value) for value in (0.3, 0, 1, -1)}) == 4


def test_an_exponent_is_in_the_shape() -> None:
    def shape(value: float) -> object:
        document = changed(put("phases/0/system/define/s", "sin(q2)^l"))
        document["phases"][0]["system"]["parameters"]["l"] = value
        model, _ = prepare(read_problem(document))
        return shape_of(model)[0]

    assert shape(2) == shape(2)
    assert shape(2) != shape(3)


def test_every_choice_of_a_method_is_another_one() -> None:
    methods = variants(second_order=True)
    system = {
        "kind": "second_order",
        "coordinates": ["q"],
        "controls": ["u"],
        "accelerations": {"q": "u"},
    }
    keys = {}
    for method in methods:
        phase = {"system": system, "time": {"final": 1}}
        problem = read_problem({"phases": [phase], "method": {"segments": 2} | method})
        keys[label(method)] = [frozen(one) for one in make_transcriptions(problem)]
    for (one, ours), (other, theirs) in itertools.combinations(keys.items(), 2):
        assert ours != theirs, (one, other)


def test_what_cannot_be_compared_is_refused() -> None:
    with pytest.raises(TypeError, match="cannot be compared"):
        frozen(object())


def test_the_least_recently_used_makes_room() -> None:
    kept: Kept[str] = Kept(10, len)
    made: list[str] = []

    def get(key: str) -> str:
        def make() -> str:
            made.append(key)
            return key

        return kept.get(key, make)

    for key in ("aaaa", "bbbb", "aaaa", "cccc", "aaaa", "bbbb"):
        assert get(key) == key
    assert made == ["aaaa", "bbbb", "cccc", "bbbb"]
    assert get("d" * 11) == "d" * 11, "too large to be kept"
    assert len(kept) == 2
    kept.clear()
    assert len(kept) == 0


def test_what_fails_to_be_made_is_not_kept() -> None:
    kept: Kept[int] = Kept(10)
    with pytest.raises(ZeroDivisionError):
        kept.get("a", lambda: 1 // 0)
    assert kept.get("a", lambda: 2) == 2
