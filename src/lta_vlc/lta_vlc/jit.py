"""Compile the inner loops of the light processing: no reordering, cached on disk."""

from collections.abc import Callable
from typing import cast, TypeVar

from numba import njit

Function = TypeVar('Function', bound=Callable[..., object])


def compile_kernel(function: Function) -> Function:
    """
    Return a function of numbers and arrays compiled at its first call.

    Numba keeps it on disk until its own file changes, so what it calls must stand in that file.
    """
    return cast('Function', njit(error_model='numpy', fastmath=False, cache=True)(function))
