"""Every kind of system, and derivatives: exact motions are certified, wrong ones are not."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from schemas.problem import Problem
from schemas.reading import read_problem
from schemas.results import Certificate, PhaseResult
from solver.certificate import certify
from tests.support.exact import altered, block_problem, curves, failures, result

Functions = dict[str, Callable[[np.ndarray], np.ndarray]]

POLE = {"m1": 2.0, "m2": 0.5, "l": 0.5, "g": 9.81}


def accelerations(q: np.ndarray, w: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Kelly's thesis, 8.37 and 8.38, solved by hand: of the cart and of the pole."""
    m1, m2, length, g = POLE.values()
    s, c = np.sin(q), np.cos(q)
    den = m1 + m2 * s**2
    cart = (length * m2 * s * w**2 + u + m2 * g * c * s) / den
    pole = -(length * m2 * c * s * w**2 + u * c + (m1 + m2) * g * s) / (length * den)
    return np.array([cart, pole])


def push(t: np.ndarray) -> np.ndarray:
    return 3 * np.cos(2 * t) + t


def swing() -> Functions:
    """A motion of the cart-pole from rest under ``push``, over 1.5 s."""

    def rates(t: float, y: np.ndarray) -> np.ndarray:
        return np.concatenate([y[2:], accelerations(y[1], y[3], push(np.array(t)))])

    solution = solve_ivp(
        rates, (0, 1.5), np.zeros(4), method="DOP853", rtol=1e-13, atol=1e-13, dense_output=True
    ).sol

    def row(index: int) -> Callable[[np.ndarray], np.ndarray]:
        return lambda t: solution(np.ravel(t))[index].reshape(np.shape(t))

    return {name: row(index) for index, name in enumerate(["x", "q", "d(x)", "d(q)"])}


def cart_pole(**changes: Any) -> Problem:
    """The cart-pole by its residuals."""
    phase: dict[str, Any] = {
        "name": "swing",
        "system": {
            "kind": "second_order",
            "parameters": POLE,
            "coordinates": ["x", "q"],
            "controls": ["u"],
            "define": {"tip": "x + l*sin(q)"},
            "residual": [
                "(m1 + m2)*dd(x) + m2*l*dd(q)*cos(q) - m2*l*d(q)^2*sin(q) - u",
                "l*dd(q) + dd(x)*cos(q) + g*sin(q)",
            ],
        },
        "time": {"final": 1.5},
        "initial": {"x": 0, "q": 0, "d(x)": 0, "d(q)": 0},
    }
    top = {key: changes.pop(key) for key in list(changes) if key in Problem.model_fields}
    system = {**phase["system"], **changes.pop("system", {})}
    return read_problem({"phases": [{**phase, "system": system, **changes}], **top})


@pytest.fixture(scope="module")
def swung() -> PhaseResult:
    return result(swing(), {"u": push}, np.linspace(0, 1.5, 16), 9, "swing")


def rows(certificate: Certificate) -> dict[str, float | None]:
    return {check.name: check.value for check in certificate.checks}


def test_an_implicit_system_is_judged_by_its_accelerations(swung: PhaseResult) -> None:
    certificate = certify(cart_pole(), [swung], None)
    assert certificate.verdict == "certified"
    assert all(value is not None and value < 1e-9 for value in rows(certificate).values())
    assert "open-loop rollout" in rows(certificate)


def test_an_implicit_system_that_moves_otherwise(swung: PhaseResult) -> None:
    heavier = cart_pole(system={"parameters": POLE | {"m2": 0.6}})
    assert list(failures(certify(heavier, [swung], None))) == ["interval defect"]


