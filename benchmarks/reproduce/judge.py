"""Whether a row came out as it should."""

from benchmarks.reproduce.rows import Measured, Row, Verdict

SOLVED = frozenset({"converged", "acceptable", "certificate_failed", "mesh_limit"})
"""The NLP reached an optimum; a coarse mesh need not be accurate."""


def judge(row: Row, measured: Measured) -> Verdict:
    """Three questions: solved, the optimum met, the printed value met or its difference told."""
    if measured.status not in SOLVED:
        return Verdict(not row.meets, f"{measured.status}. {row.why}".strip())
    if row.kind == "audit" and not row.meets:
        return Verdict(False, "its audit was to fail, and passed")
    if row.optimum is not None and row.meets and not _meets(row, measured):
        return Verdict(False, f"misses the optimum. {row.why}".strip())
    if not _prints(row.printed, measured) and not row.why:
        return Verdict(False, "differs from the printed value, and nobody says why")
    return Verdict(True, row.why or "as it should be")


def _meets(row: Row, measured: Measured) -> bool:
    value = measured.refined if row.refinement is not None else measured.objective
    if value is None or row.optimum is None:
        return False
    return abs(value - row.optimum) <= row.tolerance * max(1.0, abs(row.optimum))


def _prints(printed: str, measured: Measured) -> bool:
    """Whether ours, rounded as the seed rounded, is what it printed (to one of the last digit)."""
    try:
        value = float(printed)
    except ValueError:
        return not printed
    unit = 10.0 ** -len(printed.partition(".")[2])
    ours = (measured.objective, measured.refined)
    return any(one is not None and abs(one - value) <= 1.01 * unit for one in ours)
