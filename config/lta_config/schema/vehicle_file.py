# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The vehicle file: parts in layers, rotors, an aero block and effects; all numbers with sources.

The models here and in `vehicle_body` are the schema; `lta_model.vehicle` derives the inputs of the
cores from it.
"""

from collections.abc import Mapping
import math
from pathlib import Path
from typing import Annotated, Any, Literal

from lta_config.errors import BadInput
from lta_config.files import find_file, load_yaml, Name, StrictModel, validate_content
from lta_config.quantity import Quantity, si_quantity
from lta_config.schema.vehicle_aero import AeroCoefficients, load_aero_file
from lta_config.schema.vehicle_body import (
    HullBlock,
    Layer,
    MeasuredMassBlock,
    MovingMassBlock,
    PartBlock,
    Place,
    TrimBlock,
)
from lta_config.schema.vehicle_diodes import PhotodiodesBlock
from lta_config.schema.vehicle_energy import EnergyBlock
from pydantic import AliasChoices, Field, field_validator, model_validator

Vector = tuple[float, float, float]
UPWARD_AXIS = (0.0, 0.0, 1.0)
ROTORS = 8  # the model's arrays have this size
# Quantities of a motion that a region of validity limits
REGION_QUANTITIES = ('speed', 'roll', 'pitch', 'roll_rate', 'pitch_rate', 'yaw_rate')


class ControlBlock(StrictModel):
    """The control law of the vehicle, and its gains: a name in `config/control`, or a file."""

    law: Name
    # A path is relative to the vehicle file
    gains: Annotated[str, Field(pattern=r'^([a-z][a-z0-9_]*|.*/.*|.*\.ya?ml)$')] | None = None
    source: str


class ThrustCurve(StrictModel):
    """T = a u^2 + b u for the duty u; `reverse` is the thrust at duty -1, if it differs."""

    a: Annotated[Quantity, si_quantity('N', low=0.0, sourced=True)]
    b: Annotated[Quantity, si_quantity('N', above=0.0, sourced=True)]
    reverse: Annotated[Quantity, si_quantity('N', low=0.0, sourced=True)] | None = None


class RotorTorque(StrictModel):
    """Aerodynamic torque per thrust, and the spin as seen with the thrust towards the observer."""

    per_thrust: Annotated[Quantity, si_quantity('m', low=0.0, high=1.0, sourced=True)]
    spin: Literal['clockwise', 'anticlockwise']


class RotorBlock(StrictModel):
    """One rotor; its thrust is along `axis`, and only a reversible one accepts negative duty."""

    reversible: bool
    position: Place
    axis: Annotated[Quantity, si_quantity('1', low=-1.0, high=1.0, length=3, sourced=True)]
    thrust_curve: ThrustCurve | None = None
    torque: RotorTorque | None = None

    @model_validator(mode='after')
    def _check_axis(self) -> 'RotorBlock':
        length = math.hypot(*self.axis.vector)
        # Tolerates components rounded to two digits
        if not 0.99 <= length <= 1.01:
            raise ValueError(
                f'has an axis of length {length:.3g}, but needs a unit vector; divide it by its '
                'length'
            )
        if self.thrust_curve and self.thrust_curve.reverse and not self.reversible:
            raise ValueError(
                'has thrust_curve.reverse, but is not reversible; remove thrust_curve.reverse, or '
                'set "reversible: true"'
            )
        return self


class SensorPositions(StrictModel):
    """The positions of the sensors."""

    imu_position: Place
    range_position: Place
    panel_position: Place | None = None  # only if the array has no part
    diodes: PhotodiodesBlock


class ValidityBlock(StrictModel):
    """The region of the flights that the numbers were fitted to, as lowest and highest values."""

    speed: Annotated[Quantity, si_quantity('m/s', low=0.0, length=2, sourced=True)]
    roll: Annotated[Quantity, si_quantity('rad', length=2, sourced=True)]
    pitch: Annotated[Quantity, si_quantity('rad', length=2, sourced=True)]
    roll_rate: Annotated[Quantity, si_quantity('rad/s', length=2, sourced=True)]
    pitch_rate: Annotated[Quantity, si_quantity('rad/s', length=2, sourced=True)]
    yaw_rate: Annotated[Quantity, si_quantity('rad/s', length=2, sourced=True)]
    # Duty of each rotor
    commands: Mapping[
        str, Annotated[Quantity, si_quantity('1', low=-1.0, high=1.0, length=2, sourced=True)]
    ] = Field(default_factory=dict)

    @property
    def limits(self) -> dict[str, Quantity]:
        """Return the limits of all quantities, by name."""
        return {**{name: getattr(self, name) for name in REGION_QUANTITIES}, **self.commands}


class VehicleFile(StrictModel):
    """A vehicle file."""

    schema_version: Annotated[Literal[3], Field(validation_alias=AliasChoices('schema'))]
    name: Name
    about: str
    control: ControlBlock | None = None
    hull: HullBlock
    trim: TrimBlock
    measured: MeasuredMassBlock | None = None
    layers: Mapping[str, Layer] = Field(default_factory=dict)
    moving_mass: MovingMassBlock | None = None
    rotors: Annotated[Mapping[str, RotorBlock], Field(max_length=ROTORS)]
    thrust_curve: ThrustCurve | None = None
    aero: AeroCoefficients
    effects: Mapping[str, Mapping[str, Quantity]]
    sensors: SensorPositions
    energy: EnergyBlock
    validity: ValidityBlock | None = None

    @property
    def parts(self) -> dict[str, PartBlock]:
        """All parts by name, layer by layer."""
        return {name: part for layer in self.layers.values() for name, part in layer.items()}

    @property
    def panel_place(self) -> Vector:
        """Where light is harvested and measured, relative to the hull centre. [m]."""
        array, position = self.energy.array, self.sensors.panel_position
        part = array.part if array else None
        place = self.parts[part].position if part else position
        assert place is not None  # ensured by `_check_panel`
        x, y, z = place.vector
        return x, y, z

    @property
    def panel_normal(self) -> Vector:
        """Return the direction that the panel faces, unit length, body frame."""
        if self.energy.array is None:
            return UPWARD_AXIS
        x, y, z = self.energy.array.normal.vector
        length = math.hypot(x, y, z)
        return x / length, y / length, z / length

    @field_validator('aero', mode='before')
    @classmethod
    def _load_named_aero(cls, value: Any) -> Any:
        """Return the aero block of the named aero file, or the value if it is not a name."""
        if not isinstance(value, str):
            return value
        try:
            return load_aero_file(value).aero
        except BadInput as error:
            raise ValueError(f'cannot be used: {str(error).removesuffix(".")}') from None

    @model_validator(mode='after')
    def _check_part_names(self) -> 'VehicleFile':
        seen: dict[str, str] = {}
        for layer, parts in self.layers.items():
            for name in parts:
                if name in seen:
                    raise ValueError(
                        f'has a part {name} in both layers {seen[name]} and {layer}, but part '
                        'names must be unique; rename one'
                    )
                seen[name] = layer
        return self

    @model_validator(mode='after')
    def _check_rotor_columns(self) -> 'VehicleFile':
        # A misspelt rotor in a column would otherwise have no effect
        coupled = self.aero.coupling.rotors if self.aero.coupling else []
        for place, names in (
            ('thrust_allocation', self.aero.thrust_allocation),
            ('coupling', coupled),
        ):
            if strangers := [name for name in names if name not in self.rotors]:
                raise ValueError(
                    f'uses {", ".join(strangers)} in aero.{place}, but has no such rotor; '
                    f'rotors: {", ".join(self.rotors)}'
                )
        if bare := [
            n for n, r in self.rotors.items() if not (r.thrust_curve or self.thrust_curve)
        ]:
            raise ValueError(
                f'has no thrust_curve for the rotors {", ".join(bare)}; add one to each of them, '
                'or one to the file for all rotors'
            )
        return self

    @model_validator(mode='after')
    def _check_trim(self) -> 'VehicleFile':
        trim = self.trim
        if trim.ballast == 'none' and trim.ballast_position:
            raise ValueError('has both "ballast: none" and ballast_position in "trim"; remove one')
        if not self.measured and not self.parts:
            raise ValueError(
                'has neither parts in "layers" nor a mass of the whole vehicle in "measured"; add '
                'one of them'
            )
        if self.measured:
            if trim.ballast_position:
                raise ValueError(
                    'has a mass of the whole vehicle in "measured", which includes the ballast; '
                    'remove trim.ballast_position'
                )
        elif trim.ballast != 'none' and not (trim.heaviness and trim.ballast_position):
            raise ValueError(
                'needs heaviness and ballast_position in "trim"; add both, or "ballast: none" to '
                'use the weight of the parts'
            )
        elif trim.ballast == 'none' and trim.heaviness:
            raise ValueError(
                'has both "ballast: none" and heaviness in "trim", but heaviness needs ballast; '
                'remove one'
            )
        return self

    @model_validator(mode='after')
    def _check_panel(self) -> 'VehicleFile':
        part = self.energy.array.part if self.energy.array else None
        if part is not None and part not in self.parts:
            raise ValueError(
                f'uses {part} in energy.array.part, but has no such part; '
                f'parts: {", ".join(self.parts)}'
            )
        if (part is None) == (self.sensors.panel_position is None):
            raise ValueError(
                'needs exactly one position of its solar panel; give either energy.array.part or '
                'sensors.panel_position'
            )
        return self


def load_vehicle_file(name: str) -> VehicleFile:
    """Return a vehicle file by shipped name or path; raise `BadInput` if it is invalid."""
    path = find_file('vehicle', name)
    return validate_content(VehicleFile, load_vehicle_content(path), str(path))


def load_vehicle_content(path: Path) -> Any:
    """Return the content of a vehicle file; a gains file beside it gets the path to it."""
    content = load_yaml(path)
    control = content.get('control') if isinstance(content, dict) else None
    if not isinstance(control, dict):
        return content
    gains = control.get('gains')
    # A copy in a results folder names gains that are not beside it, but where it was made
    if isinstance(gains, str) and '.' in gains and (path.parent / gains).is_file():
        return {**content, 'control': {**control, 'gains': str(path.parent / gains)}}
    return content
