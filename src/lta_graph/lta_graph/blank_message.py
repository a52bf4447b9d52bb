"""
Create messages with default values quickly.

The constructor of a generated class imports the classes of its fields, each of which it creates
twice if a value is given. A function that is generated from a blank message, with one assignment
for each field of it and of its parts, takes a tenth of the time.
"""

from array import array
from collections.abc import Callable
from functools import cache
from typing import Any, TypeVar

Message = TypeVar('Message')


def create_message(kind: Callable[[], Message]) -> Message:
    """Return what `kind()` returns, a message with default values; `kind` is a generated class."""
    return _build_creator(kind)()  # type: ignore[no-any-return]


@cache
def _build_creator(kind: Any) -> Callable[[], Any]:  # noqa: ANN401 - a generated class
    """Return a function that returns copies of a blank message."""
    lines: list[str] = []
    space: dict[str, Any] = {'new': object.__new__}
    last = _add_copy(kind(), lines, space)
    exec('\n    '.join(['def create():', *lines, f'return {last}']), space)
    return space['create']  # type: ignore[no-any-return]


def _add_copy(blank: Any, lines: list[str], space: dict[str, Any]) -> str:  # noqa: ANN401
    """Append the lines that copy a message or another value; return the copy's expression."""
    own = f'v{len(space)}'
    if hasattr(blank, 'get_fields_and_field_types'):
        space[own], copy = type(blank), f'{own}_copy'
        lines.append(f'{copy} = new({own})')
        for name in blank.__slots__:
            lines.append(f'{copy}.{name} = {_add_copy(getattr(blank, name), lines, space)}')
        return copy
    if hasattr(blank, 'copy'):  # a list or an array of numpy
        space[own] = blank.copy
        return f'{own}()'
    space[own] = blank
    # Numbers and texts cannot change, so copies share them
    return f'{own}[:]' if isinstance(blank, array) else own
