"""The cart-pole on one mesh: Footfall's engine against a hand-written CasADi script.

Run: python -m benchmarks.cart_pole
"""

import examples
from benchmarks.handwritten import Handwritten, build
from benchmarks.table import Row, in_turn, show, timed
from schemas.reading import read_problem
from schemas.results import Solution
from solver import solve

RUNS = 25


def main() -> None:
    """Print the table."""
    document = examples.load("cart_pole") | {"refinement": None}
    ready: Handwritten = build()
    solutions: list[Solution] = []

    def ours() -> float:
        solutions.append(solve(read_problem(document)))
        return solutions[-1].timing.build + solutions[-1].timing.solve

    whole, alone, total, by_hand, by_hand_alone = in_turn(
        RUNS,
        ours,
        lambda: solutions[-1].solver.seconds,
        lambda: solutions[-1].timing.total,
        lambda: timed(lambda: build().solve()),
        lambda: timed(ready.solve),
    )
    show(
        "cart-pole, 25 Hermite-Simpson segments, in-process, medians",
        [
            Row("build and solve", whole, by_hand, aim=2.5),
            Row("NLP solve alone", alone, by_hand_alone, aim=1.3),
            Row("everything, with error and certificate", total, by_hand),
        ],
        theirs="by hand",
    )


if __name__ == "__main__":
    main()
