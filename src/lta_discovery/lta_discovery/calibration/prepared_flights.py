# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Prepare the flights of a calibration, and fit their readings from wide assumptions."""

from collections.abc import Mapping, Sequence
import contextlib
from dataclasses import dataclass, replace
import math
from typing import Final, final

from lta_config.errors import BadInput
from lta_discovery.flights.bags import AssignedFlight
from lta_discovery.flights.measured_flight import MeasuredFlight
from lta_discovery.model.calibration_parameters import (
    commanded_axes,
    list_calibration_parameters,
    list_reversed_rotors,
    list_wrench_laws,
    set_references,
)
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.settings import ANY_HEADING, ASSUMED_TOLERANCE, HEADING_EVIDENCE, WIDER
from lta_discovery.state_filter.forecast_noise import choose_horizons
from lta_discovery.state_filter.likelihood import SIMULATION_RAN_AWAY
from lta_discovery.state_filter.linear_flight import FlightSystem
from lta_discovery.state_filter.noise_model import NoiseModel
from lta_discovery.state_filter.parameter_fit import (
    fit_likelihood,
    ParameterFit,
    smooth_systems,
)
from lta_model.effects.protocol import AXES
from lta_model.vehicle import Vehicle
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

MARKER_HEADING: Final = 'marker_offset.yaw'
DELAY: Final = 'command_delay.delay'
FIRST_DELAY: Final = 0.1  # s; a fit from no delay at all sees no slope of it
LOOK_ROUNDS: Final = 3  # linearizations of a first look
HEADING_FLIGHTS: Final = 2  # flights of a look at other headings
TRIED_HEADINGS: Final = (
    0.0,
    0.5 * math.pi,
    math.pi,
    -0.5 * math.pi,
)  # where it is looked for [rad]
# Of the period of a pendulum, by the beginnings of the names
PENDULUM_KNOBS: Final = ('vehicle.roll', 'vehicle.pitch', 'vehicle.yaw', 'cg_height', 'cg_offset')


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
    begin: Array  # values with which fits begin, relative to the vehicle file, shape (K,)

    @property
    def horizons(self) -> tuple[float, ...]:
        """How far ahead the training flights are forecast [s]."""
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


def prepare_calibration(
    vehicle: Vehicle, flights: Sequence[AssignedFlight]
) -> PreparedCalibration:
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
    begin = np.array([FIRST_DELAY if one.name == DELAY else 0.0 for one in parameters])
    return PreparedCalibration(vehicle, nominal, parameters, roles, names, systems, begin)


def fit_quickly(prepared: PreparedCalibration) -> ParameterFit:
    """Return a first look at the parameters, under the usual noise."""
    return _look(prepared, prepared.begin, len(prepared.systems))


def _look(prepared: PreparedCalibration, begin: Array, count: int) -> ParameterFit:
    """Return a first look at the parameters from some values, with the first flights."""
    systems, nominal = prepared.systems[:count], prepared.nominal
    return fit_likelihood(systems, nominal, begin, _guess_noise(nominal, systems), LOOK_ROUNDS, ())


def _guess_noise(nominal: NominalVehicle, systems: Sequence[FlightSystem]) -> list[NoiseModel]:
    """Return the noise of each flight before any reading."""
    return [NoiseModel.guess(nominal, one.flight) for one in systems]


def fit_calibration(
    prepared: PreparedCalibration,
) -> tuple[PreparedCalibration, ParameterFit]:
    """
    Return a fit to all readings of the training flights, and the assumptions under which.

    Where the marker frame is turned far, it was defined without regard to the nose, and may have
    any heading. Another heading than the file's has to be more probable after a whole fit: turned
    by half a turn, a vehicle whose rotors push backwards is hardly another one. Of two such
    headings, neither of which is the file's, rotors push forwards in the right one.
    """
    assumed, fit = _fit_any_heading(prepared)
    return assumed, _widen(assumed, fit)


