"""A setting of a core or node: declared once, with meaning, unit and bounds."""

from typing import Any

from lta_config.files import Record
from pydantic import Field


class Settings(Record):
    """Base of the settings that become ROS parameters; every field has a default."""


def setting(
    default: Any,  # noqa: ANN401 - of the field's own type
    about: str,
    *,
    unit: str = '',
    low: float | None = None,
    high: float | None = None,
    fixed: bool = False,
) -> Any:  # noqa: ANN401 - pydantic's own idiom for a field
    """
    Return the declaration of one setting.

    Parameters
    ----------
    default : Any
        Value where nothing else is said.
    about : str
        What it means.
    unit : str
        SI unit, shown with the description.
    low, high : float or None
        Closed bounds.
    fixed : bool
        Whether it can be set only at the start.

    """
    return Field(
        default,
        description=about,
        ge=low,
        le=high,
        json_schema_extra={'unit': unit, 'read_only': fixed},
        validate_default=True,
    )
