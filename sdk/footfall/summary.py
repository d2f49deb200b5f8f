"""A result in plain text: a summary, the mesh table, the certificate, the trajectory."""

from collections.abc import Iterable, Mapping, Sequence
from itertools import islice
from typing import Any

import numpy as np

from footfall.curves import Curves
from footfall.modes import ModeSequence

_MOST_COLUMNS = 13  # of a table of numbers that still fits on a wide terminal
_MOST_MODES = 40  # of a table on a terminal

VERDICTS = {
    "certified": "certified",
    "not_certified": "NOT certified",
    "not_checked": "not checked",
}


def in_words(result: Mapping[str, Any]) -> str:
    """All that a person reads on a terminal: summary, trajectories, how they came, certificate."""
    parts = [
        ("", summarize(result)),
        *(
            (f"Trajectory of {phase['name']} (t in s)\n", trajectory_table(phase))
            for phase in result["phases"]
        ),
        *([("Modes\n", modes_in_words(result))] if result.get("mode_sequence") else []),
        *([("Stages\n", stage_table(result))] if result.get("stages") else []),
        *([("Distinct minima\n", minima_table(result))] if result.get("minima") else []),
        *([("Homotopy\n", pass_table(result))] if result.get("complementarity") else []),
        ("Mesh refinement\n", mesh_table(result)),
        ("Certificate\n", certificate_table(result)),
    ]
    return "\n\n".join(head + text for head, text in parts)


def summarize(result: Mapping[str, Any]) -> str:
    """Status, objective, mesh, certificate, and what stands out."""
    mesh = published_mesh(result)
    solver, timing = result["solver"], result["timing"]
    lines = [
        f"{result['name']}: {words(result['status'])}",
        f"  {result['message']}",
        f"  objective    {number(result['objective'], 10)}",
        f"  certificate  {VERDICTS[result['certificate']['verdict']]}",
        f"  solver       {_solver(solver)}",
        f"  time         {timing['total']:.2f} s",
    ]
    if mesh:
        error = f"{error_name(result)} {number(mesh['max_error'], 3)}"
        lines.insert(4, f"  mesh         {plural(mesh['segments'], 'segment')}, {error}")
    lines += _parts(result, mesh)
    if solver["residuals"] and result["status"] != "converged":
        worst = solver["residuals"][0]
        lines.append(f"  worst        {worst['name']}: {number(worst['value'], 3)}{place(worst)}")
    lines += [f"  warning: {text}" for text in result.get("warnings", [])]
    lines += [f"  advice: {text}" for text in result.get("advice", [])]
    return "\n".join(lines)


def error_name(result: Mapping[str, Any]) -> str:
    """What the error of a mesh is: of time steps through contact, what they lose by themselves."""
    stepped = any("impulses" in phase["groups"] for phase in result["phases"])
    return "lost by steps" if stepped else "largest error"


def _solver(solver: Mapping[str, Any]) -> str:
    text = f"{solver['backend']}, {solver['iterations']} iterations on the last mesh"
    strategy = solver.get("strategy", "default")
    return text if strategy == "default" else f"{text}, strategy {words(strategy)}"


def _parts(result: Mapping[str, Any], mesh: Mapping[str, Any]) -> list[str]:
    """The phases where there are several, the statics, the switches, the stages and minima."""
    lines, phases = [], result["phases"]
    if len(phases) > 1:
        lines = [f"  phase        {_phase(phase)}" for phase in phases]
    lines += [
        f"  static       {name} = {number(value, 10)}"
        for name, value in result.get("static", {}).items()
    ]
    if modes := result.get("mode_sequence"):
        lines.append(f"  modes        {mode_count(modes)}")
    if pairs := result.get("complementarity"):
        lines.append(f"  contact      {pairs_in_words(pairs)}")
    if switches := mesh.get("switches"):
        at = ", ".join(number(time, 6) for time in switches)
        lines.append(f"  switches     controls switch at t = {at} s")
    if stages := result.get("stages"):
        lines.append(f"  stages       {len(stages)} solved in a row")
    if minima := result.get("minima"):
        guesses = sum(len(one["seeds"]) for one in minima)
        distinct = f"{len(minima)} distinct" if len(minima) > 1 else "1"
        lines.append(f"  minima       {distinct}, from {guesses} guesses that led to a motion")
    return lines


