"""
Parse a message definition stored in a bag, within limits.

rosbags generates Python from definitions by their grammar, so no text is executed. But a recursive
type, or arrays of millions of messages, would never finish there.
"""

from collections.abc import Iterator
from typing import Any, Final

from lta_config.limits import ARRAY_PARTS, DEFINITION_BYTES
from rosbags.interfaces import Nodetype
from rosbags.interfaces.typing import Typesdict
from rosbags.typesys import get_types_from_idl, get_types_from_msg
from rosbags.typesys.base import TypesysError

# Errors that rosbags raises on an invalid definition.
MISDEFINED: Final = (
    TypesysError,
    SyntaxError,
    KeyError,
    ValueError,
    RecursionError,
    AssertionError,
    OverflowError,
)


def parse_definition(text: str, type_name: str, encoding: str) -> Typesdict:
    """
    Parse the definition of a type and its nested types.

    `encoding` is 'ros2idl' or 'ros2msg', which also covers ROS 1.

    Raises
    ------
    TypesysError or another of `MISDEFINED`
        If the definition is invalid, recursive, incomplete or beyond the limits.

    """
    if len(text) > DEFINITION_BYTES:
        raise TypesysError(f'it is longer than {DEFINITION_BYTES} bytes')
    if encoding == 'ros2idl':
        types = get_types_from_idl(text)
    else:
        types = get_types_from_msg(text, type_name)
    count = sum(
        count_unrolled_elements(described)
        for _, fields in types.values()
        for _, described in fields
    )
    if count > ARRAY_PARTS:
        raise TypesysError(f'its arrays have {count} elements, more than {ARRAY_PARTS}')
    behind: set[str] = set()
    for name in types:
        check_nested_types(name, types, (), behind)
    return types


def check_nested_types(
    name: str, types: Typesdict, above: tuple[str, ...], behind: set[str]
) -> None:
    """Check a type and its nested types for recursion; `behind` are the types already checked."""
    if name in above:
        raise TypesysError(f"'{name}' contains itself")
    if name not in types:
        raise TypesysError(f"it lacks '{name}'")
    if name in behind:
        return
    for _, described in types[name][1]:
        for part in iterate_nested_types(described):
            check_nested_types(part, types, (*above, name), behind)
    behind.add(name)


def iterate_nested_types(described: Any) -> Iterator[str]:  # noqa: ANN401 - as rosbags nests it
    """Yield the message type of a field, if it is one."""
    kind, detail = described
    if kind is Nodetype.NAME:
        yield str(detail)
    elif kind is not Nodetype.BASE:
        yield from iterate_nested_types(detail[0])


def count_unrolled_elements(described: Any) -> int:  # noqa: ANN401 - as rosbags nests it
    """Return the number of array elements for which rosbags generates separate code."""
    kind, detail = described
    if kind is not Nodetype.ARRAY:
        return 0
    (inner, what), count = detail
    return int(count) if inner is Nodetype.NAME or what[0] == 'string' else 0
