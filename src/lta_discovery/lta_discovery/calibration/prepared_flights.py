"""Prepare the flights of a calibration, and fit their forecasts from wide assumptions."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final, final

from lta_discovery.calibration.coarse_fit import CoarseCalibration, fit_coarse_calibration
from lta_discovery.flights.role_assignment import Role
from lta_discovery.model.calibration_parameters import (
    commanded_axes,
    list_calibration_parameters,
    list_reversed_rotors,
    list_wrench_laws,
    set_references,
)
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.study import prepare_flight
from lta_model.effects.protocol import AXES
from lta_model.vehicle import Vehicle
import numpy as np

Progress = Callable[[str, float | None], None]

MARKER_HEADING: Final = 'marker_offset.yaw'
TURNED: Final = 2.0  # tolerances; a marker frame further off may have any heading
ANY_HEADING: Final = 1.6  # standard deviation of such a heading [rad]


@final
@dataclass(frozen=True, slots=True)
class PreparedCalibration:
    """What a calibration works on."""

    nominal: NominalVehicle
    knobs: list[FreeParameter]  # the calibrated numbers
    # Role 'train' or 'confirm'
    flights: Mapping[str, list[FlightLinearizer]]
    names: Mapping[str, list[str]]


def prepare_calibration(
    vehicle: Vehicle, flights: Sequence[Role], any_heading: bool = False
) -> PreparedCalibration:
    """
    Return the flights of a calibration with what can be calibrated with them.

    `any_heading`: whether the marker frame may have any heading on the vehicle.
    """
    measured_flights = [flight for _, _, flight in flights]
    wrenches = [one.wrench.values for one in measured_flights if one.wrench is not None]
    commanded = np.any([commanded_axes(each) for each in wrenches] or [[False]], axis=0)
    orders = np.concatenate([np.zeros((0, len(AXES))), *wrenches])
    nominal = set_references(NominalVehicle.from_vehicle(vehicle), orders)
    knobs = list_calibration_parameters(
        nominal,
        commanded.tolist(),
        all(one.has_only_pose for one in measured_flights),
        list_reversed_rotors(
            [one.commands.values for one in measured_flights if one.wrench is None],
            vehicle.reversible,
        ),
        list_wrench_laws(orders),
    )
    if any_heading:
        heading = find_index(knobs, MARKER_HEADING)
        knobs[heading] = replace(knobs[heading], tolerance=ANY_HEADING)
    roles: dict[str, list[FlightLinearizer]] = {'train': [], 'confirm': []}
    names: dict[str, list[str]] = {'train': [], 'confirm': []}
    for title, role, flight in flights:
        side = role if role in roles else 'confirm'
        roles[side].append(prepare_flight(vehicle, flight, knobs))
        names[side].append(title)
    return PreparedCalibration(nominal, knobs, roles, names)


def fit_coarsely(
    vehicle: Vehicle, flights: Sequence[Role], tell: Progress
) -> tuple[PreparedCalibration, CoarseCalibration]:
    """Return the prepared flights, and a fit to their forecasts."""
    tell('preparing', 0.0)
    prepared = prepare_calibration(vehicle, flights)
    tell('fitting forecasts', 0.1)
    coarse = fit_coarse_calibration(prepared.nominal, prepared.flights['train'])
    heading = find_index(prepared.knobs, MARKER_HEADING)
    if abs(coarse.values[heading]) <= TURNED * prepared.knobs[heading].tolerance:
        return prepared, coarse
    # The frame was defined without regard to the nose: the assumption must not hold it back
    prepared = prepare_calibration(vehicle, flights, any_heading=True)
    return prepared, fit_coarse_calibration(prepared.nominal, prepared.flights['train'])


def find_index(knobs: Sequence[FreeParameter], name: str) -> int:
    """Return the index of the parameter with a name."""
    return next(k for k, knob in enumerate(knobs) if knob.name == name)
