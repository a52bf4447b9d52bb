"""
Compile a core that uses nested named tuples, and call it with flat arrays.

Passing named tuples to and from compiled code costs about 0.1 us per number, more than the
arithmetic on it. So the compiled text gets an entry that reads the tuples from float64 arrays and
writes the new memory back. The text is extracted from the sources, and its hash is the cache key.
"""

from collections.abc import Callable, Iterator
from functools import cache
from typing import Any, cast, final, Generic, TypeVar

from lta_config.compilation.compiler import ENTRY, INLINE
from lta_config.compilation.extract import SourceExtract
from lta_config.compilation.kernel_cache import load_kernel
from lta_config.settings import to_named_tuple
import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel

Array = NDArray[np.float64]
Nested = TypeVar('Nested', bound=tuple[Any, ...])

PREFIX = 'core'
HEAD = '''"""A core with an entry that takes arrays, written by lta_config: do not edit."""

from collections import namedtuple
import math

from numba import njit
'''


def settings_to_tuples(value: Any) -> Any:  # noqa: ANN401 - any nest of numbers
    """Return nested tuples with all settings converted to named tuples."""
    if isinstance(value, BaseModel):
        return to_named_tuple(value)
    if hasattr(value, '_fields'):
        return type(value)(*map(settings_to_tuples, value))
    return value


@final
class TupleLayout(Generic[Nested]):
    """
    The position of each number of nested tuples in an array.

    Parameters
    ----------
    example : tuple
        Any value: bools, ints, floats and tuples of these, named or not.

    """

    def __init__(self, example: Nested) -> None:
        self._example = settings_to_tuples(example)
        self.paths = tuple(_iterate_paths(self._example))
        self.size = len(self.paths)
        text = self.render_expression('n')
        # Names and types decide equality, since compiled code depends on both
        self._form = f'{text} {self._tuple_fields()}'
        # Generated code, as in a named tuple's own constructor: three times as fast as recursion
        self._made = eval(f'lambda n: {text}', dict(_iterate_types(self._example)))

    def __eq__(self, other: object) -> bool:
        """Return whether another layout has the same names and types."""
        return isinstance(other, TupleLayout) and self._form == other._form

    def __hash__(self) -> int:
        """Return a hash consistent with equality."""
        return hash(self._form)

    def write(self, value: Nested) -> Array:
        """Return the numbers of a value as an array, shape (n,)."""
        return np.array(list(_iterate_numbers(settings_to_tuples(value))), dtype=np.float64)

    def read(self, array: Array) -> Nested:
        """Return the value that an array of shape (n,) holds."""
        # Indexing a list is faster than indexing a numpy array
        return cast('Nested', self._made(array.tolist()))

    def part_slice(self, path: str) -> slice:
        """Return the slice of a part, such as `estimate.attitude`."""
        inside = [
            index
            for index, own in enumerate(self.paths)
            if own == path or own.startswith((f'{path}.', f'{path}['))
        ]
        if not inside:
            raise KeyError(path)
        return slice(inside[0], inside[-1] + 1)

    def add_types(self, extract: SourceExtract) -> None:
        """Add the named tuple types to a source, which `render_expression` needs."""
        for _, kind in _iterate_types(self._example):
            extract.add_named_tuple(kind)

    def _tuple_fields(self) -> dict[str, tuple[str, ...]]:
        """Return the fields of each named tuple by its name."""
        return dict(_iterate_fields(self._example))

    def render_expression(self, array: str) -> str:
        """Return the source of an expression that builds the nested tuples from an array."""
        return _render_expression(
            self._example, (f'{array}[{index}]' for index in range(self.size))
        )


def _iterate_paths(value: Any, own: str = '') -> Iterator[str]:  # noqa: ANN401
    if not isinstance(value, tuple):
        yield own
        return
    names = getattr(value, '_fields', None)
    for index, item in enumerate(value):
        inner = f'{own}[{index}]' if names is None else f'{own}.{names[index]}'.lstrip('.')
        yield from _iterate_paths(item, inner)


def _iterate_numbers(value: Any) -> Iterator[float]:  # noqa: ANN401
    if isinstance(value, tuple):
        for item in value:
            yield from _iterate_numbers(item)
    else:
        yield float(value)


def _iterate_types(value: Any) -> Iterator[tuple[str, type]]:  # noqa: ANN401
    if isinstance(value, tuple):
        if hasattr(value, '_fields'):
            yield f'{PREFIX}_{type(value).__name__}', type(value)
        for item in value:
            yield from _iterate_types(item)


def _iterate_fields(value: Any) -> Iterator[tuple[str, tuple[str, ...]]]:  # noqa: ANN401
    if isinstance(value, tuple):
        if hasattr(value, '_fields'):
            yield type(value).__name__, value._fields
        for item in value:
            yield from _iterate_fields(item)


def _render_expression(value: Any, numbers: Iterator[str]) -> str:  # noqa: ANN401
    if isinstance(value, tuple):
        items = ''.join(f'{_render_expression(item, numbers)}, ' for item in value)
        kind = f'{PREFIX}_{type(value).__name__}' if hasattr(value, '_fields') else ''
        return f'{kind}({items})'
    number = next(numbers)
    # Before int, because bool is a subclass of it
    if isinstance(value, bool):
        return f'({number} != 0.0)'
    return f'int({number})' if isinstance(value, int) else number


def render_core_source(
    core: Callable[..., Any],
    constants: TupleLayout[Any],
    memory: TupleLayout[Any],
    inputs: TupleLayout[Any],
) -> str:
    """
    Return the text of a core with an entry that takes arrays.

    Parameters
    ----------
    core : callable
        `core(constants, memory, inputs, scratch) -> memory`; uses plain functions only.
    constants, memory, inputs : TupleLayout
        Layouts of its arguments.

    Returns
    -------
    str
        A module whose `step(constants, memory, inputs, scratch)` overwrites the memory.

    """
    extract = SourceExtract()
    name = extract.add_function(core, PREFIX)
    for layout in (constants, memory, inputs):
        layout.add_types(extract)
    entry = [
        ENTRY,
        'def step(c, m, h, scratch):',
        f'    constants = {constants.render_expression("c")}',
        f'    memory = {memory.render_expression("m")}',
        f'    heard = {inputs.render_expression("h")}',
        f'    after = {name}(constants, memory, heard, scratch)',
        *(f'    m[{index}] = after.{path}' for index, path in enumerate(memory.paths)),
    ]
    return '\n\n\n'.join((HEAD, extract.render_pieces(INLINE), '\n'.join(entry))) + '\n'


@cache
def compile_core(
    core: Callable[..., Any],
    constants: TupleLayout[Any],
    memory: TupleLayout[Any],
    inputs: TupleLayout[Any],
) -> Callable[[Array, Array, Array, Array], None]:
    """Return the entry of `render_core_source`, compiled or loaded from the cache."""
    module = load_kernel(render_core_source(core, constants, memory, inputs))
    return cast('Callable[[Array, Array, Array, Array], None]', module.step)
