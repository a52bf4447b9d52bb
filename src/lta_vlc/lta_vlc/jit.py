"""Compile the inner loops of the light processing: no reordering, cached on disk."""

from collections.abc import Callable
from typing import cast, TypeVar

from lta_config.compilation.kernel_cache import import_numba
from lta_config.machine import find_cache_folder

Function = TypeVar('Function', bound=Callable[..., object])


def compile_kernel(function: Function) -> Function:
    """
    Return a function of numbers and arrays compiled at its first call.

    Numba keeps it on disk until its own file changes, so what it calls must stand in that file.
    """
    import_numba()
    from numba import config, njit

    before = config.CACHE_DIR  # type: ignore[attr-defined]
    # Beside the sources, numba's default, is not writable where LTA is installed for all users
    config.CACHE_DIR = str(find_cache_folder('functions'))  # type: ignore[attr-defined]
    try:
        return cast('Function', njit(error_model='numpy', fastmath=False, cache=True)(function))
    finally:
        # Other kernels are cached in their own folders
        config.CACHE_DIR = before  # type: ignore[attr-defined]
