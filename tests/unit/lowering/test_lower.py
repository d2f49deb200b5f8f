"""Systems lowered to first order: chains of integrators, unknowns, definitions, closed forms."""

from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from schemas.errors import BadProblem, InvalidModel
from schemas.expressions import derivative, names_in, parse, split
from schemas.problem import Problem
from schemas.reading import read_problem
from solver.lowering import lower, lower_native
from tests.unit.lowering.curves import rate, times
from tests.unit.lowering.forms import complete, form_of, problem, value

SWING: dict[str, Any] = {
    "kind": "second_order",
    "parameters": {"b": 0.2, "k": 3},
    "coordinates": ["x"],
    "controls": ["u"],
    "accelerations": {"x": "-b*d(x) - k*sin(x) + u"},
}
CART: dict[str, Any] = {  # 003, equations 8.37 and 8.38; tip by its position
    "kind": "second_order",
    "parameters": {"m1": 2, "m2": 0.5, "l": 0.5, "g": 9.81},
    "coordinates": ["x", "th"],
    "controls": ["u"],
    "define": {"px": "x + l*sin(th)", "py": "-l*cos(th)"},
    "residual": [
        "u - m2*(-l*d(th)^2*sin(th) + dd(x) + l*dd(th)*cos(th)) - m1*dd(x)",
        "-l*m2*(l*dd(th) + dd(x)*cos(th) + g*sin(th))",
    ],
}
BLOCK: dict[str, Any] = {
    "kind": "ode",
    "states": ["x", "v"],
    "controls": ["u"],
    "define": {"power": "u*v"},
    "derivatives": {"x": "v", "v": "u"},
}
FLIGHT: dict[str, Any] = {
    "kind": "closed_form",
    "parameters": {"g": 9.81},
    "define": {"since": "t - initial.t"},
    "states": {"y": "initial.y + initial.v*since - g*since^2/2", "v": "initial.v - g*since"},
}
JERK_8_40 = (
    "(-l*d(th)^3*cos(th) - 3*l*d(th)*dd(th)*sin(th) + ddd(x) + l*ddd(th)*cos(th))^2"
    " + l^2*(-d(th)^3*sin(th) + 3*d(th)*dd(th)*cos(th) + ddd(th)*sin(th))^2"
)
SNAP_8_41 = (
    "(-3*l*dd(th)^2*sin(th) - 6*l*dd(th)*d(th)^2*cos(th) + l*d(th)^4*sin(th)"
    " - 4*ddd(th)*l*d(th)*sin(th) + dddd(x) + dddd(th)*l*cos(th))^2"
    " + l^2*(3*dd(th)^2*cos(th) - 6*dd(th)*d(th)^2*sin(th) - d(th)^4*cos(th)"
    " + 4*ddd(th)*d(th)*cos(th) + dddd(th)*sin(th))^2"
)


def push(t: Any, order: int = 0) -> Any:
    """The control 3 sin(2 t) and its derivatives."""
    return 3 * 2**order * np.sin(2 * t + order * np.pi / 2)


def moved(system: dict[str, Any], integrand: str, t: np.ndarray) -> dict[str, np.ndarray]:
    """Everything of a form at times from 0, on the motion under `push`, integrated separately."""
    form, plain = form_of(system, integrand), form_of(system, "u^2")

    def slope(t: float, x: np.ndarray) -> list[float]:
        inputs = {"t": np.float64(t), "u": push(np.float64(t))}
        names = complete(plain, {**inputs, **dict(zip(plain.states, x, strict=True))})
        return [float(value(plain.derivatives[name], names)) for name in plain.states]

    start = np.full(len(plain.states), 0.3)
    tight = {"method": "DOP853", "rtol": 1e-13, "atol": 1e-14, "max_step": 0.02}
    run = solve_ivp(slope, (0, t[-1]), start, t_eval=t, **tight)
    known = {"t": t, **dict(zip(plain.states, run.y, strict=True))}
    inputs = (name for name in (*form.states, *form.controls) if name not in known)
    return complete(form, known | {name: push(t, split(name).order) for name in inputs})