def _phase(phase: Mapping[str, Any]) -> str:
    start, end = phase["knots"][0], phase["knots"][-1]
    size = plural(len(phase["knots"]) - 1, "segment")
    return f"{phase['name']}: {number(start, 6)} to {number(end, 6)} s, {size}"


def published_mesh(result: Mapping[str, Any]) -> Mapping[str, Any]:
    """The mesh of the published curves: not the last one where that ended worse than before."""
    segments = sum(len(phase["knots"]) - 1 for phase in result["phases"])
    meshes = reversed(result["mesh_refinement"]["iterations"])
    return next((mesh for mesh in meshes if mesh["segments"] == segments), {})


def mesh_table(result: Mapping[str, Any]) -> str:
    """One line for each mesh of the refinement; the polynomials' degrees where they are told."""
    meshes = result["mesh_refinement"]["iterations"]
    degrees = any(mesh.get("degrees") for mesh in meshes)
    rows = [
        [
            str(index + 1),
            str(mesh["segments"]),
            *[degree_range(mesh.get("degrees", []))] * degrees,
            number(mesh["max_error"], 3),
            number(mesh["objective"], 10),
            str(mesh["nlp_iterations"]),
            f"{mesh['seconds']:.3f}",
        ]
        for index, mesh in enumerate(meshes)
    ]
    head = ["mesh", "segments", *["degrees"] * degrees]
    return table([*head, "max error", "objective", "iterations", "seconds"], rows)


def degree_range(degrees: Sequence[int]) -> str:
    """The degrees of a mesh's polynomials: one number, or from the least to the most."""
    if not degrees:
        return "-"
    low, high = min(degrees), max(degrees)
    return str(low) if low == high else f"{low} to {high}"


def mode_count(sequence: Mapping[str, Any]) -> str:
    """How many modes there are in a sequence, and how many of them are distinct."""
    count = plural(len(sequence["modes"]), "mode")
    return f"{count}, {sequence['distinct']} distinct of {sequence['possible']:,} possible"


def modes_in_words(result: Mapping[str, Any]) -> str:
    """The mode sequence: a line over time for each contact, then its modes; the guess's above."""
    found = result["mode_sequence"]
    guessed = result.get("guessed_sequence")
    parts = [
        *(
            ["of the guess", ModeSequence.of(guessed).timeline(), "of the result"]
            if guessed
            else []
        ),
        ModeSequence.of(found).timeline(),
        mode_table(found["modes"]),
    ]
    return "\n".join(parts)


def mode_table(modes: Sequence[Mapping[str, Any]]) -> str:
    """One line for each of the first modes."""
    rows = [
        [number(mode["start"], 6), number(mode["end"], 6), mode_words(mode)]
        for mode in islice(modes, _MOST_MODES)
    ]
    more = len(modes) - len(rows)
    return table(["from", "to", "contacts"], rows, left=3) + (f"\nand {more} more" if more else "")


def mode_words(mode: Mapping[str, Any]) -> str:
    """Which contacts touch, and how."""
    touching = [f"{name} {words(how)}" for name, how in mode["contacts"].items()]
    return ", ".join(touching) or "none touches"


def pairs_in_words(pairs: Mapping[str, Any]) -> str:
    """How near to exact complementarity is, and what is proved of it."""
    kind = pairs.get("stationarity")
    said = [
        f"complementary within {number(pairs['residual'], 3)}",
        "polished" if pairs["polished"] else "not polished",
        *([f"stationary: {kind}"] if kind else []),
        *([f"{plural(pairs['pinned'], 'pair')} pinned by the ends"] if pairs["pinned"] else []),
    ]
    if (lost := pairs.get("dissipation")) is not None:
        said.append(f"steps lose {100 * lost:.3g} % of the actuators' work")
    return ", ".join(said)


