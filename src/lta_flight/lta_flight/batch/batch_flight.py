# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Represent one flight of a batch as numbers: the constants of its model and loop."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
import math
from pathlib import Path
from typing import Any, cast, final, NamedTuple

from lta_config.compilation.flat import settings_to_tuples
from lta_config.errors import BadInput
from lta_config.topics import TopicTable
from lta_control.allocation import pad_to_slots, PerRotor
from lta_control.autopilot import build_drone_constants
from lta_control.flight_step import DroneConstants
from lta_control.laws import CASCADE, LAWS
from lta_control.laws.cascade import CascadeGains
from lta_control.mission import MissionSettings, ReserveRule
from lta_control.strategies.protocol import NavigationStrategy
from lta_flight.batch.targets import BatchSchedule, SENSOR_STEP
from lta_flight.flight_stack import FlightStack
from lta_model.effects import EFFECTS
from lta_model.effects.protocol import MeasurementEffect
from lta_model.electrical.loads import navigation_power
from lta_model.light.readings import build_panel_plane, PanelPlane
from lta_model.light.view import find_spectral_weights, LightWeights
from lta_model.mass_properties import half_axes
from lta_model.model import VehicleModel
from lta_model.scenario import Scenario
from lta_model.sensors.imu import error_bounds, ImuSettings
from lta_model.sensors.pressure import PressureSettings
from lta_model.sensors.range import RangeSettings
from lta_model.vehicle import Vehicle
from lta_sim.compiled_sensors import ImuAxes, SensorDatasheets, Six
from lta_sim.environment import build_steady_wind, SteadyWind
from lta_sim.light_link import build_light_link, LightLink
from lta_sim.scene_model import build_scene_model, vehicle_reach
from lta_sim.supply import SupplyComponents, SupplyConstants
from lta_sim.termination import build_goal, EndConditions, GoalProgress
from lta_sim.wind_record import WindRecord
from lta_vlc.diodes import build_diode_array
from lta_vlc.lamp import build_direction_prior, build_fit_inputs
from lta_vlc.reading_model import DiodeFitInputs, DirectionPrior
import numpy as np
from numpy.typing import NDArray

Vector = tuple[float, float, float]


class BatchPower(NamedTuple):
    """The electrical system: supply, loads and panel."""

    supply: SupplyConstants
    panel: PanelPlane
    lamp_shares: tuple[float, ...]  # W/m2 per lux of each lamp's on phase
    ambient: float  # W/m2
    day_share: float  # W/m2 per lux of daylight
    panel_weights: LightWeights  # what the cells make of these lights
    reserve: float
    charge: float


class FlightConstants(NamedTuple):
    """Everything that determines a flight except its seed and the model's own numbers."""

    drone: DroneConstants  # the drone's knowledge of itself
    mission: MissionSettings  # altitudes and speeds
    # The world: sensors, light link, end conditions and power
    sensors: SensorDatasheets
    listening: LightLink
    array: DiodeFitInputs  # the drone's model of its diodes
    expected: DirectionPrior  # its prior on the lamp
    goal: EndConditions
    power: BatchPower
    place: Vector  # hull centre at the start [m, map]
    heading: float  # middle of the headings at the start [rad]
    spread: float  # their half width [rad]
    wind: SteadyWind
    held: float  # time for which a hand holds the drone [s]
    lowest: PerRotor  # minimum duty of each rotor
    # Index of the lamp of each stop, in order; only the first lamp without a route
    route: tuple[int, ...]
    mass_place: Vector  # position of the moving mass [m, body]
    reserve: ReserveRule  # action at the energy reserve
    # Gain of the photodiodes' resistor relative to one of 100 kohm [1]
    diode_scale: float


class FlightTally(NamedTuple):
    """Running results of a flight in SI units; NaN for events that have not happened."""

    outcome: int
    progress: GoalProgress
    lift_off: float
    search_start: float
    path_length: float
    closest: float
    energy: float
    blocks: float  # light blocks since the search began
    bearings: float  # number of them with a bearing
    squares: float  # sum of squared bearing errors [rad2]


Array = NDArray[np.float64]
UNHEARD = ('pose', 'pose_time', 'clock')  # channels that do not influence a flight


@final
@dataclass(frozen=True, slots=True)
class BatchFlight:
    """One flight of a batch."""

    model: VehicleModel
    numbers: list[float]  # its `FlightConstants` as a flat list
    form: str  # the nesting and types of the numbers; flights with equal forms share compiled code
    craft: FlightConstants
    name: str  # name of the vehicle
    strategy: NavigationStrategy  # how it navigates; flights of one strategy share a text
    # Recorded wind [m/s] and its rate [m/s2] in each control period; none without a record, shape
    # (n, 6)
    recorded: Array = field(default_factory=lambda: np.empty((0, 6)), compare=False)


