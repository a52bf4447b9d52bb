"""Prepare the flights of a calibration, and fit their forecasts from wide assumptions."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final, final

from lta_discovery.calibration.coarse_fit import (
    CoarseCalibration,
    fit_coarse_calibration,
    leave_out_shapes,
    settle_calibration,
)
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
FAR: Final = 2.0  # tolerances; the assumption must not hold back what is further off
ANY_HEADING: Final = 1.6  # standard deviation of the heading of such a marker frame [rad]
# Of the period of a pendulum, by the beginnings of the names
PENDULUM: Final = ('vehicle.roll', 'vehicle.pitch', 'vehicle.yaw', 'cg_height', 'cg_offset')
WIDER: Final = 2.0  # times the tolerance of all of these, if one is further off


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
    vehicle: Vehicle, flights: Sequence[Role], tolerances: Mapping[str, float] | None = None
) -> PreparedCalibration:
    """
    Return the flights of a calibration with what can be calibrated with them.

    `tolerances`: of parameters, by name, in place of the usual ones.
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
    for name, tolerance in (tolerances or {}).items():
        k = find_index(knobs, name)
        knobs[k] = replace(knobs[k], tolerance=tolerance)
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
    if abs(coarse.values[heading]) <= FAR * prepared.knobs[heading].tolerance:
        return prepared, coarse
    # The frame was defined without regard to the nose
    prepared = prepare_calibration(vehicle, flights, {MARKER_HEADING: ANY_HEADING})
    return prepared, fit_coarse_calibration(prepared.nominal, prepared.flights['train'])


def fit_further(
    vehicle: Vehicle,
    flights: Sequence[Role],
    prepared: PreparedCalibration,
    coarse: CoarseCalibration,
) -> tuple[PreparedCalibration, CoarseCalibration]:
    """
    Return a better fit to the forecasts of flights that no model explains to their noise.

    It settles, is free to find another pendulum, and has no shapes of forces that one short test
    alone asks for.
    """
    usual = {knob.name: knob.tolerance for knob in prepared.knobs}
    pendulum = [name for name in usual if name.startswith(PENDULUM)]
    off = dict(zip(usual, np.abs(coarse.values), strict=True))
    if any(off[name] > FAR * usual[name] for name in pendulum):
        # The file is an estimate, or that of another vehicle
        wider = usual | {name: WIDER * usual[name] for name in pendulum}
        prepared = prepare_calibration(vehicle, flights, wider)
    nominal, training = prepared.nominal, prepared.flights['train']
    return prepared, leave_out_shapes(
        nominal, training, settle_calibration(nominal, training, coarse)
    )


def find_index(knobs: Sequence[FreeParameter], name: str) -> int:
    """Return the index of the parameter with a name."""
    return next(k for k, knob in enumerate(knobs) if knob.name == name)