def holds(of: dict[str, np.ndarray], name: str, order: int) -> None:
    """A derivative is the rate of the one before it."""
    exact = rate(of[derivative(name, order - 1)])
    found = of[derivative(name, order)]
    assert found == pytest.approx(exact, abs=1e-8 * (1 + np.abs(exact).max()))


@pytest.mark.parametrize(
    ("integrand", "states", "controls", "rates"),
    [
        ("u^2", ["x", "d(x)"], ["u"], []),
        ("dd(x)^2", ["x", "d(x)"], ["u"], []),
        ("d(u)^2", ["x", "d(x)", "u"], ["d(u)"], ["d(u)"]),
        ("ddd(x)^2", ["x", "d(x)", "u"], ["d(u)"], ["d(u)"]),
        ("dddd(x)^2", ["x", "d(x)", "u", "d(u)"], ["dd(u)"], ["d(u)", "dd(u)"]),
        ("dddd(x)^2 + dddd(u)", ["x", "d(x)", "u", "d(u)", "dd(u)", "ddd(u)"], ["dddd(u)"],
         ["d(u)", "dd(u)", "ddd(u)", "dddd(u)"]),
    ],
)  # fmt: skip
def test_a_chain_is_as_long_as_what_is_used(
    integrand: str, states: list[str], controls: list[str], rates: list[str]
) -> None:
    form = form_of(SWING, integrand)
    assert list(form.states) == states
    assert list(form.controls) == controls
    assert set(form.derivatives) == set(states)
    assert form.unknowns == ()
    assert {name: list(series) for name, series in form.publish.items()} == {
        "states": ["x", "d(x)"],
        "controls": ["u"],
        "rates": rates,
    }


def test_accelerations_to_snap_are_those_of_the_motion() -> None:
    along = moved(SWING, "dddd(x)^2", times(1.0))
    for order in (1, 2, 3, 4):
        holds(along, "x", order)


def test_implicit_accelerations_to_snap_are_those_of_the_motion() -> None:
    form = form_of(CART, "dddd(px)^2 + dddd(py)^2")
    assert [group.names for group in form.unknowns] == [
        ("dd(x)", "dd(th)"),
        ("ddd(x)", "ddd(th)"),
        ("dddd(x)", "dddd(th)"),
    ]
    assert [group.labels[1] for group in form.unknowns] == [
        "dynamics 1",
        "d(dynamics 1)",
        "dd(dynamics 1)",
    ]
    along = moved(CART, "dddd(px)^2 + dddd(py)^2", times(1.0))
    for order in (1, 2, 3, 4):
        holds(along, "x", order)
        holds(along, "th", order)


@pytest.mark.parametrize(("order", "by_hand"), [(3, JERK_8_40), (4, SNAP_8_41)])
def test_the_tip_moves_as_derived_by_hand(order: int, by_hand: str) -> None:
    ours = " + ".join(f"{derivative(name, order)}^2" for name in ("px", "py"))
    along = moved(CART, ours, times(1.0))
    expected = value(parse(by_hand), along)
    assert value(parse(ours), along) == pytest.approx(expected, rel=1e-10)
    assert np.abs(expected).min() > 1


def test_unknowns_are_as_few_as_what_is_used() -> None:
    assert [group.names for group in form_of(CART, "u^2").unknowns] == [("dd(x)", "dd(th)")]
    assert form_of(CART, "dd(px)^2").controls == ("u",)
    assert len(form_of(CART, "ddd(px)^2").unknowns) == 2


def test_definitions_come_after_what_they_need() -> None:
    form = form_of(CART, "dddd(px)^2 + dd(py)*px")
    leaves = {*form.states, *form.controls, *form.algebraic, *form.constants, "t"}
    for name, tree in form.definitions.items():
        assert {used.name for used in names_in(tree)} <= leaves
        leaves.add(name)
    assert {"px", "dd(py)", "dddd(px)"} <= leaves


def test_first_order_systems_have_derivatives_too() -> None:
    integrand = "d(power)^2 + ddd(x)^2 + dd(x) + power"
    form = form_of(BLOCK, integrand)
    assert form.states == ("x", "v", "u")
    assert form.controls == ("d(u)",)
    along = moved(BLOCK, integrand, times(0.7))
    holds(along, "x", 3)
    assert along["d(power)"] == pytest.approx(rate(along["power"]), abs=1e-8)


