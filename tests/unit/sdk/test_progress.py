"""Progress in plain lines: what begins anew is named, and every job says how it ended."""

import io
from typing import Any

from footfall.cli.progress import progress
from footfall.sse import Event

MESH = {"mesh": 0, "segments": 10, "max_error": None, "tolerance": 1e-6, "objective": 2.5}


def lines(*events: tuple[str, dict[str, Any]]) -> list[str]:
    stream = io.StringIO()
    with progress(stream) as shown:
        for kind, data in events:
            shown(Event(kind, {"type": kind, **data}))
    return stream.getvalue().splitlines()


def test_stages_guesses_and_splits_have_lines_of_their_own() -> None:
    notes = ("stage 2 of 3", "guess 4 of 6", "split at 1 switch")
    assert lines(*(("stage", {"stage": "build", "note": note}) for note in notes)) == list(notes)


def test_other_notes_stand_behind_what_goes_on() -> None:
    assert lines(("stage", {"stage": "solve", "note": "again, from a cold start"})) == [
        "solving again, from a cold start"
    ]
    assert lines(("stage", {"stage": "build"})) == ["building the model"]


def test_meshes_and_ends() -> None:
    said = lines(
        ("mesh", {**MESH, "nlp_iterations": 7, "seconds": 0.1}),
        ("state", {"status": "succeeded", "message": "The iterates diverged."}),
        ("state", {"status": "running"}),
    )
    assert said == [
        "mesh 1: 10 segments, max error - (tolerance 1e-06), objective 2.5, 7 iterations",
        "job succeeded: The iterates diverged.",
        "job running",
    ]


def test_passes_of_a_homotopy() -> None:
    one = {"mesh": 0, "relaxation": 1e-3, "form": "fischer_burmeister", "status": "optimal"}
    said = lines(
        ("homotopy", {**one, "nlp_iterations": 7, "objective": 2.5, "residual": 1e-3}),
        ("homotopy", {**one, "nlp_iterations": 1, "objective": None, "residual": None}),
    )
    assert said == [
        "  relaxed to 0.001 by fischer burmeister: optimal, objective 2.5, 7 iterations",
        "  relaxed to 0.001 by fischer burmeister: optimal, objective -, 1 iteration",
    ]
