"""Reading an owner's index, a sorted set of ids by creation, from the newest on."""

from typing import Any, cast

from redis import Redis


def entries(
    client: Redis, index: str, after: tuple[float, str] | None, count: int
) -> list[tuple[float, str]]:
    """The next ``count`` entries after one, newest first: time of creation and id."""
    start = 0
    if after is not None:
        # Entries of one instant are ordered by id; those up to the cursor are skipped.
        start = client.zcount(index, f"({after[0]!r}", "+inf")
        same = cast(Any, client.zrevrangebyscore(index, after[0], after[0]))
        start += sum(member.decode() >= after[1] for member in same)
    found = cast(Any, client.zrevrange(index, start, start + count - 1, withscores=True))
    return [(float(score), member.decode()) for member, score in found]
