# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Compute the results of a flight as numbers.

The flight starts at lift-off, the search at the first forward setpoint, and the cruise when 90 %
of that speed is first reached; rests at lamps of a route are not part of the cruise. All end when
the hull centre is at the lamp (`lta_sim.termination.is_at_lamp`), or with the recording. On a
route this is the last lamp, after all others. Truth comes from the simulator or a tracking system.
"""

from dataclasses import asdict, dataclass, field, fields
import math
from typing import Any, final, NamedTuple, TYPE_CHECKING, Union

from lta_config.constants import AIR_TEMPERATURE
from lta_data.compare.sampling import wrap_angle
from lta_model.light.view import LightView
from lta_model.state import DISPLACED
from lta_model.vehicle import Vehicle
from lta_report.curves import Array, DirectionCurve, hold_last, interpolate, MotionCurve
from lta_sim.scene_model import build_scene_model
from lta_sim.termination import LIFT_OFF
import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:  # a page of a recording does without the simulator
    from lta_flight.loop_view import LoopView
    from lta_flight.report.view import FlightView

# A recorded or a simulated flight
AnyFlightView = Union['FlightView', 'LoopView']
Flags = NDArray[np.bool_]

CRUISE_SHARE = 0.9  # share of the set speed at which the cruise begins
WARMING_STEP = 0.5  # s, far below the lag of the gas
END_SAMPLES = 5  # blocks whose median is the SNR at the start or the end


def result_field(unit: str, about: str, digits: int | None = None, display: str = '') -> Any:
    """
    Return a field of the results, which is None if the bag does not have the data.

    `digits`: after the point, in the table of the page; None keeps it out. `display`: unit there.
    """
    about_it = {'unit': unit, 'about': about, 'digits': digits, 'display': display or unit}
    return field(default=None, metadata=about_it)


@final
@dataclass(frozen=True, slots=True)
class FlightResults:
    """The results of one flight; None if the data are missing. SI units, angles in rad."""

    success: bool | None = result_field(
        '', 'whether the drone reached each lamp of the route, in radius and height', 0
    )
    lamps: int | None = result_field('1', 'number of lamps that the drone had to reach')
    lamps_reached: int | None = result_field('1', 'number of these lamps that it reached in order')
    lift_off: float | None = result_field('s', 'time of take-off')
    search_start: float | None = result_field('s', 'time of the first forward set-point')
    end: float | None = result_field(
        's', 'time when the goal was reached, or end of the recording'
    )
    flight_time: float | None = result_field('s', 'time from take-off to the goal', 1)
    search_time: float | None = result_field(
        's', 'time from the first forward set-point to the goal', 1
    )
    path_length: float | None = result_field(
        'm', 'length of the true horizontal path to the goal', 2
    )
    straight_length: float | None = result_field(
        'm', 'shortest horizontal path to the goal circle, via the lamps of the route'
    )
    closest_horizontal: float | None = result_field(
        'm', 'smallest horizontal distance to the lamp that was targeted last'
    )
    forward_airspeed: float | None = result_field(
        'm/s', 'mean true forward airspeed in cruise; sideways motion is not in it', 2
    )
    forward_airspeed_spread: float | None = result_field(
        'm/s', 'standard deviation of the true forward airspeed in cruise', 2
    )
    altitude: float | None = result_field(
        'm', 'mean true altitude of the hull centre in cruise', 2
    )
    altitude_error: float | None = result_field(
        'm', 'RMS error of the true altitude to the set-point in cruise', 1, 'cm'
    )
    heading_error: float | None = result_field(
        'rad', 'RMS angle from the nose to the lamp in cruise', 1, '°'
    )
    lamp_error: float | None = result_field(
        'rad', 'RMS error of the direction to the lamp that is used for steering', 1, '°'
    )
    lamp_median: float | None = result_field(
        'rad', 'median of the absolute error of that direction', 1, '°'
    )
    lamp_share: float | None = result_field(
        '1', 'share of the light blocks that gave a direction for steering'
    )
    bearing_error: float | None = result_field(
        'rad', "RMS error of the bearing by the paper's method (topic light/bearing)", 1, '°'
    )
    bearing_median: float | None = result_field(
        'rad', 'median of the absolute error of that bearing', 1, '°'
    )
    bearing_share: float | None = result_field(
        '1', "share of the light blocks that gave a bearing by the paper's method"
    )
    snr_start: float | None = result_field(
        '1', 'SNR of the best photodiode when the search starts'
    )
    snr_end: float | None = result_field('1', 'SNR of the best photodiode at the end')
    altitude_estimate_error: float | None = result_field(
        'm', 'RMS error of the estimated altitude in flight', 1, 'cm'
    )
    airspeed_estimate_error: float | None = result_field(
        'm/s', 'RMS error of the estimated airspeed in flight', 2
    )
    heading_estimate_error: float | None = result_field(
        'rad', 'RMS error of the estimated heading in flight', 1, '°'
    )
    heading_drift: float | None = result_field('rad', 'estimated minus true heading at the end')
    energy: float | None = result_field('J', 'energy from the cell between take-off and goal', 1)
    power: float | None = result_field('W', 'mean power from the cell between take-off and goal')
    cruise_power: float | None = result_field('W', 'mean power from the cell in cruise', 2)
    gas_warmth: float | None = result_field(
        'K', 'temperature of the gas above that of the air at the end, by the light of the scene'
    )
    gas_lift: float | None = result_field(
        'kg', 'lift that the warm gas has gained at the end, as mass', 1, 'g'
    )

    def to_dict(self) -> dict[str, float | bool | None]:
        """Return the results by name, ready for JSON."""
        return asdict(self)

    @classmethod
    def list_units(cls) -> dict[str, str]:
        """Return the unit of each result that has one, by name."""
        return {item.name: item.metadata['unit'] for item in fields(cls) if item.metadata['unit']}


class FlightPhases(NamedTuple):
    """Start times of flight, search and cruise, and their common end; NaN if never [s]."""

    lift_off: float
    search: float
    cruise: float
    end: float


def compute_results(view: 'AnyFlightView') -> FlightResults:
    """Return the results of a flight."""
    phases = find_phases(view)
    metrics: dict[str, float] = {
        'lift_off': phases.lift_off,
        'search_start': phases.search,
        'end': phases.end,
        **compute_goal_metrics(view, phases),
        **compute_cruise_metrics(view, phases),
        **compute_light_metrics(view, phases),
        **compute_estimate_errors(view, phases),
        **compute_energy_metrics(view, phases),
        **compute_gas_metrics(view, phases),
    }
    converted: dict[str, Any] = {
        # Keeps bools and counts as they are
        name: value if isinstance(value, int) else float(value)
        for name, value in metrics.items()
        if np.isfinite(value)
    }
    return FlightResults(**converted)


def find_phases(view: 'AnyFlightView') -> FlightPhases:
    """Return the start and end times of the phases."""
    lift_off = search = np.nan
    end = view.span[1]
    if view.has_topics('ground_truth/odom'):
        truth = view.truth
        lift_off = find_first_time(truth.time, truth.z > truth.z[0] + LIFT_OFF)
        end = view.goal.arrivals[-1] if view.goal.is_reached else end
    if view.has_topics('setpoint/velocity'):
        setpoint = view.speed_setpoint
        search = find_first_time(setpoint.time, setpoint.value > 0.0)
    return FlightPhases(lift_off, search, find_cruise_start(view, search), end)


def find_cruise_start(view: 'AnyFlightView', search: float) -> float:
    """Return when the true forward speed first comes near the setpoint [s]."""
    if not view.has_topics('ground_truth/odom') or not np.isfinite(search):
        return np.nan
    truth = view.truth
    setpoint = hold_last(truth.time, view.speed_setpoint)
    # A setpoint of 0 would be reached by standing still
    fast = (truth.time >= search) & (setpoint > 0.0) & (truth.speed >= CRUISE_SHARE * setpoint)
    return find_first_time(truth.time, fast)


def find_first_time(time: Array, holds: Flags) -> float:
    """Return the first time at which a condition is true; NaN if it never is [s]."""
    # argmax gives the first True, but also 0 if there is none
    return float(time[np.argmax(holds)]) if np.any(holds) else np.nan


def is_in_interval(time: Array, start: float, end: float) -> Flags:
    """Return which times [s] are in a closed interval; none if its start is NaN."""
    return (time >= start) & (time <= end)


def rms(errors: Array) -> float:
    """Return the root mean square of the finite values; NaN if there are none."""
    finite = errors[np.isfinite(errors)]
    return float(np.sqrt(np.mean(finite**2))) if len(finite) else np.nan


def mean_or_nan(values: Array) -> float:
    """Return the mean; NaN of no values."""
    return float(np.mean(values)) if len(values) else np.nan


def compute_goal_metrics(view: 'AnyFlightView', phases: FlightPhases) -> dict[str, float]:
    """Return whether, when and over which path the goal was reached."""
    goal = view.goal
    if goal.truth is None or not goal.places:
        return {}
    truth = goal.truth
    # The lamp that was next at the end; after a success it is the last one
    next_lamp = min(len(goal.arrivals), len(goal.places) - 1)
    away = goal.lamp_distance(truth)[goal.leg_index(truth.time) == next_lamp]
    # The path ends at the goal, even if the recording goes on
    before_end = truth.time <= phases.end
    path = float(np.hypot(np.diff(truth.x[before_end]), np.diff(truth.y[before_end])).sum())
    end = phases.end if goal.is_reached else np.nan
    return {
        'success': goal.is_reached,
        'lamps': len(goal.places),
        'lamps_reached': len(goal.arrivals),
        'flight_time': end - phases.lift_off,
        'search_time': end - phases.search,
        'path_length': path,
        'straight_length': goal.shortest_path_length,
        'closest_horizontal': float(np.nanmin(away)) if np.isfinite(away).any() else np.nan,
    }


def compute_cruise_metrics(view: 'AnyFlightView', phases: FlightPhases) -> dict[str, float]:
    """Return how well speed, altitude and heading were held [m/s, m, rad]."""
    if not view.has_topics('ground_truth/odom'):
        return {}
    truth = view.truth
    cruising = is_cruising(view, phases, truth.time)
    speed, height = truth.speed[cruising], truth.z[cruising]
    metrics = {
        'forward_airspeed': mean_or_nan(speed),
        'forward_airspeed_spread': float(np.std(speed)) if len(speed) else np.nan,
        'altitude': mean_or_nan(height),
        'heading_error': rms(view.goal.lamp_direction(truth)[cruising]),
    }
    if view.has_topics('setpoint/pose'):
        metrics['altitude_error'] = rms(
            height - hold_last(truth.time[cruising], view.altitude_setpoint)
        )
    return metrics


def is_cruising(view: 'AnyFlightView', phases: FlightPhases, time: Array) -> Flags:
    """Return which times [s] are part of the cruise, without rests at lamps of a route."""
    if not view.has_topics('setpoint/velocity'):
        return np.zeros(len(time), dtype=bool)
    return is_in_interval(time, phases.cruise, phases.end) & (
        hold_last(time, view.speed_setpoint) > 0.0
    )


def compute_light_metrics(view: 'AnyFlightView', phases: FlightPhases) -> dict[str, float]:
    """Return the quality of the light measurements during the search."""
    metrics: dict[str, float] = {}
    if view.has_topics('light/estimate'):
        metrics |= compute_direction_error('lamp', view, phases, view.sighting)
    if view.has_topics('light/bearing'):
        metrics |= compute_direction_error('bearing', view, phases, view.bearing)
    if view.has_topics('light/peaks'):
        time, parts = view.peaks
        best = parts['snr'].max(axis=1)[is_in_interval(time, phases.search, phases.end)]
        if len(best):
            metrics['snr_start'] = float(np.median(best[:END_SAMPLES]))
            metrics['snr_end'] = float(np.median(best[-END_SAMPLES:]))
    return metrics


def compute_direction_error(
    name: str, view: 'AnyFlightView', phases: FlightPhases, arrow: DirectionCurve
) -> dict[str, float]:
    """Return RMS and median error of directions to the lamp [rad], and the share with one."""
    time, angle = arrow
    # Before the search the drone stands or climbs and does not steer by the lamp
    searched = is_in_interval(time, phases.search, phases.end)
    metrics = {f'{name}_share': mean_or_nan(np.isfinite(angle[searched]))}
    if not view.has_topics('ground_truth/odom'):
        return metrics
    truth = view.truth
    x, y, yaw = (interpolate(time, truth.time, part) for part in (truth.x, truth.y, truth.yaw))
    there = truth._replace(time=time, x=x, y=y, yaw=yaw)
    error = wrap_angle(angle - beacon_direction(view, there))[searched]
    finite = np.abs(error[np.isfinite(error)])
    middle = float(np.median(finite)) if len(finite) else np.nan
    return metrics | {f'{name}_error': rms(error), f'{name}_median': middle}


def beacon_direction(view: 'AnyFlightView', motion: MotionCurve) -> Array:
    """Return the direction to the lamp that the drone tracks, body frame [rad]."""
    # Older bags have no frequency: use the next lamp
    if not view.has_topics('light/peaks') or 'frequency' not in view.peaks.fields:
        return view.goal.lamp_direction(motion)
    time, parts = view.peaks
    best = parts['snr'].argmax(axis=1)
    # The tracked frequency is that of the diode with the best SNR
    frequency = parts['frequency'][np.arange(len(time)), best]
    newest = np.searchsorted(time, motion.time, side='right') - 1
    return view.goal.beacon_direction(motion, frequency[np.maximum(newest, 0)])


def compute_estimate_errors(view: 'AnyFlightView', phases: FlightPhases) -> dict[str, float]:
    """Return the errors of the estimator in flight [m, rad, m/s]."""
    if not view.has_topics('ground_truth/odom', 'odom'):
        return {}
    estimate, truth = view.estimate, view.truth
    in_flight = is_in_interval(estimate.time, phases.lift_off, phases.end)
    time = estimate.time[in_flight]
    # Both are unwrapped and equal at the start, so no wrapping here
    yaw = estimate.yaw[in_flight] - interpolate(time, truth.time, truth.yaw)
    height = estimate.z[in_flight] - interpolate(time, truth.time, truth.z)
    speed = estimate.speed[in_flight] - interpolate(time, truth.time, truth.speed)
    return {
        'altitude_estimate_error': rms(height),
        'airspeed_estimate_error': rms(speed),
        'heading_estimate_error': rms(yaw),
        'heading_drift': float(yaw[-1]) if len(yaw) else np.nan,
    }


def compute_energy_metrics(view: 'AnyFlightView', phases: FlightPhases) -> dict[str, float]:
    """Return the energy consumption of the flight [J, W]."""
    if not view.has_topics('battery'):
        return {}
    time, voltage, current = view.battery
    # A discharging current is negative
    power = -voltage * current
    inside = time[(time > phases.lift_off) & (time < phases.end)]
    # Include the exact ends, which lie between two messages
    instants = np.array([phases.lift_off, *inside, phases.end])
    # Trapezoidal rule over the samples of the battery
    energy = float(np.trapezoid(interpolate(instants, time, power), instants))
    return {
        'energy': energy,
        'power': energy / (phases.end - phases.lift_off),
        'cruise_power': mean_or_nan(power[is_cruising(view, phases, time)]),
    }


def compute_gas_metrics(view: 'AnyFlightView', phases: FlightPhases) -> dict[str, float]:
    """Return how warm sunlight has made the gas at the end [K], and its lift [kg]."""
    scenario, file = view.scene.scenario, view.scene.vehicle
    if scenario is None or file is None or not view.has_topics('ground_truth/odom'):
        return {}
    vehicle = Vehicle(file, scenario.air.density)
    model = build_scene_model(vehicle, scenario)
    p = model.effect_parameters.get('superheat')
    if p is None:
        return {}
    light, truth = LightView(scenario.light_field, vehicle), view.truth
    time = np.arange(truth.time[0], phases.end, WARMING_STEP)
    places = zip(*(interpolate(time, truth.time, part) for part in truth[1:4]), strict=True)
    warmer = 0.0
    # Exact for light that is steady during a step
    share = 1.0 if p['lag'] <= 0.0 else -math.expm1(-WARMING_STEP / p['lag'])
    for x, y, z in places:
        steady = p['warming'] * light.hull_irradiance((x, y, z, 0.0, 0.0, 0.0, 1.0))
        warmer += share * (steady - warmer)
    gained = p['slack'] * float(model.body[DISPLACED]) * warmer / AIR_TEMPERATURE
    return {'gas_warmth': warmer, 'gas_lift': gained}
