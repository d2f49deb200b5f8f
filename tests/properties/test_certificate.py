"""Whatever the motion: exact ones are certified, and those with one wrong number are not."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from hypothesis import assume, given
from hypothesis import strategies as st
from numpy.polynomial import Polynomial, polynomial

from schemas.problem import Problem
from schemas.results import PhaseResult
from solver.certificate import certify
from solver.lowering import lower
from solver.refinement.error import segment_errors
from tests.support.exact import altered, block_problem, block_result, result

COEFFICIENT = st.floats(-3, 3).map(lambda value: round(value, 3))
DEGREE = 5


@dataclass(frozen=True)
class Motion:
    """A block under a random polynomial control on each segment, which may jump at breaks."""

    breaks: np.ndarray
    u: list[Polynomial]

    def published(self) -> tuple[Problem, PhaseResult, float]:
        v, x, effort = self._integrated()
        functions = {name: self._along(pieces) for name, pieces in (("x", x), ("v", v))}
        breaks = self.breaks
        published = result(functions, {"u": self._along(self.u)}, breaks, DEGREE, "move")
        ends = {name: [float(f(breaks[i])) for i in (0, -1)] for name, f in functions.items()}
        problem = block_problem(
            time={"initial": breaks[0], "final": breaks[-1]},
            initial={name: value[0] for name, value in ends.items()},
            final={name: value[1] for name, value in ends.items()},
        )
        return problem, published, effort

    def _integrated(self) -> tuple[list[Polynomial], list[Polynomial], float]:
        v0, x0, effort = 0.5, -0.25, 0.0
        v, x = [], []
        for u, a, b in zip(self.u, self.breaks[:-1], self.breaks[1:], strict=True):
            v.append(u.integ(lbnd=a) + v0)
            x.append(v[-1].integ(lbnd=a) + x0)
            v0, x0 = v[-1](b), x[-1](b)
            effort += float((u**2).integ(lbnd=a)(b))
        return v, x, effort

    def _along(self, pieces: list[Polynomial]) -> Callable[[np.ndarray], np.ndarray]:
        """Evaluates at inner points of the segments, or at the very ends of the motion."""

        def function(t: np.ndarray) -> np.ndarray:
            k = np.clip(np.searchsorted(self.breaks, t, side="right") - 1, 0, len(pieces) - 1)
            table = np.stack([np.pad(p.coef, (0, DEGREE + 1 - len(p.coef))) for p in pieces])
            return polynomial.polyval(t, np.moveaxis(table[k], -1, 0), tensor=False)

        return function


@st.composite
def motions(draw: st.DrawFn) -> Motion:
    count = draw(st.integers(1, 6))
    widths = draw(st.lists(st.floats(0.05, 1), min_size=count, max_size=count))
    start = draw(st.floats(-1, 1))
    rows = st.lists(COEFFICIENT, min_size=1, max_size=DEGREE - 1)
    controls = [Polynomial(draw(rows)) for _ in range(count)]
    return Motion(start + np.concatenate([[0.0], np.cumsum(widths)]), controls)


@given(motions())
def test_an_exact_motion_is_certified(motion: Motion) -> None:
    problem, published, effort = motion.published()
    certificate = certify(problem, [published], effort)
    assert certificate.verdict == "certified", certificate.checks
    assert all(check.value is not None and check.value < 1e-9 for check in certificate.checks)


@given(motions(), st.data())
def test_one_changed_coefficient_is_found(motion: Motion, data: st.DataObject) -> None:
    problem, published, effort = motion.published()
    group, name = data.draw(st.sampled_from([("states", "x"), ("states", "v"), ("controls", "u")]))
    segment = data.draw(st.integers(0, len(motion.u) - 1))
    term = data.draw(st.integers(0, DEGREE))
    amount = data.draw(st.sampled_from([-1.0, 1.0]))

    def change(rows: np.ndarray) -> np.ndarray:
        rows[segment, term] += amount * 0.05 * (1 + np.abs(rows).sum(axis=1).max())
        return rows

    certificate = certify(problem, [altered(published, group, name, change)], effort)
    assert certificate.verdict == "not_certified"


@given(motions(), st.floats(1e-3, 10))
def test_a_wrong_objective_is_found(motion: Motion, error: float) -> None:
    problem, published, effort = motion.published()
    assume(error / (1 + effort) > 2e-5)
    assert certify(problem, [published], effort + error).verdict == "not_certified"


def instead(rows: Sequence[tuple[float, ...]]) -> Callable[[np.ndarray], np.ndarray]:
    return lambda _: np.array(rows)


@given(st.data())
def test_garbage_is_judged_and_never_raises(data: st.DataObject) -> None:
    """Also what a diverged solve leaves behind: numbers of any size."""
    published = block_result(2)
    anything = st.floats(allow_nan=False, allow_infinity=False)
    for group, name in (("states", "x"), ("states", "v"), ("controls", "u")):
        rows = data.draw(st.lists(st.tuples(anything, anything, anything), min_size=2, max_size=2))
        published = altered(published, group, name, instead(rows))
    problem = block_problem(
        bounds={"x": [None, 2], "u": [-1, 1]},
        path=[{"name": "power", "expression": "exp(u*v)/x", "upper": 3}],
        boundary=[{"name": "gain", "expression": "final.x/initial.x", "lower": 1}],
    )
    assert certify(problem, [published], 12.0).verdict == "not_certified"
    assert segment_errors(lower(problem)[0], published, {}).shape == (2,)
