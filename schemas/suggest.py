"""The name that somebody probably meant."""

from collections.abc import Iterable
from difflib import get_close_matches


def did_you_mean(word: str, options: Iterable[str]) -> str:
    """``did you mean 'x'?`` for the option nearest to ``word``, or nothing."""
    known = list(options)[:1000]
    folded = {option.lower(): option for option in known}
    near = get_close_matches(word[:64].lower(), folded, n=1, cutoff=0.6)
    return f"did you mean '{folded[near[0]]}'?" if near else ""
