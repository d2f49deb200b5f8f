"""When ``footfall serve`` starts a part again."""

import sys
import time
from pathlib import Path

from footfall.parts import Lives, Part


def test_what_has_lived_is_started_again_at_once() -> None:
    lives = Lives(started=time.monotonic() - 60, brief=7)
    assert lives.ended()
    assert not lives.hopeless


def test_what_keeps_ending_has_to_wait() -> None:
    lives = Lives()
    waits = []
    for _ in range(8):
        at_once = lives.ended()
        assert lives.again is not None
        waits.append(0.0 if at_once else round(lives.again - time.monotonic()))
        lives.began()
    assert waits == [0, 0, 1, 2, 4, 8, 10, 10]
    assert lives.hopeless


def test_it_is_counted_once_however_often_it_is_looked_at() -> None:
    lives = Lives()
    assert all(lives.ended() for _ in range(5))
    assert lives.brief == 1


def test_a_part_tells_how_it_ended(tmp_path: Path) -> None:
    words = [sys.executable, "-c", "import sys; sys.exit('no such planet')"]
    part = Part("api", words, tmp_path / "api.log", {})
    assert part.wait(time.monotonic() + 10)
    assert part.ended == 1
    assert part.last_words().startswith("no such planet")
    part.start_again()
    assert part.wait(time.monotonic() + 10)
    assert (tmp_path / "api.log").read_text().count("no such planet") == 2
