"""
Compile plain functions of numbers, tuples and arrays, kept on disk by the content of their source.

As with the kernel (`kernel_cache`), the text of a function and of all that it uses names the
folder, so that no edit can leave old code behind. Nothing is reordered or fused: compiled, a
function gives what it gives as plain Python, on every processor.
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


# What only compiled code calls needs no way in from Python, which takes long to compile.
# Nothing is reordered and a division by zero gives inf: all forms agree to the bit.
OWN = "error_model='numpy', fastmath=False, no_cpython_wrapper=True, no_cfunc_wrapper=True"
INLINE = f'@njit({OWN})'
ENTRY = "@njit(error_model='numpy', fastmath=False, cache=True)"


@cache
def compile_functions(*functions: Callable[..., Any]) -> tuple[Callable[..., Any], ...]:
    """
    Return the functions compiled; each compiles at its first call, unless it is kept on disk.

    Parameters
    ----------
    *functions : callable
        Plain functions at the top of their modules, which use `math`, numbers and such functions.

    Raises
    ------
    BadInput
        If one uses anything else.

    """
    extract = SourceExtract()
    names = [
        extract.add_function(function, function.__module__.rsplit('.', 1)[-1])
        for function in functions
    ]
    module = load_kernel(HEAD + extract.render(INLINE, ENTRY, names) + '\n')
    return tuple(getattr(module, name) for name in names)
