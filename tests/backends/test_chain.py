"""Stage order: what has one, what is carried along, and what has none."""

from typing import Any

import numpy as np
import pytest

import examples
from solver.backends import make_backend
from solver.backends.chain import Chain, NoChain, Pattern, find_chain
from tests.backends.tasks import example, posed, run
from tests.unit.solver.problems import block


def pattern(rows: list[list[int]], pairs: list[tuple[int, int]]) -> Pattern:
    entries = [(row, column) for row, columns in enumerate(rows) for column in columns]
    one, other = zip(*entries, strict=True)
    ones, others = zip(*pairs, strict=True) if pairs else ((), ())
    return Pattern(*(np.array(side, dtype=int) for side in (one, other, ones, others)))


def chain(rows: list[list[int]], nodes: list[int], pairs: list[tuple[int, int]]) -> Chain:
    return find_chain(np.array(nodes), pattern(rows, pairs), np.ones(len(rows), dtype=bool))


def neighbours(count: int) -> list[list[int]]:
    """One state at each knot, each row joins two neighbours."""
    return [[k, k + 1] for k in range(count - 1)]


def test_a_chain_of_neighbours() -> None:
    found = chain(neighbours(5), [0, 1, 2, 3, 4], [(k, k) for k in range(5)])
    assert found.states.tolist() == [0, 1, 1, 1, 1]  # the first state is nobody's successor
    assert found.inputs.tolist() == [2, 1, 1, 1, 0]  # it is an input, as are the copies
    assert found.constraints.tolist() == [1, 1, 1, 1, 0]
    assert found.source[found.primary].tolist() == [0, 1, 2, 3, 4]
    # A gap row joins the next state to its copy, both of one variable.
    _, following, copies = found.gaps
    assert found.source[following].tolist() == found.source[copies].tolist() == [1, 2, 3, 4]


def test_entries_stay_in_their_stage() -> None:
    found = chain(neighbours(6), list(range(6)), [(k, k) for k in range(6)])
    stage_of = np.repeat(np.arange(6), found.states + found.inputs)
    rows = np.repeat(np.arange(6), found.constraints + np.append(found.states[1:], 0))
    assert (rows[found.jacobian[0]] == stage_of[found.jacobian[1]]).all()
    assert (stage_of[found.hessian[0]] == stage_of[found.hessian[1]]).all()


def test_what_all_stages_use_is_carried_along() -> None:
    rows = [[*row, 5] for row in neighbours(5)]
    found = chain(rows, [0, 1, 2, 3, 4, -1], [(5, 5)])
    assert found.states.tolist() == [1, 2, 2, 2, 2]
    assert np.count_nonzero(found.source == 5) == 5


def test_an_end_in_a_constraint_over_both_is_carried_along() -> None:
    found = chain([*neighbours(8), [0, 7]], list(range(8)), [])
    assert np.count_nonzero(found.source == 0) == 7
    assert found.constraints.tolist() == [2, 1, 1, 1, 1, 1, 1]


def test_a_row_over_all_stages_has_no_chain() -> None:
    with pytest.raises(NoChain, match="integral"):
        chain([*neighbours(8), list(range(8))], list(range(8)), [])


def test_too_few_segments() -> None:
    with pytest.raises(NoChain, match="segments"):
        chain(neighbours(3), [0, 1, 2], [])


@pytest.mark.parametrize("segments", [10, 100])
def test_each_segment_is_a_stage(segments: int) -> None:
    task = posed(example("cart_pole", kind="radau", segments=segments, points=3)).task
    assert task.nodes is not None
    assert len(np.unique(task.nodes)) == 3 * segments + 1


def test_both_ends_in_one_constraint_solve() -> None:
    """A block that comes to rest where it likes, one metre from where it started."""
    document = block(
        phase={
            "bounds": {"x": [-3, 3], "u": [-50, 50]},
            "initial": {"v": 0},
            "final": {"v": 0},
            "boundary": [
                {"name": "way", "expression": "final.x - initial.x", "lower": 1, "upper": 1}
            ],
        }
    )
    outcome = run("fatrop", posed(document).task)
    assert outcome.point.objective == pytest.approx(12.0, rel=1e-6)


REFUSED: dict[str, tuple[dict[str, Any], str]] = {
    "an integral in a constraint": (
        block(objective={"minimize": "effort^2"}),
        "fatrop does not accept this problem because an integral",
    ),
    "one segment": (
        example("cart_pole", kind="chebyshev_lobatto", segments=1),
        "fatrop does not accept this problem because it has fewer than 3 segments",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_fatrop_refuses_by_name(case: str) -> None:
    document, words = REFUSED[case]
    refusal = make_backend("fatrop").refusal(posed(document).task)
    assert refusal.startswith(words)
    assert "ipopt" in refusal


@pytest.mark.parametrize("backend", ["ipopt", "uno", "sqp"])
def test_the_others_refuse_nothing(backend: str) -> None:
    for document, _ in REFUSED.values():
        assert make_backend(backend).refusal(posed(document).task) == ""


def test_every_example_is_accepted_or_refused_in_words() -> None:
    accepted = {
        name: make_backend("fatrop").refusal(posed(examples.load(name)).task)
        for name in ("cart_pole", "brachistochrone", "moon_landing", "bryson_denham", "quadrotor")
    }
    assert set(accepted.values()) == {""}
