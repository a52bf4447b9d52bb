"""Prepare the flights of a calibration, and fit their readings from wide assumptions."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
import math
from typing import Final, final

from lta_config.errors import BadInput
from lta_discovery.flights.measured_flight import MeasuredFlight
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
from lta_discovery.state_filter.forecast_sums import choose_horizons
from lta_discovery.state_filter.linear_flight import FlightSystem
from lta_discovery.state_filter.noise_model import NoiseModel
from lta_discovery.state_filter.parameter_fit import (
    fit_likelihood,
    ParameterFit,
    ROUNDS,
)
from lta_model.effects.protocol import AXES
from lta_model.vehicle import Vehicle
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

MARKER_HEADING: Final = 'marker_offset.yaw'
DELAY: Final = 'command_delay.delay'
FIRST_DELAY: Final = 0.1  # s; a fit from no delay at all sees no slope of it
QUICK: Final = 3  # linearizations of a first look
FEW: Final = 2  # flights of a look at other headings
CLEARLY: Final = 20.0  # nats; by which another heading than the file's has to be more probable
AGAIN: Final = (3,)  # rounds before which a fit with wider assumptions learns the noise
FAR: Final = 2.0  # tolerances; the assumption must not hold back what is further off
ANY_HEADING: Final = 1.6  # standard deviation of the heading of such a marker frame [rad]
HEADINGS: Final = (0.0, 0.5 * math.pi, math.pi, -0.5 * math.pi)  # where it is looked for [rad]
# Of the period of a pendulum, by the beginnings of the names
PENDULUM: Final = ('vehicle.roll', 'vehicle.pitch', 'vehicle.yaw', 'cg_height', 'cg_offset')
WIDER: Final = 2.0  # times the tolerance of all of these, if one is further off


@final
@dataclass(frozen=True, slots=True)
class PreparedCalibration:
    """What a calibration works on."""

    vehicle: Vehicle
    nominal: NominalVehicle
    parameters: list[FreeParameter]  # the calibrated numbers
    # Role 'train' or 'confirm'
    flights: Mapping[str, list[MeasuredFlight]]
    names: Mapping[str, list[str]]
    systems: list[FlightSystem]  # of the training flights

    @property
    def horizons(self) -> tuple[float, ...]:
        """How far ahead the training flights are forecast. [s]"""
        return choose_horizons(self.systems)

    def widen(self, tolerances: Mapping[str, float]) -> 'PreparedCalibration':
        """Return the calibration with other tolerances of parameters, by name."""
        parameters = [
            replace(one, tolerance=tolerances.get(one.name, one.tolerance))
            for one in self.parameters
        ]
        return replace(
            self,
            parameters=parameters,
            systems=[one.with_parameters(parameters) for one in self.systems],
        )


def prepare_calibration(vehicle: Vehicle, flights: Sequence[Role]) -> PreparedCalibration:
    """Return the flights of a calibration with what can be calibrated with them."""
    measured_flights = [flight for _, _, flight in flights]
    wrenches = [one.wrench.values for one in measured_flights if one.wrench is not None]
    commanded = np.any([commanded_axes(each) for each in wrenches] or [[False]], axis=0)
    orders = np.concatenate([np.zeros((0, len(AXES))), *wrenches])
    nominal = set_references(NominalVehicle.from_vehicle(vehicle), orders)
    parameters = list_calibration_parameters(
        nominal,
        commanded.tolist(),
        all(one.has_only_pose for one in measured_flights),
        list_reversed_rotors(
            [one.commands.values for one in measured_flights if one.wrench is None],
            vehicle.reversible,
        ),
        list_wrench_laws(orders),
    )
    roles: dict[str, list[MeasuredFlight]] = {'train': [], 'confirm': []}
    names: dict[str, list[str]] = {'train': [], 'confirm': []}
    for title, role, flight in flights:
        side = role if role in roles else 'confirm'
        roles[side].append(flight)
        names[side].append(title)
    systems = [FlightSystem(vehicle, one, parameters) for one in roles['train']]
    return PreparedCalibration(vehicle, nominal, parameters, roles, names, systems)


def fit_quickly(prepared: PreparedCalibration) -> ParameterFit:
    """Return a first look at the parameters, under the usual noise."""
    return fit_likelihood(*_begin(prepared), QUICK, ())


def _begin(
    prepared: PreparedCalibration,
) -> tuple[list[FlightSystem], NominalVehicle, Array, list[NoiseModel]]:
    """Return where a fit begins."""
    noise = [NoiseModel.guess(prepared.nominal, one.flight) for one in prepared.systems]
    begin = np.array([FIRST_DELAY if one.name == DELAY else 0.0 for one in prepared.parameters])
    return prepared.systems, prepared.nominal, begin, noise


def fit_calibration(
    prepared: PreparedCalibration,
) -> tuple[PreparedCalibration, ParameterFit]:
    """
    Return a fit to all readings of the training flights, and the assumptions under which.

    Where the marker frame is turned far, it was defined without regard to the nose, and may have
    any heading. Where the pendulum is far off, the file is that of another vehicle.
    """
    systems, nominal, begin, noise = _begin(prepared)
    heading = find_index(prepared.parameters, MARKER_HEADING)
    begin[heading] = _choose_heading(prepared)
    fit = fit_likelihood(systems, nominal, begin, noise)
    usual = {one.name: one.tolerance for one in prepared.parameters}
    off = dict(zip(usual, np.abs(fit.values), strict=True))
    wider = {}
    if off[MARKER_HEADING] > FAR * usual[MARKER_HEADING]:
        wider[MARKER_HEADING] = ANY_HEADING
    pendulum = [name for name in usual if name.startswith(PENDULUM)]
    if any(off[name] > FAR * usual[name] for name in pendulum):
        wider |= {name: WIDER * usual[name] for name in pendulum}
    if not wider:
        return prepared, fit
    prepared = prepared.widen({name: float(size) for name, size in wider.items()})
    return prepared, fit_likelihood(
        prepared.systems, prepared.nominal, fit.values, fit.noise, ROUNDS, AGAIN
    )


def _choose_heading(prepared: PreparedCalibration) -> float:
    """Return the heading of the marker frame from which a first look is best. [rad]"""
    systems, nominal, usual, noise = _begin(prepared.widen({MARKER_HEADING: ANY_HEADING}))
    heading = find_index(prepared.parameters, MARKER_HEADING)
    best, most = 0.0, -np.inf
    for angle in HEADINGS:
        begin = usual.copy()
        begin[heading] += angle
        try:
            look = fit_likelihood(systems[:FEW], nominal, begin, noise[:FEW], QUICK, ())
        except BadInput:
            continue
        if look.evidence > most + CLEARLY:
            best, most = angle, look.evidence
    return best


def find_index(parameters: Sequence[FreeParameter], name: str) -> int:
    """Return the index of the parameter with a name."""
    return next(k for k, one in enumerate(parameters) if one.name == name)
