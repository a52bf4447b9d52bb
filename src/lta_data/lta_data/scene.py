"""Read scenario and vehicle from the provenance of a bag."""

from collections.abc import Mapping
from contextlib import suppress
from functools import lru_cache
from typing import Any, final, NamedTuple, TypeVar

from lta_config.errors import BadInput
from lta_config.files import format_error
from lta_config.schema.vehicle_file import VehicleFile
from lta_data.recorded_choices import read_recorded_file
from lta_model.scenario import Scenario
from pydantic import BaseModel, ValidationError

Model = TypeVar('Model', bound=BaseModel)


@final
class RecordedScene(NamedTuple):
    """Scenario and vehicle stored in a bag; None if missing."""

    scenario: Scenario | None
    vehicle: VehicleFile | None


def read_scene(provenance: Mapping[str, str]) -> RecordedScene:
    """
    Read scenario and vehicle from a bag's provenance.

    Raise `BadInput` if the bag contains a file that cannot be read.
    """
    return RecordedScene(
        parse_provenance_file(Scenario, provenance, 'scenario_file'),
        parse_provenance_file(VehicleFile, provenance, 'vehicle_file'),
    )


def parse_provenance_file(
    model: type[Model], provenance: Mapping[str, str], key: str
) -> Model | None:
    """Parse one file of the provenance, which names no other; None if it is missing."""
    return _parse_model(model, provenance[key], key) if key in provenance else None


@lru_cache(maxsize=32)  # a study reads the same few files often; the models are frozen
def _parse_model(model: type[Model], text: str, key: str) -> Model:
    content = read_recorded_file({key: text}, key)
    _keep_first_resistor(content)
    try:
        return model.model_validate(content)
    except ValidationError as error:
        raise BadInput(
            f"The bag's {key} cannot be read by this version of LTA: {format_error(error)}"
        ) from error


def _keep_first_resistor(content: Any) -> None:  # noqa: ANN401 - a file as plain data
    """Replace the feedback resistors that version 1.0 listed for a scene to choose from."""
    with suppress(KeyError, TypeError, AttributeError):
        feedback = content['sensors']['diodes']['feedback']
        if isinstance(feedback['value'], list):
            feedback['value'] = feedback['value'][0]
