"""
Create messages with default values quickly.

The constructor of a generated class imports the classes of its fields, each of which it creates
twice if a value is given. Copying a blank message takes a quarter of the time.
"""

from collections.abc import Callable
from functools import cache, partial
from operator import getitem
from typing import Any, TypeVar

Message = TypeVar('Message')


def create_message(kind: Callable[[], Message]) -> Message:
    """Return what `kind()` returns, a message with default values; `kind` is a generated class."""
    return _find_copier(kind)()  # type: ignore[no-any-return]


@cache
def _find_copier(kind: Any) -> Callable[[], Any]:  # noqa: ANN401 - a generated class
    return _build_copier(kind())


def _build_copier(blank: Any) -> Callable[[], Any]:  # noqa: ANN401 - a generated class
    """Return a function that returns copies of a message."""
    kind = type(blank)
    slots = {name: getattr(blank, name) for name in kind.__slots__}
    constant: list[tuple[str, Any]] = []
    # Functions that create the values that a copy must not share
    own: list[tuple[str, Callable[[], Any]]] = []
    for name, value in slots.items():
        if hasattr(value, 'get_fields_and_field_types'):
            own.append((name, _build_copier(value)))
        elif isinstance(value, list):
            own.append((name, value.copy))
        elif hasattr(value, 'tobytes'):
            # numpy or array.array, of which a slice is a copy; a slice of numpy is none
            own.append((name, getattr(value, 'copy', partial(getitem, value, slice(None)))))
        else:
            constant.append((name, value))
    new = object.__new__

    def copy() -> Any:  # noqa: ANN401 - of the class
        message = new(kind)
        for name, value in constant:
            setattr(message, name, value)
        for name, create in own:
            setattr(message, name, create())
        return message

    return copy