def test_accelerations_may_be_bounded_and_stand_at_ends(swung: PhaseResult) -> None:
    t = np.linspace(0, 1.5, 16 * 1000 + 1)
    motion = swing()
    cart, pole = accelerations(motion["q"](t), motion["d(q)"](t), push(t))
    bounds = {
        "dd(x)": [cart.min() - 1e-3, cart.max() + 1e-3],
        "dd(q)": [pole.min() - 1e-3, pole.max() + 1e-3],
    }
    ends = {
        "initial": {"dd(x)": cart[0]},
        "final": {"dd(q)": pole[-1], "d(q)": motion["d(q)"](t)[-1]},
    }
    tip = motion["x"](t) + POLE["l"] * np.sin(motion["q"](t))
    speed = np.gradient(tip, t, edge_order=2)[-1]
    exact = {
        "bounds": bounds,
        **ends,
        "boundary": [
            {"name": "reach", "expression": "final.tip", "lower": tip[-1], "upper": tip[-1]},
            {"name": "speed", "expression": "final.d(tip)", "lower": speed, "upper": speed},
        ],
    }
    assert certify(cart_pole(**exact), [swung], None).verdict == "certified"

    low = {"bounds": bounds | {"dd(q)": [None, pole.max() - 0.1]}}
    failed = failures(certify(cart_pole(**low), [swung], None))
    assert str(failed["state bounds"]).startswith("phase swing, dd(q), t = ")
    other = {"final": {"dd(q)": pole[-1] + 0.1}}
    assert failures(certify(cart_pole(**other), [swung], None)) == {
        "end values": "phase swing, final.dd(q)"
    }
    slower = {"boundary": [{"name": "speed", "expression": "final.d(tip)", "upper": speed - 0.1}]}
    assert failures(certify(cart_pole(**slower), [swung], None)) == {
        "boundary constraints": "phase swing, speed"
    }


def test_the_jerk_of_an_implicit_system_is_that_of_the_motion(swung: PhaseResult) -> None:
    """ddd(q) needs d(u): the control becomes a state."""
    t = np.linspace(0, 1.5, 3001)
    motion = swing()
    pole = accelerations(motion["q"](t), motion["d(q)"](t), push(t))[1]
    jerk = np.gradient(pole, t, edge_order=2)
    worth = np.trapezoid(jerk**2, t)
    change = {"integrals": {"jerk": "ddd(q)^2"}, "objective": {"minimize": "jerk"}}
    problem = cart_pole(**change, certificate={"tolerance": 1e-4})
    rates = curves({"d(u)": lambda t: 1 - 6 * np.sin(2 * t)}, np.array(swung.knots), 9)
    whole = swung.model_copy(update={"curves": {**swung.curves, "rates": rates}})
    assert certify(problem, [whole], worth).verdict == "certified"
    assert list(failures(certify(problem, [whole], worth * 1.01))) == ["objective"]


def test_accelerations_may_be_given(swung: PhaseResult) -> None:
    explicit = {
        "residual": None,
        "define": {"den": "m1 + m2*sin(q)^2"},
        "accelerations": {
            "x": "(l*m2*sin(q)*d(q)^2 + u + m2*g*cos(q)*sin(q)) / den",
            "q": "-(l*m2*cos(q)*sin(q)*d(q)^2 + u*cos(q) + (m1 + m2)*g*sin(q)) / (l*den)",
        },
    }
    assert certify(cart_pole(system=explicit), [swung], None).verdict == "certified"


def test_a_residual_that_no_acceleration_meets_fails(swung: PhaseResult) -> None:
    twice = ["dd(x) + dd(q) - u", "2*dd(x) + 2*dd(q) - u"]
    certificate = certify(cart_pole(system={"residual": twice}), [swung], None)
    assert rows(certificate)["interval defect"] is None
    assert certificate.verdict == "not_certified"


def rated(slope: float) -> PhaseResult:
    """The block at least effort, its control's rate published as ``slope``; it is -12."""
    breaks = np.linspace(0.0, 1.0, 5)
    states: Functions = {"x": lambda t: 3 * t**2 - 2 * t**3, "v": lambda t: 6 * t - 6 * t**2}
    published = result(states, {"u": lambda t: 6 - 12 * t}, breaks, 3, "move")
    rates = curves({"d(u)": lambda t: slope + 0 * t}, breaks, 3)
    return published.model_copy(update={"curves": {**published.curves, "rates": rates}})


def with_rate() -> Problem:
    return block_problem(
        integrals={"effort": "d(u)^2"}, bounds={"d(u)": [-12, 0]}, initial={"u": 6, "d(u)": -12}
    )


def test_the_rate_of_a_control_is_judged() -> None:
    certificate = certify(with_rate(), [rated(-12.0)], 144.0)
    assert certificate.verdict == "certified"
    assert "control overshoot" in rows(certificate)


def test_a_rate_that_is_not_that_of_its_control() -> None:
    failed = failures(certify(with_rate(), [rated(-11.9)], 11.9**2))
    assert str(failed.pop("interval defect")).startswith("phase move, u, t = ")
    assert failed == {"end values": "phase move, initial.d(u)"}


def test_a_rate_out_of_bounds_is_an_overshoot() -> None:
    problem = block_problem(bounds={"d(u)": [-11, None]})
    failed = failures(certify(problem, [rated(-12.0)], 12.0))
    assert failed == {"control overshoot": "phase move, d(u), t = 0 s"}


