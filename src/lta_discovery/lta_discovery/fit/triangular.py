"""
Solve and invert stacks of lower triangular matrices.

NumPy has no triangular solver for stacks, and its general one takes three times as long. Recursive
halving turns most of the work into matrix products.
"""

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Lower = NDArray[np.floating[Any]]

SMALL: Final = 17  # rows; up to which a general solver is as fast


def solve_lower(lower: Lower, right: Array) -> Array:
    """
    Return the solutions of `lower @ x = right`.

    `lower`, shape (S, n, n): elements above the diagonal have to be 0. `right`, shape (S, n, m).
    """
    out = np.empty(right.shape)
    _solve(lower, right, out)
    return out


def _solve(lower: Lower, right: Array, out: Array) -> None:
    """Write the solutions."""
    count = lower.shape[-1]
    if count <= SMALL:
        # Base case: small enough for the general inverse
        out[...] = np.linalg.inv(lower) @ right
        return
    half = count // 2
    _solve(lower[:, :half, :half], right[:, :half], out[:, :half])
    # Forward substitution by blocks
    rest = right[:, half:] - lower[:, half:, :half] @ out[:, :half]
    _solve(lower[:, half:, half:], rest, out[:, half:])


def invert_lower(lower: Lower) -> Array:
    """Return the inverses of lower triangular matrices, shape (S, n, n)."""
    out = np.zeros(lower.shape)
    _invert(lower, out)
    return out


def _invert(lower: Lower, out: Array) -> None:
    """Write the inverses."""
    count = lower.shape[-1]
    if count <= SMALL:
        out[...] = np.linalg.inv(lower)
        return
    half = count // 2
    first, second = out[:, :half, :half], out[:, half:, half:]
    _invert(lower[:, :half, :half], first)
    _invert(lower[:, half:, half:], second)
    out[:, half:, :half] = -second @ (lower[:, half:, :half] @ first)
