# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Declare the settings of a core or node: default, description, unit and bounds."""

from collections import namedtuple
from functools import cache
from typing import Any, cast, TypeVar

from lta_config.files import StrictModel
from pydantic import BaseModel, ConfigDict, Field
from pydantic.fields import FieldInfo

Model = TypeVar('Model', bound=BaseModel)


class Settings(StrictModel):
    """Base of settings that become ROS parameters; every field needs a default and a docstring."""

    model_config = ConfigDict(use_attribute_docstrings=True)

    @classmethod
    def __pydantic_init_subclass__(cls, **_: object) -> None:
        """Join the lines of the descriptions."""
        for info in cls.model_fields.values():
            info.description = ' '.join((info.description or '').split())


def setting(
    default: Any,
    unit: str = '',
    low: float | None = None,
    high: float | None = None,
    *,
    fixed: bool = False,
) -> Any:
    """
    Return the declaration of one setting, whose description stands below it as a docstring.

    `unit`: SI unit, shown with the description. `low`, `high`: closed bounds. `fixed`: whether it
    can only be set at start-up.
    """
    return Field(
        default,
        ge=low,
        le=high,
        json_schema_extra={'unit': unit, 'read_only': fixed},
        validate_default=True,
    )


@cache
def _named_tuple_type(model: type[BaseModel]) -> Any:
    # Cached, because compiled code is specialised by type
    return namedtuple(model.__name__, model.model_fields)


def to_named_tuple(settings: Model) -> Model:
    """
    Return settings as nested named tuples of numbers.

    Plain cores accept both, since they only read attributes; compiled ones need named tuples.
    """
    values = (getattr(settings, name) for name in type(settings).model_fields)
    numbers = (
        to_named_tuple(value) if isinstance(value, BaseModel) else value for value in values
    )
    return cast('Model', _named_tuple_type(type(settings))(*numbers))


def format_bounds(info: FieldInfo) -> str:
    """Format the closed bounds of a parameter as text."""
    # Pydantic stores bounds as Ge and Le objects of annotated_types
    constraints = {type(item).__name__: item for item in info.metadata}
    low, high = (
        getattr(constraints.get('Ge'), 'ge', None),
        getattr(constraints.get('Le'), 'le', None),
    )
    if low is not None and high is not None:
        return f'{low:g} to {high:g}'
    if low is not None:
        return f'from {low:g}'
    return f'to {high:g}' if high is not None else ''
