"""Decision variables: a growing table of blocks, each with limits, guess, scale and names."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Indices = NDArray[np.int_]


@dataclass(frozen=True, slots=True)
class Block:
    """Variables added together. All arrays have shape (names, nodes).

    ``fractions`` (nodes,) says where in its phase each node lies, NaN for what has no time.
    """

    phase: int | None
    names: tuple[str, ...]
    fractions: Array
    lower: Array
    upper: Array
    guess: Array
    scale: Array
    indices: Indices


@dataclass(slots=True)
class Variables:
    """The table. Blocks keep their order; ``add`` returns where each variable stands."""

    blocks: list[Block] = field(default_factory=list)
    size: int = 0

    def add(
        self,
        phase: int | None,
        names: tuple[str, ...],
        fractions: Array,
        limits: tuple[Array, Array],
        guess: Array,
        scale: Array,
    ) -> Indices:
        """Append a block; limits and guess (names, nodes), scale (names,). Indices, node-major."""
        shape = (len(names), len(fractions))
        indices = self.size + np.arange(shape[0] * shape[1]).reshape(shape, order="F")
        lower, upper = (np.broadcast_to(side, shape).copy() for side in limits)
        block = Block(
            phase,
            names,
            fractions,
            lower,
            upper,
            np.clip(np.broadcast_to(guess, shape), lower, upper),
            np.broadcast_to(scale[:, None], shape).copy(),
            indices,
        )
        self.blocks.append(block)
        self.size += indices.size
        return indices

    def gather(self, attribute: str) -> Array:
        """One attribute of all blocks as a vector (size,)."""
        vector = np.empty(self.size)
        for block in self.blocks:
            vector[block.indices] = getattr(block, attribute)
        return vector
