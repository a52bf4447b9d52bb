"""The mission file: vehicle, route of beacons, light, payload and reserve of a patrol."""

from typing import Annotated, Literal, Self

from lta_config.files import find_file, load_file, StrictModel
from lta_config.quantity import Quantity, si_quantity
from lta_config.schema.light_day_file import DAY, Share
from pydantic import AliasChoices, Field, model_validator

Power = Annotated[Quantity, si_quantity('W', low=0.0, high=100.0, sourced=True)]
Time = Annotated[Quantity, si_quantity('s', low=0.0, high=DAY, sourced=True)]
Beacon = Annotated[str, Field(pattern=r'^[a-z][a-z0-9_]*$')]


class InspectionPayload(StrictModel):
    """An inspection sensor below the hull, switched on while the drone dwells at a beacon."""

    mass: Annotated[Quantity, si_quantity('kg', low=0.0, high=1.0, sourced=True)]
    sensing: Power
    radio: Power


class DutyCycle(StrictModel):
    """The naive schedule: rest for a multiple of the duration of the last flight."""

    rest: Annotated[float, Field(gt=0.0, le=1000.0)]
    source: str


class MissionFile(StrictModel):
    """A mission file."""

    schema_version: Annotated[Literal[1], Field(validation_alias=AliasChoices('schema'))]
    name: Annotated[str, Field(pattern=r'^[a-z][a-z0-9_]*$')]
    about: str
    vehicle: str
    scene: str
    light: str
    altitude: Annotated[Quantity, si_quantity('m', above=0.0, high=100.0)]
    perch: Beacon
    round: Annotated[tuple[Beacon, ...], Field(strict=False, min_length=1, max_length=50)]
    dwell: Annotated[Quantity, si_quantity('s', low=0.0, high=3600.0)]
    payload: InspectionPayload | None = None
    # Of the photodiodes' amplifiers, mounted for the light of the place; else the vehicle's own
    feedback: Annotated[Quantity, si_quantity('ohm', above=0.0, sourced=True)] | None = None
    # Start and end of the working hours, as time of day
    work: Annotated[Quantity, si_quantity('s', low=0.0, high=DAY, length=2, sourced=True)]
    asleep: Power
    reserve: Share  # state of charge to keep for the way back
    dock: Annotated[Quantity, si_quantity('m', above=0.0, high=10.0, sourced=True)]
    fetched: Time  # after which people bring a stranded drone back
    charge: Share  # state of charge at the start, at midnight
    duty: DutyCycle

    @model_validator(mode='after')
    def _check_round(self) -> Self:
        # The drone returns to the perch after every round anyway
        if self.perch in self.round:
            raise ValueError(
                f'has the perch {self.perch} in its "round"; remove it, because every round ends '
                'at the perch anyway'
            )
        return self


def load_mission(name: str) -> MissionFile:
    """Return a mission file by shipped name or path; raise `BadInput` if it is invalid."""
    return load_file(MissionFile, find_file('mission', name))
