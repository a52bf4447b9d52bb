# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Decode messages to objects with the definitions in the bag, within limits; ROS is not needed.

rosbags generates Python from definitions by their grammar, so no text is executed. But a recursive
type, or arrays of millions of messages, would never finish there.
"""

from collections.abc import Iterator, Mapping
from dataclasses import fields
from graphlib import CycleError, TopologicalSorter
import struct
from typing import Any, Final, final

from lta_config.errors import BadInput
from lta_config.limits import ARRAY_PARTS, DEFINITION_BYTES
from mcap.records import Schema
from rosbags.interfaces import Nodetype
from rosbags.interfaces.typing import Typesdict
from rosbags.serde import SerdeError
from rosbags.typesys import get_types_from_idl, get_types_from_msg, get_typestore, Stores
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
    nested = {
        name: [part for _, described in fields for part in iterate_nested_types(described)]
        for name, (_, fields) in types.items()
    }
    if missing := {part for parts in nested.values() for part in parts} - nested.keys():
        raise TypesysError(f"it lacks '{min(missing)}'")
    try:
        TopologicalSorter(nested).prepare()
    except CycleError as error:
        raise TypesysError(f"'{error.args[1][0]}' contains itself") from error
    return types


def iterate_nested_types(described: Any) -> Iterator[str]:
    """Yield the message type of a field, if it is one."""
    kind, detail = described
    if kind is Nodetype.NAME:
        yield str(detail)
    elif kind is not Nodetype.BASE:
        yield from iterate_nested_types(detail[0])


def count_unrolled_elements(described: Any) -> int:
    """Return the number of array elements for which rosbags generates separate code."""
    kind, detail = described
    if kind is not Nodetype.ARRAY:
        return 0
    (inner, what), count = detail
    return int(count) if inner is Nodetype.NAME or what[0] == 'string' else 0


READABLE_ENCODINGS: Final = ('ros2msg', 'ros2idl')
# Errors of the deserialiser on damaged or hostile bytes.
MISFIT = (
    SerdeError,
    IndexError,
    ValueError,
    TypeError,
    AssertionError,
    OverflowError,
    MemoryError,
    KeyError,
    RecursionError,
    struct.error,
)


def explain_undecodable(schema: Schema | None, message_encoding: str) -> str | None:
    """Return why messages cannot be decoded, as a clause; None if they can."""
    if message_encoding != 'cdr':
        return f"are encoded as '{message_encoding}', not as CDR"
    if schema is None or not schema.encoding:
        return 'have a message type that the bag does not define'
    if schema.encoding not in READABLE_ENCODINGS:
        return f"are of type '{schema.name}', defined in '{schema.encoding}', not as a ROS message"
    if not schema.data.strip() and not schema.name.endswith('/Empty'):
        return f"are of type '{schema.name}', which the bag does not define"
    return None


@final
class MessageDecoder:
    """Decodes CDR messages to objects; `schemas` are the bag's definitions by type name."""

    def __init__(self, schemas: Mapping[str, Schema]) -> None:
        self._schemas = schemas
        self._types = get_typestore(Stores.EMPTY)

    def decode(self, type_name: str, data: bytes) -> object:
        """
        Return a message as an object with ROS's attribute names; arrays are numpy arrays.

        Raise `BadInput` if the bag's definition or the message is invalid.
        """
        if type_name not in self._types.fielddefs:
            self._register_type(type_name)
        try:
            return self._types.deserialize_cdr(data, type_name)
        except MISFIT as error:
            raise BadInput(
                f"A message does not match the definition of its type '{type_name}' in the bag "
                f'({error}); leave its topic out or record it again.'
            ) from error

    def encode_again(self, type_name: str, data: bytes) -> bytes:
        """
        Return a message with zeros as padding, so that equal values have equal bytes.

        Middleware leaves old memory there. Data that cannot be decoded are returned unchanged.
        """
        try:
            return bytes(self._types.serialize_cdr(self.decode(type_name, data), type_name))
        except (BadInput, *MISFIT):
            return data

    def list_fields(self, type_name: str) -> list[tuple[str, Any]]:
        """Return attribute and rosbags description of the fields of a type; errors as `decode`."""
        if type_name not in self._types.fielddefs:
            self._register_type(type_name)
        attributes = fields(self._types.types[type_name])  # type: ignore[arg-type]
        described = self._types.fielddefs[type_name][1]
        # The object's constants follow its fields, so zip cuts them off.
        return [(at.name, item) for at, (_, item) in zip(attributes, described, strict=False)]

    def _register_type(self, type_name: str) -> None:
        """Register a type and its nested types from the bag."""
        schema = self._schemas.get(type_name)
        reason = explain_undecodable(schema, 'cdr')
        if schema is None or reason is not None:
            raise BadInput(f'The messages {reason}; leave their topic out.')
        text = schema.data.decode(errors='replace')
        try:
            self._types.register(parse_definition(text, type_name, schema.encoding))
        except MISDEFINED as error:
            raise BadInput(
                f"The definition of the message type '{type_name}' in the bag (format "
                f'{schema.encoding or "unknown"}) is invalid, so its messages cannot be decoded; '
                'leave topics of this type out.'
            ) from error
