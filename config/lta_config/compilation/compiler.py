"""
Compile plain functions of numbers, tuples and arrays, cached on disk by their source.

The text of a function and of everything it uses gives the name of the cache folder (see
`kernel_cache`), so an edit never runs stale code. Operations are not reordered or fused: compiled
and plain functions return the same bits on every processor.
"""

from collections.abc import Callable
from functools import cache
from typing import Any

from lta_config.compilation.extract import SourceExtract
from lta_config.compilation.kernel_cache import load_kernel

HEAD = '''"""Functions taken out of their modules by lta_config; edits here are lost."""

from collections import namedtuple
import math

from numba import njit


'''


# Functions called only from compiled code need no Python wrapper, which is slow to compile.
# Without fastmath nothing is reordered, and error_model='numpy' makes 1/0 inf instead of an
# exception: all forms agree to the bit
OWN = "error_model='numpy', fastmath=False, no_cpython_wrapper=True, no_cfunc_wrapper=True"
INLINE = f'@njit({OWN})'
ENTRY = "@njit(error_model='numpy', fastmath=False, cache=True)"


@cache
def compile_functions(*functions: Callable[..., Any]) -> tuple[Callable[..., Any], ...]:
    """
    Return compiled versions; each compiles on its first call unless it is cached on disk.

    Parameters
    ----------
    *functions : callable
        Top-level functions that use only `math`, numbers and other such functions.

    Raises
    ------
    BadInput
        If one uses anything else.

    """
    extract = SourceExtract()
    # The module's name as a prefix keeps equal names of different modules apart
    names = [
        extract.add_function(function, function.__module__.rsplit('.', 1)[-1])
        for function in functions
    ]
    module = load_kernel(HEAD + extract.render_pieces(INLINE, ENTRY, names) + '\n')
    return tuple(getattr(module, name) for name in names)
