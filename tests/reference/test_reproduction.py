"""The seeds' tables: one command solves and writes them, and what is written has every row."""

import re
from dataclasses import replace
from functools import partial
from pathlib import Path
from random import Random

import pytest

import examples
from benchmarks.reproduce.__main__ import DOCUMENT, PICTURE, main
from benchmarks.reproduce.judge import judge
from benchmarks.reproduce.measure import document, measure, run_from
from benchmarks.reproduce.pictures import SLIDE, STICKS, draw
from benchmarks.reproduce.rows import Measured, Row
from benchmarks.reproduce.scenarios import choose, problem, random_start, scenarios
from benchmarks.reproduce.slip_sums import least_sums
from benchmarks.reproduce.tables import TABLES
from schemas.problem import Problem
from schemas.reading import read_problem
from schemas.results import Solution, SolutionStatus
from solver import solve

ROOT = Path(__file__).parents[2]
ROWS = [(table, row) for table in TABLES for row in table.rows]


def test_a_section_from_nothing(tmp_path: Path) -> None:
    path = tmp_path / "out.md"
    assert main(["--only", "7.7", "--output", str(path)]) == 0
    text = path.read_text(encoding="utf-8")
    assert "## 7.7: block, least force" in text
    assert "| trapezoidal, 25 segments |" in text
    assert "12.074961" in text


def test_a_section_that_is_not_there(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["--only", "9.9"])
    assert "there are 7.7" in capsys.readouterr().err


def test_the_document_has_every_row_and_no_failure() -> None:
    text = (ROOT / DOCUMENT).read_text(encoding="utf-8")
    section = re.compile(r"^## ([^:]+): [^\n]*\n(.*?)(?=^## |\Z)", re.MULTILINE | re.DOTALL)
    sections = dict(section.findall(text))
    assert set(sections) == {table.section for table in TABLES}
    for table, row in ROWS:
        assert f"| {row.name} |" in sections[table.section], row.name
        if row.printed:
            assert row.printed in sections[table.section], row.name
    assert "**fails**" not in text
    assert (ROOT / PICTURE).exists()


@pytest.mark.parametrize("pair", ROWS, ids=lambda pair: f"{pair[0].section} {pair[1].name}")
def test_every_row_asks_for_a_good_problem(pair: tuple) -> None:
    _, row = pair
    if row.kind != "sums":
        read_problem(document(row, row.refinement, row.refined))
        read_problem(document(row, None, {}))
    assert "|" not in row.name + row.why, "a bar would end the cell"


def test_rows_have_names_of_their_own() -> None:
    for table in TABLES:
        names = [row.name for row in table.rows]
        assert len(set(names)) == len(names)


GOOD = Measured("certificate_failed", 9.24, 1e-4, 12, 0.1, 9.2226, 100)


@pytest.mark.parametrize(
    ("row", "measured", "passed"),
    [
        (Row("", "", printed="9.24", optimum=9.2226), GOOD, True),
        (Row("", "", printed="9.24", optimum=9.2), GOOD, False),
        (Row("", "", printed="9.2", optimum=9.2226), GOOD, True),
        (Row("", "", printed="9.50", optimum=9.2226), GOOD, False),
        (Row("", "", printed="9.50", optimum=9.2226, why="another minimum"), GOOD, True),
        (Row("", "", optimum=9.2, meets=False, why="coarse"), GOOD, True),
        (Row("", "", optimum=9.24, refinement=None), GOOD, True),
        (Row("", ""), Measured("diverged", None, None, 12, 0.1), False),
        (Row("", "", printed="diverged"), GOOD, False),
        (Row("", "", kind="audit", meets=False), GOOD, False),
        (Row("", "", kind="audit", meets=False), replace(GOOD, status="failed: energy"), True),
        (Row("", "", kind="audit"), replace(GOOD, status="failed: energy"), False),
    ],
)
def test_a_row_is_judged(row: Row, measured: Measured, passed: bool) -> None:
    assert judge(row, measured).passed is passed


def test_the_seeds_sums() -> None:
    """004: its own ten nodes, its own sums, in a row."""
    sums = least_sums()
    assert sums["actuation"] == pytest.approx(0.2050505, abs=1e-7)
    assert sums["work"] == pytest.approx(0.280342, abs=1e-6)


def test_a_run_from_a_random_guess_counts_where_it_is_certified(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    solution = solve(read_problem(examples.load("slip_str") | {"refinement": None}))
    whole: list[Problem] = []

    def solved(problem: Problem, status: SolutionStatus, verdict: str) -> Solution:
        whole.append(problem)
        certificate = solution.certificate.model_copy(update={"verdict": verdict})
        return solution.model_copy(update={"status": status, "certificate": certificate})

    counted = []
    for status, verdict in (
        (SolutionStatus.CONVERGED, "certified"),
        (SolutionStatus.MESH_LIMIT, "certified"),
        (SolutionStatus.CERTIFICATE_FAILED, "not_certified"),
    ):
        monkeypatch.setattr(
            "benchmarks.reproduce.measure.solve", partial(solved, status=status, verdict=verdict)
        )
        counted.append(run_from("slip_str", seed=5)[1])
    assert counted == [True, False, False]
    assert [len(problem.stages) for problem in whole] == [3, 3, 3], "all steps"
    assert all(problem.guess.kind == "random" for problem in whole)


def test_the_last_stage_alone_is_refined() -> None:
    row = next(row for _, row in ROWS if row.name == "stl_str, work")
    stages = document(row, row.refinement, {})["stages"]
    assert [stage["refinement"] for stage in stages] == [None, None, row.refinement]
    assert examples.load("slip_stl_str")["stages"] != stages


def test_a_printed_row_of_table_8_1() -> None:
    row = next(row for _, row in ROWS if row.name == "snap, no limit, DirCol5i")
    found = measure(row)
    assert found.objective == pytest.approx(0, abs=1e-7), "on the table's own mesh"
    assert judge(row, found).passed


def test_scenarios_are_the_same_for_the_same_seed() -> None:
    first, again = (random_start(Random(3)) for _ in range(2))  # noqa: S311 - no secrets
    assert first == again
    assert (first["x"] - first["xtoe"]) ** 2 + first["y"] ** 2 == pytest.approx(1)
    assert 0 <= first["xtoe"] <= 1


def test_the_better_sequence_is_chosen() -> None:
    [choice] = scenarios(1, seed=1, tries=1)
    assert set(choice.work) == {"sli_str", "sli_stl_str"}
    possible = {name: cost for name, cost in choice.work.items() if cost is not None}
    assert choice.best == min(possible, key=lambda name: possible[name])


def test_a_start_that_no_sequence_can_save() -> None:
    fast = dict(random_start(Random(0)), xdot=60.0, xtoedot=60.0)  # noqa: S311 - no secrets
    choice = choose(fast, tries=1)
    assert choice.best is None
    assert read_problem(problem("sli_str", fast, seed=2)).guess.kind == "random"


def test_the_picture_is_in_the_seeds_colours() -> None:
    row = next(row for _, row in ROWS if row.name == "sli_str, actuation squared")
    picture = draw({"sli_str": solve(read_problem(document(row, None, {})))})
    assert SLIDE in picture
    assert STICKS[0] in picture, "the only stick is the first one"
    assert STICKS[1] not in picture
