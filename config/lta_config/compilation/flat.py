"""
Compile a core that takes and gives nested named tuples, and call it with flat arrays.

Handing a named tuple to compiled code or back costs some 0.1 us a number, more than the arithmetic
on it. So the text that is compiled gets an entry that reads the tuples out of float64 arrays and
writes the new memory back. As with the kernel, the text is taken from the sources with all that
they use, and its hash is what it is kept under: an edit never runs stale.
"""

from collections.abc import Callable, Iterator
from functools import cache
from typing import Any, cast, final, Generic, TypeVar

from lta_config.compilation.compiled import ENTRY, INLINE
from lta_config.compilation.extract import Extract
from lta_config.compilation.kernel_cache import load
from lta_config.settings import plain
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


def bare(value: Any) -> Any:  # noqa: ANN401 - any nest of numbers
    """Return nested tuples with settings in them made named tuples as well."""
    if isinstance(value, BaseModel):
        return plain(value)
    if hasattr(value, '_fields'):
        return type(value)(*map(bare, value))
    return value


@final
class Layout(Generic[Nested]):
    """
    Where each number of a nest of tuples stands in an array.

    Parameters
    ----------
    example : tuple
        Any value: bools, ints, floats and tuples of such, named or not.

    """

    def __init__(self, example: Nested) -> None:
        self._example = bare(example)
        self.paths = tuple(_paths(self._example))
        self.size = len(self.paths)
        text = self.expression('n')
        self._form = f'{text} {self.kinds()}'
        # Written out, as a named tuple's own constructor is: three times as fast as a walk.
        self._made = eval(f'lambda n: {text}', dict(_types(self._example)))

    def __eq__(self, other: object) -> bool:
        """Return whether another stands for the same names and kinds of numbers."""
        return isinstance(other, Layout) and self._form == other._form

    def __hash__(self) -> int:
        """Return what goes with equality."""
        return hash(self._form)

    def write(self, value: Nested) -> Array:
        """Return the numbers of a value as an array, shape (n,)."""
        return np.array(list(_numbers(bare(value))), dtype=np.float64)

    def read(self, array: Array) -> Nested:
        """Return the value that an array, shape (n,), holds."""
        return cast('Nested', self._made(array.tolist()))

    def place(self, path: str) -> slice:
        """Return where a part stands, `estimate.attitude` for example."""
        inside = [
            index
            for index, own in enumerate(self.paths)
            if own == path or own.startswith((f'{path}.', f'{path}['))
        ]
        if not inside:
            raise KeyError(path)
        return slice(inside[0], inside[-1] + 1)

    def kinds(self) -> dict[str, tuple[str, ...]]:
        """Return the fields of each named tuple in it."""
        return dict(_kinds(self._example))

    def expression(self, array: str) -> str:
        """Return the source that makes the nest from an array."""
        return _expression(self._example, (f'{array}[{index}]' for index in range(self.size)))


def _paths(value: Any, own: str = '') -> Iterator[str]:  # noqa: ANN401
    if not isinstance(value, tuple):
        yield own
        return
    names = getattr(value, '_fields', None)
    for index, item in enumerate(value):
        inner = f'{own}[{index}]' if names is None else f'{own}.{names[index]}'.lstrip('.')
        yield from _paths(item, inner)


def _numbers(value: Any) -> Iterator[float]:  # noqa: ANN401
    if isinstance(value, tuple):
        for item in value:
            yield from _numbers(item)
    else:
        yield float(value)


def _types(value: Any) -> Iterator[tuple[str, type]]:  # noqa: ANN401
    if isinstance(value, tuple):
        if hasattr(value, '_fields'):
            yield f'{PREFIX}_{type(value).__name__}', type(value)
        for item in value:
            yield from _types(item)


def _kinds(value: Any) -> Iterator[tuple[str, tuple[str, ...]]]:  # noqa: ANN401
    if isinstance(value, tuple):
        if hasattr(value, '_fields'):
            yield type(value).__name__, value._fields
        for item in value:
            yield from _kinds(item)


def _expression(value: Any, numbers: Iterator[str]) -> str:  # noqa: ANN401
    if isinstance(value, tuple):
        items = ''.join(f'{_expression(item, numbers)}, ' for item in value)
        kind = f'{PREFIX}_{type(value).__name__}' if hasattr(value, '_fields') else ''
        return f'{kind}({items})'
    number = next(numbers)
    if isinstance(value, bool):
        return f'({number} != 0.0)'
    return f'int({number})' if isinstance(value, int) else number


def source(
    core: Callable[..., Any], constants: Layout[Any], memory: Layout[Any], heard: Layout[Any]
) -> str:
    """
    Return the text of a core with an entry that takes arrays.

    Parameters
    ----------
    core : callable
        `core(constants, memory, heard, scratch) -> memory`, plain functions all the way down.
    constants, memory, heard : Layout
        Of its arguments.

    Returns
    -------
    str
        A module whose `step(constants, memory, heard, scratch)` writes the new memory over the
        old.

    """
    extract = Extract()
    name = extract.add(core, PREFIX)
    text = extract.text(INLINE)
    kinds = constants.kinds() | memory.kinds() | heard.kinds()
    missing = [
        f'{PREFIX}_{kind} = namedtuple({kind!r}, {fields!r})'
        for kind, fields in kinds.items()
        if f'{PREFIX}_{kind} = ' not in text
    ]
    entry = [
        ENTRY,
        'def step(c, m, h, scratch):',
        f'    constants = {constants.expression("c")}',
        f'    memory = {memory.expression("m")}',
        f'    heard = {heard.expression("h")}',
        f'    after = {name}(constants, memory, heard, scratch)',
        *(f'    m[{index}] = after.{path}' for index, path in enumerate(memory.paths)),
    ]
    return '\n\n\n'.join((HEAD, '\n'.join(missing), text, '\n'.join(entry))) + '\n'


@cache
def compiled(
    core: Callable[..., Any], constants: Layout[Any], memory: Layout[Any], heard: Layout[Any]
) -> Callable[[Array, Array, Array, Array], None]:
    """Return the entry of `source`, compiled on its first call or found in the cache."""
    module = load(source(core, constants, memory, heard))
    return cast('Callable[[Array, Array, Array, Array], None]', module.step)