def build_schedule(table: TopicTable) -> BatchSchedule:
    """Return the schedule; raise `BadInput` if a period is not a multiple of the step."""
    step_ns = round(SENSOR_STEP * 1e9)
    control = table.control_ns
    due = {name: table[name].period_ns for name in ('range', 'pressure', 'photodiodes')}
    # A light block needs an even number of control steps, since its middle must be one
    if control % step_ns or due['range'] % step_ns or due['photodiodes'] % (2 * control):
        raise BadInput(
            f'--device uses steps of {1e3 * SENSOR_STEP:g} ms, so the periods of control '
            f'and range must '
            'be whole multiples of that, and the period of the photodiodes an even multiple of '
            f'that of control; topics.yaml has {control} ns for control, {due["range"]} ns for '
            f'range and {due["photodiodes"]} ns for the photodiodes. Change them there.'
        )
    return BatchSchedule(
        control // step_ns,
        due['range'] // step_ns,
        due['pressure'] // control,
        due['photodiodes'] // control,
    )


def build_model(vehicle: Vehicle, scenario: Scenario, policy: FlightStack) -> VehicleModel:
    """
    Return the model of a vehicle in a scene, for a batch.

    Raise `BadInput` if it needs something that a batch does not support.
    """
    if policy.law is not LAWS[CASCADE]:
        raise BadInput(
            f'--device supports only the control law {CASCADE}, but {vehicle.file.name} uses '
            f'{policy.law.name}; leave --device out.'
        )
    if policy.course is not None or scenario.course is not None:
        raise BadInput(
            '--device supports flying to a lamp, but not along a course; leave --device out.'
        )
    model = build_scene_model(vehicle, scenario)
    for name in model.effect_parameters:
        effect = EFFECTS[name]
        # Effects of sensors and commands act outside the model, where a batch has no code for them
        if isinstance(effect, MeasurementEffect) and effect.channel not in UNHEARD:
            raise BadInput(
                f'--device does not support the effect {name}, which acts on measurements or '
                'commands; leave --device out.'
            )
    # The explicit integrator would diverge for a vehicle that is too stiff
    vehicle.check_step(SENSOR_STEP, model)
    return model


def build_flight(
    vehicle: Vehicle, scenario: Scenario, policy: FlightStack, table: TopicTable
) -> BatchFlight:
    """
    Return a flight of a batch.

    `vehicle`, `scenario`, `policy`: the vehicle, its scene, and the settings of the drone.
    `table`: periods and block shape.
    """
    model = build_model(vehicle, scenario, policy)
    craft = build_constants(vehicle, scenario, policy, table)
    place = model.effect_parameters.get('moving_mass', {})
    craft = craft._replace(
        mass_place=(place.get('x', 0.0), place.get('y', 0.0), place.get('z', 0.0))
    )
    flight = flight_from_constants(model, craft, vehicle, policy.strategy)
    path = scenario.wind_file
    if path is None:
        return flight
    changed_ns = path.stat().st_mtime_ns
    recorded = tabulate_wind(path, changed_ns, scenario.goal.time_limit.si, table.control_ns)
    return replace(flight, recorded=recorded)


@lru_cache(maxsize=8)
def tabulate_wind(path: Path, changed_ns: int, limit: float, control_ns: int) -> Array:
    """
    Return recorded wind and its rate in each control period, shape (n, 6) [m/s, m/s2].

    Flights of one scene share the array until the file changes. `limit` is the time limit [s].
    """
    del changed_ns  # part of the key of the cache only
    period = control_ns * 1e-9
    count = math.ceil(limit / period) + 1
    begin = np.arange(count, dtype=np.float64) * control_ns * 1e-9
    wind, rate = WindRecord.read(path, limit).average_wind_over_span(begin, begin + period)
    return np.vstack([wind, rate]).T.copy()


def flight_from_constants(
    model: VehicleModel,
    constants: FlightConstants,
    vehicle: Vehicle,
    strategy: NavigationStrategy,
) -> BatchFlight:
    """Return a flight with given constants."""
    numbers: list[float] = []
    form: list[str] = []
    flatten_numbers(settings_to_tuples(constants), numbers, form)
    return BatchFlight(model, numbers, ''.join(form), constants, vehicle.file.name, strategy)


