"""Decode messages to objects with the definitions in the bag; ROS is not needed."""

from collections.abc import Mapping
from dataclasses import fields
import struct
from typing import Any, Final, final

from lta_config.errors import BadInput
from lta_data.bag.mcap_file.type_definition import MISDEFINED, parse_definition
from mcap.records import Schema
from rosbags.serde import SerdeError
from rosbags.typesys import get_typestore, Stores

READABLE: Final = ('ros2msg', 'ros2idl')
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
    if schema.encoding not in READABLE:
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
