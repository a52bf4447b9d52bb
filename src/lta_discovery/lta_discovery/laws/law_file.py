"""
Write the vehicle file with a law and with the tolerances that were fitted together with it.

A law is fitted beside the tolerances of the vehicle: with those of another fit, it predicts worse.
Therefore the file holds both, and the forecasts that decide on the law are those of this file.
"""

from dataclasses import dataclass
from typing import final

from lta_config.schema.vehicle_file import VehicleFile
from lta_config.schema.vehicle_law import Law
from lta_config.vehicle_edit import set_yaml_values
from lta_discovery.calibration.calibrated_file import (
    CURVE,
    format_changed_vehicle,
    STRIPS,
    VehicleUpdate,
)
from lta_discovery.finding import FittedTolerance
from lta_discovery.fit.bounds import apply_parameters
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.page.formatting import format_parameter
from lta_discovery.results.learned_file import (
    BLOCKS,
    FOLLOWS,
    format_learned_vehicle,
    format_source,
)
from lta_discovery.study import DiscoveryStudy
from lta_model.vehicle import parse_vehicle, Vehicle
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]  # of the shared parameters, shape (G,)


@final
@dataclass(frozen=True, slots=True)
class BaseFile:
    """The vehicle file that a study began with."""

    text: str
    vehicle: Vehicle


@final
@dataclass(frozen=True, slots=True)
class FittedFile:
    """The text of a vehicle file with fitted values, and the vehicle as read from it."""

    text: str
    nominal: NominalVehicle


def write_tolerance_file(base: BaseFile, study: DiscoveryStudy, values: Array) -> FittedFile:
    """
    Return the vehicle file with named effects and tolerances, without a law.

    Parameters
    ----------
    values : ndarray, shape (G,)
        Changes of the shared parameters.

    Raises
    ------
    BadInput
        If the format has no place for a number.

    """
    finding, knobs = study.finding, list_study_parameters(study)
    named = find_named_parameters(study, len(values))
    learned = apply_parameters(study.nominal, knobs, np.where(named, values, 0.0))[0]
    text = format_learned_vehicle(base.text, base.vehicle, study.nominal, learned, finding)
    source = f'fitted together with the law by {format_source(finding)}'
    change = VehicleUpdate(learned, apply_parameters(study.nominal, knobs, values)[0])
    text = format_changed_vehicle(text, base.vehicle, change, {}, source)
    vehicle = parse_vehicle(text, finding.vehicle, base.vehicle.air_density)
    return FittedFile(text, NominalVehicle.from_vehicle(vehicle))


def find_named_parameters(study: DiscoveryStudy, count: int) -> Flags:
    """Return which of the shared parameters are those of named effects, shape (G,)."""
    names = {name for one in study.finding.effects for name in one.knobs}
    out = np.zeros(count, dtype=np.bool_)
    for k, knob in enumerate(list_study_parameters(study)):
        out[k] = knob.name in names
    return out


def find_unwritable_parameters(base: BaseFile, study: DiscoveryStudy) -> Flags:
    """Return which shared parameters the file has no place for, shape (G,): they stay as it is."""
    assert study.forecasts is not None
    out = np.zeros(len(study.forecasts.fitted.mean), dtype=np.bool_)
    for k, knob in enumerate(list_study_parameters(study)):
        out[k] = any(
            not _is_writable(base.vehicle.file, study.nominal, effect) for effect, _ in knob.moves
        )
    return out


def _is_writable(file: VehicleFile, nominal: NominalVehicle, effect: str) -> bool:
    """Return whether a file has a place for the parameters of an effect."""
    if effect == 'vehicle':
        return file.moving_mass is None
    if effect == STRIPS:
        # Drag that is not in the aero block would change with it
        return all(part.drag is None or part.drag.in_aero for part in file.parts.values())
    placed = effect in BLOCKS or effect in FOLLOWS or effect == CURVE
    # Others that the vehicle has, and the file does not set, follow from its blocks
    return placed or effect in file.effects or effect not in nominal.effect_parameters


def add_law_block(text: str, law: Law) -> str:
    """Return the text of a vehicle file with a law."""
    return set_yaml_values(text, {'law': law.model_dump(exclude_defaults=True)})


def list_study_parameters(study: DiscoveryStudy) -> list[FreeParameter]:
    """Return the free parameters of a study."""
    return study.flights[0].flight.knobs


def list_tolerance_changes(study: DiscoveryStudy, values: Array) -> tuple[FittedTolerance, ...]:
    """Return the tolerances that were changed, the one that moved by most deviations first."""
    named = find_named_parameters(study, len(values))
    out = [
        FittedTolerance(
            format_parameter(knob.name), knob.unit, float(value), float(value) / knob.tolerance
        )
        for knob, value, is_named in zip(list_study_parameters(study), values, named, strict=False)
        if knob.tolerance > 0.0 and not is_named and value != 0.0
    ]
    return tuple(sorted(out, key=lambda one: -abs(one.deviations)))