def build_constants(
    vehicle: Vehicle, scenario: Scenario, policy: FlightStack, table: TopicTable
) -> FlightConstants:
    """Return the constants of a flight; the drone assumes its file in standard air."""
    start, light = scenario.start, table.light
    x, y = start.position.vector
    drone = build_drone_constants(
        Vehicle(vehicle.file),
        policy.estimator,
        cast('CascadeGains', policy.gains),  # checked by `build_model`
        table.control_ns * 1e-9,
        policy.tilt_limit,
    )
    rate, samples = light.sample_rate.si, light.samples
    return FlightConstants(
        drone=drone,
        mission=policy.mission,
        sensors=build_sensors(vehicle, scenario.air.pressure.si),
        listening=build_light_link(
            scenario.light_field,
            vehicle.diodes,
            half_axes(vehicle.file.hull),
            policy.demodulation,
            rate,
            samples,
        ),
        array=build_fit_inputs(build_diode_array(vehicle.file.sensors.diodes)),
        expected=build_direction_prior(policy.prior),
        goal=build_goal(scenario, policy.strategy.name),
        power=build_power(vehicle, scenario, policy),
        place=(x, y, vehicle.hull_height_on_floor),
        heading=start.heading.si,
        spread=start.heading_spread.si,
        wind=build_steady_wind(scenario, vehicle_reach(vehicle)[0]),
        held=start.held.si,
        lowest=pad_to_slots(-1.0 if reverses else 0.0 for reverses in vehicle.reversible),
        route=index_route(scenario),
        mass_place=(0.0, 0.0, 0.0),
        reserve=policy.reserve.rule,
        diode_scale=vehicle.diodes.gain_scale,
    )


def index_route(scenario: Scenario) -> tuple[int, ...]:
    """Return the index of the lamp of each stop of the route; the first lamp without a route."""
    names = list(scenario.lamps)
    return tuple(names.index(name) for name in scenario.route) or (0,)


def flatten_numbers(value: Any, numbers: list[float], form: list[str]) -> None:
    """Append the numbers of nested tuples to `numbers`, and their structure to `form`."""
    if isinstance(value, tuple):
        form.append('(')
        for item in value:
            flatten_numbers(item, numbers, form)
        form.append(')')
        return
    numbers.append(float(value))
    # b, i or f: compiled code depends on the types
    form.append('b' if isinstance(value, bool) else 'i' if isinstance(value, int) else 'f')


def build_sensors(vehicle: Vehicle, floor: float) -> SensorDatasheets:
    """Return the sensors of a vehicle above a floor with some pressure [Pa]."""
    bounds, ranger, barometer = error_bounds(ImuSettings()), RangeSettings(), PressureSettings()
    sensors = vehicle.file.sensors
    axes = ImuAxes(
        gain=to_six_floats(bounds.gain),
        offset=to_six_floats(bounds.offset),
        noise=to_six_floats(bounds.noise),
        step=to_six_floats(bounds.step),
        full_scale=to_six_floats(bounds.full_scale),
    )
    return SensorDatasheets(
        imu=axes,
        imu_place=to_three_floats(sensors.imu_position.vector),
        range_place=to_three_floats(sensors.range_position.vector),
        nearest=ranger.minimum,
        farthest=ranger.maximum,
        range_noise=ranger.noise,
        range_offset=ranger.offset,
        floor=floor,
        pressure_noise=barometer.noise,
        pressure_offset=barometer.offset,
        drift=barometer.drift,
        resolution=barometer.resolution,
    )


def build_power(vehicle: Vehicle, scenario: Scenario, policy: FlightStack) -> BatchPower:
    """Return the electrical system of a vehicle in a scene."""
    field = scenario.light_field
    ambient = field.ambient
    daylight = field.any_daylight
    return BatchPower(
        SupplyConstants(
            SupplyComponents(vehicle.battery, vehicle.charger, vehicle.panel),
            vehicle.loads,
            navigation_power(vehicle.file.energy, policy.strategy.name),
            scenario.faults.times,
        ),
        build_panel_plane(
            half_axes(vehicle.file.hull), vehicle.file.panel_place, vehicle.file.panel_normal
        ),
        # Mean irradiance per lux of the on phase
        tuple(lamp.wave.duty / lamp.efficacy for lamp in field.lamps),
        ambient.steady / ambient.efficacy,
        0.0 if daylight is None else 1.0 / daylight.efficacy,
        find_spectral_weights(field, vehicle),
        policy.energy.reserve,
        scenario.start.charge.si,
    )


def to_six_floats(values: Sequence[float]) -> Six:
    """Return six numbers."""
    a, b, c, d, e, f = map(float, values)
    return a, b, c, d, e, f


def to_three_floats(vector: Sequence[float]) -> tuple[float, float, float]:
    """Return three numbers."""
    x, y, z = map(float, vector)
    return x, y, z