def test_a_rate_that_is_not_published() -> None:
    published = rated(-12.0)
    without = {label: group for label, group in published.curves.items() if label != "rates"}
    bare = published.model_copy(update={"curves": without})
    assert failures(certify(with_rate(), [bare], 144.0)) == {"curves": "there is no curve of d(u)"}
    assert certify(block_problem(), [bare], 12.0).verdict == "certified"


def test_a_control_that_jumps_has_no_rate() -> None:
    def jump(coefficients: np.ndarray) -> np.ndarray:
        coefficients[2:, 0] += 1e-3
        return coefficients

    problem = block_problem(bounds={"d(u)": [-20, 0]}, final={})
    failed = failures(certify(problem, [altered(rated(-12.0), "controls", "u", jump)], 12.006))
    assert failed["continuity"] == "phase move, u, t = 0.5 s"


def flight(**changes: Any) -> Problem:
    """A ball in the air, in closed form."""
    phase: dict[str, Any] = {
        "name": "flight",
        "system": {
            "kind": "closed_form",
            "parameters": {"g": 9.81},
            "define": {"s": "t - initial.t"},
            "states": {
                "x": "initial.x + initial.vx*s",
                "y": "initial.y + initial.vy*s - g*s^2/2",
                "vx": "initial.vx",
                "vy": "initial.vy - g*s",
            },
        },
        "time": {"initial": 2, "duration": [0.1, 5]},
        "initial": {"x": 0, "y": 1, "vx": [0, None]},
    }
    top = {key: changes.pop(key) for key in list(changes) if key in Problem.model_fields}
    return read_problem({"phases": [{**phase, **changes}], **top})


def flown(g: float = 9.81) -> PhaseResult:
    """From a height of 1 m at 3 m/s and 4 m/s, at t = 2 s, for half a second."""
    motion: Functions = {
        "x": lambda t: 3 * (t - 2),
        "y": lambda t: 1 + 4 * (t - 2) - g * (t - 2) ** 2 / 2,
        "vx": lambda t: 3 + 0 * t,
        "vy": lambda t: 4 - g * (t - 2),
    }
    return result(motion, {}, np.array([2.0, 2.25, 2.5]), 3, "flight")


def test_a_closed_form_is_compared_with_its_formula() -> None:
    certificate = certify(flight(), [flown()], None)
    assert certificate.verdict == "certified"
    assert rows(certificate)["interval defect"] == pytest.approx(0, abs=1e-14)
    assert "open-loop rollout" not in rows(certificate)


def test_a_flight_under_another_gravity() -> None:
    certificate = certify(flight(), [flown(9.5)], None)
    assert failures(certificate) == {"interval defect": "phase flight, vy, t = 2.5 s"}
    assert rows(certificate)["interval defect"] == pytest.approx(0.31 * 0.5 / 5)


def test_a_formula_that_does_not_start_where_it_should() -> None:
    """A posted problem with one is refused; the certificate sees it all the same."""
    system = {"kind": "closed_form", "states": {"x": "initial.x + 1 + t - initial.t"}}
    phase = {"name": "flight", "system": system, "time": {"final": [None, 1]}}
    problem = Problem.model_validate({"phases": [phase]})
    published = result({"x": lambda t: t}, {}, np.array([0.0, 1.0]), 2, "flight")
    assert failures(certify(problem, [published], None)) == {
        "interval defect": "phase flight, x, t = 0 s"
    }


def test_constraints_and_integrals_along_a_closed_form() -> None:
    top = 1 + 4**2 / 2 / 9.81
    exact = {
        "path": [{"name": "height", "expression": "y + 0*s", "lower": 1, "upper": top}],
        "boundary": [{"name": "far", "expression": "final.x + final.s", "lower": 2, "upper": 2}],
        "integrals": {"way": "vx*s"},
        "objective": {"minimize": "way"},
    }
    assert certify(flight(**exact), [flown()], 3 * 0.5**2 / 2).verdict == "certified"
    low = {"path": [{"name": "height", "expression": "y", "upper": top - 0.01}]}
    assert "path constraints" in failures(certify(flight(**low), [flown()], None))
    far = {"boundary": [{"name": "far", "expression": "final.x", "lower": 2}]}
    assert failures(certify(flight(**far), [flown()], None)) == {
        "boundary constraints": "phase flight, far"
    }


def test_a_duration_out_of_bounds() -> None:
    problem = flight(time={"initial": 2, "duration": [0.1, 0.4]})
    assert failures(certify(problem, [flown()], None)) == {"time": "phase flight, duration"}