def _widen(prepared: PreparedCalibration, fit: ParameterFit) -> ParameterFit:
    """
    Return a fit with its covariance about the smoothed motion.

    Where forces act that the model lacks, the model leaves the measured motion in each period, and
    a fit about it seems to know too much: on flights of a real GT-MAB, the deviation of the
    markers' heading is 2.5 times as large about the smoothed motion. With a right model both are
    alike.
    """
    systems = smooth_systems(prepared.systems, fit)
    try:
        near = fit_likelihood(
            systems, prepared.nominal, fit.values, fit.noise, 0, (), is_near=True
        )
    except BadInput:
        # The smoothed motion may leave what the model can fly
        return fit
    return replace(fit, covariance=near.covariance, own=near.own)


def _fit_any_heading(
    prepared: PreparedCalibration,
) -> tuple[PreparedCalibration, ParameterFit]:
    """Return the fit from the most probable heading."""
    looks = _look_at_headings(prepared)
    own, best = looks[0], max(looks, key=lambda look: look[1].evidence)
    out = _fit_from_look(prepared, *own)
    if best[1].evidence > own[1].evidence + HEADING_EVIDENCE:
        heading = find_index(prepared.parameters, MARKER_HEADING)
        # A look takes too few steps to tell one from the other
        both = [
            one for one in looks[1:] if abs(math.cos(one[0][heading] - best[0][heading])) > 0.5
        ]
        best = max(both, key=lambda one: (_count_forward(prepared, one[1]), one[1].evidence))
        other = _fit_from_look(prepared, *best)
        if other[1].evidence > out[1].evidence + HEADING_EVIDENCE:
            return other
    return out


def _count_forward(prepared: PreparedCalibration, fit: ParameterFit) -> int:
    """Return how many rotors or commanded level forces push the way they are told."""
    count = 0
    for one, value in zip(prepared.parameters, fit.values, strict=True):
        effect, _, part = one.name.partition('.')
        if part == 'thrust':
            count += bool(value > -1.0)
        elif effect == 'wrench_gain' and part in ('surge', 'sway'):
            count += bool(prepared.nominal.parameter_value(effect, part) + value > 0.0)
    return count


def _look_at_headings(prepared: PreparedCalibration) -> list[tuple[Array, ParameterFit]]:
    """
    Look at the parameters from several headings of the marker frame, that of the file first.

    Return where each look begins, and what it finds. Raise `BadInput` if the model diverges from
    all of them.
    """
    heading = find_index(prepared.parameters, MARKER_HEADING)
    wide = prepared.widen({MARKER_HEADING: ANY_HEADING})
    out = []
    for angle in TRIED_HEADINGS:
        begin = prepared.begin.copy()
        begin[heading] += angle
        # A vehicle that is turned the wrong way may diverge
        with contextlib.suppress(BadInput):
            out.append((begin, _look(wide, begin, HEADING_FLIGHTS)))
    if not out:
        raise BadInput(SIMULATION_RAN_AWAY)
    return out


def _fit_from_look(
    prepared: PreparedCalibration, begin: Array, look: ParameterFit
) -> tuple[PreparedCalibration, ParameterFit]:
    """Return a fit to all readings from a look, and the assumptions that the look calls for."""
    usual = {one.name: one.tolerance for one in prepared.parameters}
    off = dict(zip(usual, np.abs(look.values), strict=True))
    wider = {}
    if off[MARKER_HEADING] > ASSUMED_TOLERANCE * usual[MARKER_HEADING]:
        wider[MARKER_HEADING] = ANY_HEADING
    # Where the pendulum is far off, the file is that of another vehicle
    pendulum = [name for name in usual if name.startswith(PENDULUM_KNOBS)]
    if any(off[name] > ASSUMED_TOLERANCE * usual[name] for name in pendulum):
        wider |= {name: WIDER * usual[name] for name in pendulum}
    prepared = replace(prepared.widen(wider), begin=begin)
    systems, nominal = prepared.systems, prepared.nominal
    noise = _guess_noise(nominal, systems)
    return prepared, fit_likelihood(systems, nominal, look.values, noise)


def find_index(parameters: Sequence[FreeParameter], name: str) -> int:
    """Return the index of the parameter with a name."""
    return next(k for k, one in enumerate(parameters) if one.name == name)
