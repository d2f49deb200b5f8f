"""The comparison: ``python -m benchmarks peers``.

Each tool gets the coarsest setting at which its objective is within 1e-5 of the optimum; then all
take turns. Each with its own defaults, the same guess, one thread.
"""

from collections.abc import Mapping
from dataclasses import replace

from benchmarks.peers.installing import NotInstallable
from benchmarks.peers.measuring import EQUAL
from benchmarks.peers.problems import PROBLEMS
from benchmarks.peers.running import Entrant, Failed, Measured, measure, search

OURS = Entrant("Footfall", "footfall")
PEERS = (
    Entrant("Drake, IPOPT", "drake", "ipopt"),
    Entrant("Drake, SNOPT", "drake", "snopt"),
    Entrant("maptor", "maptor"),
    Entrant("yapss", "yapss"),
)
ROUNDS = 2
"""Every tool is measured this often, in turns; the best counts: others use this machine, too."""

PROCESS_AIM, NLP_AIM = 3.0, 1.0
"""How many times as fast as the fastest peer: the whole process, the NLP solver alone."""

_COLUMNS = {
    "NLP ms": "nlp",
    "build+solve ms": "warm",
    "process ms": "process",
    "processor ms": "processor",
    "MB": "megabytes",
}


def main() -> None:
    """Print a table for each problem."""
    for problem in PROBLEMS:
        settings, notes = _settings(problem)
        rounds = [
            {entrant: measure(entrant, problem, *found) for entrant, found in settings.items()}
            for _ in range(ROUNDS)
        ]
        best = {entrant: _best([one[entrant] for one in rounds]) for entrant in settings}
        _show(problem, best)
        print(*notes, sep="\n", end="\n" * bool(notes))


def _settings(problem: str) -> tuple[dict[Entrant, tuple[str, int]], list[str]]:
    """What each tool needs for the accuracy; and a line for each that does not get there."""
    settings, notes = {}, []
    for entrant in (OURS, *PEERS):
        try:
            found = search(entrant, problem)
        except NotInstallable as why:
            notes.append(f"{entrant.label}: not installable because: {why}")
        except Failed as why:
            notes.append(f"{entrant.label}: failed: {why}")
        else:
            if found is None:
                notes.append(f"{entrant.label}: no setting reached {EQUAL:g} in time")
            else:
                settings[entrant] = found
    return settings, notes


def _best(rounds: list[Measured]) -> Measured:
    least = {name: min(getattr(one, name) for one in rounds) for name in _COLUMNS.values()}
    return replace(rounds[0], **least)


def _show(problem: str, best: Mapping[Entrant, Measured]) -> None:
    print(f"\n{problem}, |J - J*| <= {EQUAL:g} J*, J* = {PROBLEMS[problem].optimum}")
    heads = "".join(f"{head:>16}{'x ours':>8}" for head in _COLUMNS)
    print(f"{'':14}{'setting':22}{'error':>10}{'iter.':>7}{heads}")
    ours = best.get(OURS)
    for entrant, one in best.items():
        count = "-" if one.iterations is None else one.iterations
        cells = "".join(_cell(one, ours, name) for name in _COLUMNS.values())
        print(f"{entrant.label:14}{one.setting:22}{one.error:10.1e}{count:>7}{cells}")
    peers = {entrant: one for entrant, one in best.items() if entrant != OURS}
    if ours and peers:
        _verdict("the whole process", peers, ours, "process", PROCESS_AIM)
        _verdict("the NLP solver alone", peers, ours, "nlp", NLP_AIM)


def _cell(one: Measured, ours: Measured | None, name: str) -> str:
    value = getattr(one, name)
    shown = value if name == "megabytes" else value * 1e3
    ratio = f"{value / getattr(ours, name):8.2f}" if ours else f"{'':8}"
    return f"{shown:16.1f}{ratio}"


def _verdict(
    what: str, peers: Mapping[Entrant, Measured], ours: Measured, name: str, aim: float
) -> None:
    fastest = min(peers, key=lambda entrant: float(getattr(peers[entrant], name)))
    ratio = getattr(peers[fastest], name) / getattr(ours, name)
    said = "met" if ratio >= aim else "MISSED"
    print(
        f"{what}: {ratio:.2f} times as fast as the fastest, {fastest.label} (aim {aim:g}: {said})"
    )


if __name__ == "__main__":
    main()