def test_what_nothing_needs_is_left_out() -> None:
    form = form_of(BLOCK, "u^2")
    assert dict(form.definitions) == {}
    assert form.derivatives == {"x": parse("v"), "v": parse("u")}


@pytest.mark.parametrize(
    "phase",
    [
        {"bounds": {"d(u)": [-1, 1]}},
        {"initial": {"d(u)": 0}},
        {"final": {"dd(v)": 0}},
        {"path": [{"name": "c", "expression": "d(power)", "upper": 1}]},
        {"boundary": [{"name": "c", "expression": "final.d(u) - initial.d(u)", "upper": 1}]},
    ],
)
def test_bounds_ends_and_constraints_ask_for_derivatives(phase: dict[str, Any]) -> None:
    assert form_of(BLOCK, "u^2", **phase).controls == ("d(u)",)


def test_a_guess_does_not_change_what_is_solved() -> None:
    guess = {"kind": "constant", "values": {"d(u)": 1}}
    assert form_of(BLOCK, "u^2", guess=guess).controls == ("u",)


def two_phases(**more: Any) -> Problem:
    names = ("push", "coast")
    phases = [{"name": name, "system": BLOCK, "time": {"duration": 1}} for name in names]
    objective = {"minimize": "coast.final.dd(x)"}
    return read_problem({"phases": phases, "objective": objective, **more})


def test_objective_and_linkages_ask_the_phase_that_they_name() -> None:
    push_, coast = lower(two_phases())
    assert ("d(v)" in push_.definitions, "dd(x)" in coast.definitions) == (False, True)
    link = {"name": "l", "expression": "push.final.d(u) - coast.initial.u", "lower": 0}
    push_, coast = lower(two_phases(linkages=[link]))
    assert (push_.controls, coast.controls) == (("d(u)",), ("u",))


def test_statics_are_constants_over_time() -> None:
    system = {**SWING, "accelerations": {"x": "-length*sin(x) + u*length^2"}}
    document = {
        "static": {"length": {"bounds": [0.5, 2]}},
        "phases": [
            {"system": system, "time": {"final": 1}, "integrals": {"cost": "ddd(x)^2"}},
        ],
    }
    form = lower(read_problem(document))[0]
    assert "length" not in form.constants
    assert "length" in {name.name for name in names_in(form.definitions["ddd(x)"])}
    assert not [name for name in form.definitions if name.endswith("(length)")]


def test_powers_by_parameters_have_no_singular_derivatives() -> None:
    system = {**BLOCK, "parameters": {"two": 2}, "define": {"w": "x^two"}}
    form = form_of(system, "dddd(w)")
    known = {"t": 0.0, "x": 0.0, "v": 2.0, "u": 3.0, "d(u)": 5.0, "dd(u)": 7.0}
    along = complete(form, {name: np.asarray(one) for name, one in known.items()})
    assert along["dddd(w)"] == pytest.approx(6 * 3.0**2 + 8 * 2.0 * 5.0)


def test_long_expressions_and_long_chains_stay_small() -> None:
    terms = [f"sin({index}*x/30)*v^2/(2 + cos(v*{index}/30))" for index in range(1, 61)]
    ratio = f"({' + '.join(terms[:30])})/(100 + {' + '.join(terms[30:])})"
    define = {"w0": ratio, "w1": "*".join(["(1 + x/9)"] * 40)}
    define |= {f"w{index}": f"w{index - 1} + x*w{index - 2}/9" for index in range(2, 400)}
    system = {**BLOCK, "define": define}
    along = moved(system, "ddd(w20) + dd(w20) + dd(w0) + dd(w1) + dd(w399)", times(0.5))
    for name, order in (("w0", 1), ("w0", 2), ("w1", 2), ("w20", 3)):
        holds(along, name, order)