def pass_table(result: Mapping[str, Any]) -> str:
    """One line for each pass of the homotopy on the published mesh."""
    rows = [
        [
            number(one["relaxation"], 3),
            words(one["form"]),
            number(one["residual"], 3),
            number(one["objective"], 10),
            str(one["nlp_iterations"]),
            f"{one['seconds']:.3f}",
            words(one["status"]),
        ]
        for one in result["complementarity"]["passes"]
    ]
    head = ["relaxation", "form", "residual", "objective", "iterations", "seconds", "status"]
    return table(head, rows)


def stage_table(result: Mapping[str, Any]) -> str:
    """One line for each stage of those solved in a row."""
    rows = [
        [
            str(index + 1),
            number(stage["objective"], 10),
            str(stage["segments"]),
            str(stage["nlp_iterations"]),
            f"{stage['seconds']:.3f}",
            words(stage["status"]),
        ]
        for index, stage in enumerate(result["stages"])
    ]
    return table(["stage", "objective", "segments", "iterations", "seconds", "status"], rows)


def minima_table(result: Mapping[str, Any]) -> str:
    """One line for each distinct minimum, with the seeds of the guesses that led to it."""
    rows = [
        [
            str(index + 1),
            number(one["objective"], 10),
            words(one["status"]),
            VERDICTS[one["verdict"]],
            ", ".join(map(str, one["seeds"])),
        ]
        for index, one in enumerate(result["minima"])
    ]
    return table(["minimum", "objective", "status", "certificate", "seeds"], rows)


def certificate_table(result: Mapping[str, Any]) -> str:
    """One line for each check of the certificate, and the verdict."""
    certificate = result["certificate"]
    rows = [
        [check["name"], number(check["value"], 3), number(check["tolerance"], 3), judgement(check)]
        for check in certificate["checks"]
    ]
    head = table(["check", "value", "tolerance", "judgement"], rows)
    return f"{head}\nverdict: {VERDICTS[certificate['verdict']]}\n{certificate['note']}"


def trajectory_table(phase: Mapping[str, Any], count: int = 11) -> str:
    """States and controls of one phase at ``count`` times, evenly over it."""
    times = np.linspace(phase["knots"][0], phase["knots"][-1], count)
    columns = {"t": times}
    for group in ("states", "controls"):
        if group in phase["curves"]:
            columns |= Curves.from_dict(phase["curves"][group]).sample(times)
    left_out = list(columns)[_MOST_COLUMNS:]
    columns = dict(islice(columns.items(), _MOST_COLUMNS))
    rows = [
        [f"{round(value, 4) + 0.0:.4f}" for value in row]
        for row in zip(*columns.values(), strict=True)
    ]
    rest = f"\nnot shown: {', '.join(left_out)}" if left_out else ""
    return table(list(columns), rows) + rest


def table(head: Sequence[str], rows: Iterable[Sequence[str]], left: int = 1) -> str:
    """Columns under their heads: the first ``left`` of them flush left, the others right."""
    lines = [list(head), *map(list, rows)]
    widths = [max(len(line[i]) for line in lines) for i in range(len(head))]
    return "\n".join(
        "  ".join(
            cell.ljust(width) if i < left else cell.rjust(width)
            for i, (cell, width) in enumerate(zip(line, widths, strict=True))
        ).rstrip()
        for line in lines
    )


def judgement(check: Mapping[str, Any]) -> str:
    """What a check says: passed, failed, or only reported."""
    if not check["judged"]:
        return "reported"
    return "passed" if check["passed"] else "FAILED"


def place(residual: Mapping[str, Any]) -> str:
    """Where a residual sits, in words: phase and time, as far as there are any."""
    phase = f" in {residual['phase']}" if residual.get("phase") else ""
    time = f" at t = {residual['time']:.4g} s" if residual.get("time") is not None else ""
    return phase + time


def number(value: float | None, digits: int) -> str:
    """A number with ``digits`` significant digits; a dash for none."""
    return "-" if value is None else f"{value:.{digits}g}"


def plural(count: int, noun: str) -> str:
    """``1 segment``, ``2 segments``."""
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"


def words(status: str) -> str:
    """A status as words: ``locally_infeasible`` is "locally infeasible"."""
    return status.replace("_", " ")