def test_closed_forms_flow() -> None:
    form = form_of(FLIGHT, "y*v")
    assert form.states == ("y", "v")
    assert form.controls == ()
    assert form.derivatives == {}
    assert list(form.flow) == ["y", "v"]
    known = {"t": 0.5, "initial.t": 0.2, "initial.y": 1.0, "initial.v": 2.0}
    along = complete(form, {name: np.asarray(one) for name, one in known.items()})
    assert value(form.flow["y"], along) == pytest.approx(1 + 2 * 0.3 - 9.81 * 0.3**2 / 2)
    assert value(form.flow["v"], along) == pytest.approx(2 - 9.81 * 0.3)


@pytest.mark.parametrize(
    ("integrand", "rates"), [("u^2 + dddd(x)^2", []), ("dd(u) + dd(py)", ["d(u)", "dd(u)"])]
)
def test_a_native_form_takes_derivatives_from_the_method(integrand: str, rates: list[str]) -> None:
    form = lower_native(problem(CART, integrand), 0)
    assert form.states == ("x", "th", "d(x)", "d(th)", "dd(x)", "dd(th)")
    assert form.controls == ("u", "d(u)")
    assert form.natives == ("ddd(x)", "ddd(th)", "dddd(x)", "dddd(th)", "dd(u)")
    assert form.unknowns == ()
    assert list(form.residuals) == ["dynamics 0", "dynamics 1"]
    assert form.publish["states"] == ("x", "th", "d(x)", "d(th)")
    assert list(form.publish["rates"]) == rates


def test_native_and_first_order_forms_agree_along_a_motion() -> None:
    integrand = "dddd(px)^2 + dddd(py)^2"
    chain = moved(CART, integrand, times(1.0))
    form = lower_native(problem(CART, integrand), 0)
    series = (*form.states, *form.controls, *form.natives, "t")
    native = complete(form, {name: chain[name] for name in series})
    for name in ("dddd(px)", "dddd(py)"):
        assert native[name] == pytest.approx(chain[name], rel=1e-9, abs=1e-9)
    for tree in form.residuals.values():
        assert value(tree, native) == pytest.approx(np.zeros(21), abs=1e-11)


def test_given_accelerations_are_residuals_of_a_native_form() -> None:
    form = lower_native(problem(SWING, "dddd(x)^2"), 0)
    along = moved(SWING, "dddd(x)^2", times(1.0))
    assert value(form.residuals["dynamics x"], along) == pytest.approx(np.zeros(21), abs=1e-12)
    assert form.definitions == {}


def unchecked(system: dict[str, Any], integrand: str) -> Problem:
    """A problem that has been past the shape only: what the checks of the language refuse."""
    phase = {"system": system, "time": {"final": 1}, "integrals": {"cost": integrand}}
    return Problem.model_validate({"phases": [phase], "objective": {"minimize": "cost"}})


@pytest.mark.parametrize(
    "system",
    [
        {**BLOCK, "derivatives": {"x": "v", "v": "u + dd(x)"}},
        {**SWING, "define": {"a": "dd(x)"}, "accelerations": {"x": "u + a"}},
        {**CART, "define": {"px": "ddd(x)"}, "residual": ["u - px", "dd(th)"]},
    ],
)
def test_equations_that_need_themselves_are_refused(system: dict[str, Any]) -> None:
    with pytest.raises(InvalidModel, match="/phases/0/system: "):
        lower(unchecked(system, "u^2"))
    with pytest.raises(BadProblem):
        problem(system, "u^2")


def test_a_native_form_ends_at_its_highest_derivatives() -> None:
    with pytest.raises(InvalidModel, match="'dddd\\(x\\)' is the highest"):
        lower_native(unchecked({**SWING, "define": {"w": "d(x)^2"}}, "dddd(w)"), 0)
    with pytest.raises(InvalidModel, match="'dd\\(u\\)' is the highest"):
        lower_native(unchecked(SWING, "ddd(u)"), 0)


def test_names_of_pieces_are_no_users() -> None:
    form = form_of(CART, "dddd(px)^2 + dddd(py)^2")
    pieces = [name for name in form.definitions if "#" in name]
    assert pieces
    with pytest.raises(ValueError, match=r"comments are not part"):
        parse(pieces[0])
