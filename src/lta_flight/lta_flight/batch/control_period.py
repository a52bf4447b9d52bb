# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Step a simulated flight by one control period.

A period is: sensors, estimator and control; at the end of a light block also the light reading and
the mission; then the motion of the vehicle and its power supply. Plain functions on named tuples,
compiled for batch flights and for the legs of missions. Effects of the model, and tuples with one
item per diode, are generated (`FlightKernel`), because compiled tuples have a fixed length.
"""

from collections.abc import Callable
import math
from typing import NamedTuple

from lta_config.compilation.extract import GeneratedFunction
from lta_control.allocation import NO_ROTORS, PerRotor
from lta_control.flight_step import DroneMemory, flight_step, guidance_altitude, reckon_motion
from lta_control.guidance import permission_at_reserve
from lta_control.laws.protocol import ControlLaw
from lta_control.mission import initial_mission, Mission, mission_step
from lta_control.motion import DeadReckonedMotion, Setpoint
from lta_control.strategies.protocol import NavigationStrategy
from lta_flight.batch.batch_flight import FlightConstants
from lta_flight.batch.flight import (
    build_command,
    has_moved,
    hull_irradiance,
    initial_supply,
    is_lamp_detected,
    panel_irradiance,
    Pose,
    read_sensors,
    sensor_specific_force,
    sight_from_fit,
    State,
    unreachable_pose,
    with_setpoint,
)
from lta_flight.batch.targets import BatchSchedule
from lta_model.electrical.mppt_charger import PowerFlow
from lta_model.state import RIGID
from lta_sim.compiled_sensors import draw_white_noise, SensorErrors, simulate_range_reading
from lta_sim.environment import steady_wind_at
from lta_sim.light_link import add_direct_light, write_reflections
from lta_sim.supply import advance_supply, SupplyInputs, SupplyState
from lta_vlc.direction_fit import fit_direction
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Reading = tuple[float, ...]  # a number per diode


class FlightKernel(NamedTuple):
    """The parts of a flight that depend on its effects and on its number of diodes."""

    dark: Reading  # zero for each diode
    begin: DroneMemory  # initial memory of the drone
    # Whether the model has these effects
    turbulence: bool
    superheat: bool
    # Derivative of the state, and thrust of each rotor, from state, model numbers, command and
    # surroundings
    rates: Callable[[State, Array, State, State], State] = GeneratedFunction('rates')
    thrusts_of: Callable[[State, Array, State, State], PerRotor] = GeneratedFunction('thrusts_of')
    # State after a time at a rate, mean rate of a Runge-Kutta step, and state with a unit
    # quaternion
    ahead: Callable[[State, State, float], State] = GeneratedFunction('ahead')
    mean: Callable[[State, State, State, State], State] = GeneratedFunction('mean')
    normalised: Callable[[State], State] = GeneratedFunction('normalised')
    # State of the rigid body with the initial memory of the effects, from a seed
    add_effects: Callable[[State, int], State] = GeneratedFunction('add_effects')
    # Amplitude, SNR and standard deviation of each diode at the frequency of a lamp
    read_diodes: Callable[..., tuple[Reading, Reading, Reading]] = GeneratedFunction('read_diodes')
    # Daylight on each diode from the light array
    daylight_of: Callable[[Array], Reading] = GeneratedFunction('daylight_of')


class FlightInputs(NamedTuple):
    """What a flight gets from outside."""

    numbers: Array  # parameters of the vehicle's model, its body and its inverse inertia
    # Recorded wind [m/s] and its rate [m/s2] in each control period; none without a record, shape
    # (n, 6)
    recorded: Array
    errors: SensorErrors  # constant sensor errors of this flight
    # Seed of the counter-based noise: each sample is a function of seed, sensor and step
    seed: int
    payload: float  # power of the payload [W]


class WorkArrays(NamedTuple):
    """Working arrays of a thread, whose content matters only within a step, except `echoes`."""

    scratch: Array
    lights: Array  # shape (LAMPS + lamps, diodes)
    echoes: Array  # the same without direct light, from the pose `FlightMemory.gathered`
    pencils: Array


class FlightMemory(NamedTuple):
    """Full state of vehicle and drone between two control periods."""

    state: State  # state of the model
    command: State  # command of the last period, in the form of the kernel
    # Memory of the drone
    onboard: DroneMemory
    mission: Mission
    setpoint: Setpoint  # newest setpoint of the mission
    fresh: bool  # whether the controller has not received this setpoint yet
    middle: Pose  # true pose at the middle of the current light block
    reckoned: DeadReckonedMotion  # the drone's motion estimate at that time
    gathered: Pose  # pose at which reflections were computed last
    daylight: Reading  # daylight on each diode in the newest light block
    seen: bool  # whether the newest light block shows the lamp
    bearing: float  # bearing of the lamp in that block [rad]
    distance: float  # new range, NaN if there is none [m]
    supply: SupplyState  # state of the power supply
    irradiance: float  # irradiance on the panel [W/m2]
    # Control periods and integration steps since the start
    step: int
    ticks: int


def begin_flight(
    strategy: NavigationStrategy,
    onboard: DroneMemory,
    state: State,
    command: State,
    dark: Reading,
    store: PowerFlow,
    distance: float,
) -> FlightMemory:
    """
    Return the memory before the first step, at rest in the dark.

    `command` is that of the resting rotors, `dark` is zero for each diode, `store` the state of
    the power path, and `distance` the first range [m].
    """
    return FlightMemory(
        state=state,
        command=command,
        onboard=onboard,
        mission=initial_mission(strategy),
        setpoint=onboard.setpoint,
        fresh=False,
        middle=pose_of(state),
        reckoned=reckon_motion(onboard),
        gathered=unreachable_pose(),
        daylight=dark,
        seen=False,
        bearing=0.0,
        distance=distance,
        supply=initial_supply(store),
        irradiance=0.0,
        step=0,
        ticks=0,
    )


def simulate_period(
    kernel: FlightKernel,
    schedule: BatchSchedule,
    strategy: NavigationStrategy,
    law: ControlLaw,
    constants: FlightConstants,
    memory: FlightMemory,
    inputs: FlightInputs,
    work: WorkArrays,
) -> FlightMemory:
    """Return the memory of a flight one control period later."""
    surroundings = compute_surroundings(kernel, schedule, constants, memory, inputs)
    memory = sense_and_control(
        kernel, schedule, law, constants, memory, inputs, surroundings, work
    )
    if is_block_end(schedule, memory.step):
        memory = navigate(kernel, schedule, strategy, constants, memory, inputs, work)
    return advance_vehicle(kernel, schedule, constants, memory, inputs, surroundings)


def is_block_end(schedule: BatchSchedule, step: int) -> bool:
    """Return whether a light block ends at the beginning of a control period."""
    return step > 0 and step % schedule.light == 0


def compute_surroundings(
    kernel: FlightKernel,
    schedule: BatchSchedule,
    constants: FlightConstants,
    memory: FlightMemory,
    inputs: FlightInputs,
) -> State:
    """Return the inputs of the model: wind, turbulence noise, heat, voltage and rate of wind."""
    noise, warmth = (0.0, 0.0, 0.0), 0.0
    # Computed only for effects that use it, to save time in every step
    if kernel.turbulence:
        noise = draw_white_noise(inputs.seed, memory.step, schedule.period)
    if kernel.superheat:
        warmth = hull_irradiance(constants, memory.state)
    wind, rate = steady_wind_at(constants.wind, memory.state[0]), (0.0, 0.0, 0.0)
    record, step = inputs.recorded, memory.step
    if step < record.shape[0]:
        wind = (wind[0] + record[step, 0], wind[1] + record[step, 1], wind[2] + record[step, 2])
        rate = (record[step, 3], record[step, 4], record[step, 5])
    return wind + noise + (warmth, memory.supply.flow.voltage) + rate


def sense_and_control(
    kernel: FlightKernel,
    schedule: BatchSchedule,
    law: ControlLaw,
    constants: FlightConstants,
    memory: FlightMemory,
    inputs: FlightInputs,
    surroundings: State,
    work: WorkArrays,
) -> FlightMemory:
    """Return the memory after the sensors, the estimator and the controller."""
    state, step = memory.state, memory.step
    rate = kernel.rates(state, inputs.numbers, memory.command, surroundings)
    held = step * schedule.period < constants.held
    readings = read_sensors(
        constants,
        inputs.errors,
        inputs.seed,
        step,
        step * schedule.period,
        sensor_specific_force(constants, state, rate, held),
        (state[10], state[11], state[12]),
        state,
        memory.distance,
        step % schedule.pressure == 0,
    )
    onboard = memory.onboard
    if memory.fresh:
        onboard = with_setpoint(onboard, memory.setpoint)
    onboard = flight_step(law, constants.drone, onboard, readings, work.scratch)
    middle, reckoned = memory.middle, memory.reckoned
    if step % schedule.light == schedule.block_middle:
        middle, reckoned = pose_of(state), reckon_motion(onboard)
    return memory._replace(
        onboard=onboard, fresh=False, middle=middle, reckoned=reckoned, distance=math.nan
    )


def pose_of(state: State) -> Pose:
    """Return position and quaternion of a state."""
    return (state[0], state[1], state[2], state[3], state[4], state[5], state[6])


def navigate(
    kernel: FlightKernel,
    schedule: BatchSchedule,
    strategy: NavigationStrategy,
    constants: FlightConstants,
    memory: FlightMemory,
    inputs: FlightInputs,
    work: WorkArrays,
) -> FlightMemory:
    """Return the memory after the light block that ends now: light reading and mission."""
    listening, pose = constants.listening, memory.middle
    position, q = (pose[0], pose[1], pose[2]), (pose[3], pose[4], pose[5], pose[6])
    gathered = memory.gathered
    if not schedule.reuse_reflections or has_moved(pose, gathered):
        gathered = pose
        write_reflections(listening, position, q, work.echoes, work.pencils)
    copy_light(work.echoes, work.lights)
    add_direct_light(listening, position, q, work.lights)
    # Stored reflections do not show how daylight sweeps over a turning diode
    daylight = kernel.daylight_of(work.lights)
    before = daylight if schedule.reuse_reflections else memory.daylight
    lamp = constants.route[memory.mission.target]
    amplitudes, snrs, errors = kernel.read_diodes(
        listening, lamp, work.lights, before, inputs.seed, memory.step
    )
    fit = fit_direction(constants.array, constants.expected, amplitudes, errors, work.scratch)
    detected = is_lamp_detected(snrs, listening.threshold)
    sight = sight_from_fit(
        constants, fit, detected, amplitudes, memory.reckoned, schedule.block_time
    )
    setpoint, mission = mission_step(
        constants.mission,
        strategy,
        memory.mission,
        sight,
        guidance_altitude(memory.onboard),
        permission_at_reserve(memory.supply.flow.charge <= constants.power.reserve),
        len(constants.route),
        constants.reserve,
    )
    return memory._replace(
        mission=mission,
        setpoint=setpoint,
        fresh=True,
        gathered=gathered,
        daylight=daylight,
        seen=sight.seen,
        bearing=sight.bearing,
    )


def copy_light(light: Array, out: Array) -> None:
    """Copy an array item by item, because GPU code cannot assign slices."""
    for row in range(light.shape[0]):
        for diode in range(light.shape[1]):
            out[row, diode] = light[row, diode]


def advance_vehicle(
    kernel: FlightKernel,
    schedule: BatchSchedule,
    constants: FlightConstants,
    memory: FlightMemory,
    inputs: FlightInputs,
    surroundings: State,
) -> FlightMemory:
    """Return the memory after the motion of the vehicle and its power supply."""
    duties = memory.onboard.pilot.law.command.duties
    # Without power the motors stop
    if not memory.supply.flow.fed:
        duties = NO_ROTORS
    command = build_command(constants, duties)
    state, ticks, distance = memory.state, memory.ticks, memory.distance
    for _ in range(schedule.control):
        state = runge_kutta_step(kernel, schedule, state, inputs.numbers, command, surroundings)
        ticks += 1
        if ticks % schedule.range == 0:
            distance = simulate_range_reading(
                constants.sensors, inputs.errors, inputs.seed, ticks // schedule.range, state
            )
    if memory.step * schedule.period < constants.held:
        # A hand holds the drone; motors, gas and turbulence go on
        state = memory.state[0:RIGID] + state[RIGID:]
    irradiance = memory.irradiance
    if memory.step % schedule.light == 0:
        irradiance = panel_irradiance(constants, state)
    thrusts = kernel.thrusts_of(state, inputs.numbers, command, surroundings)
    meantime = SupplyInputs(irradiance, thrusts, inputs.payload, memory.step, schedule.period)
    supply = advance_supply(constants.power.supply, memory.supply, meantime, 0.0)
    return memory._replace(
        state=state,
        command=command,
        distance=distance,
        supply=supply,
        irradiance=irradiance,
        step=memory.step + 1,
        ticks=ticks,
    )


def runge_kutta_step(
    kernel: FlightKernel,
    schedule: BatchSchedule,
    state: State,
    numbers: Array,
    command: State,
    surroundings: State,
) -> State:
    """Return the state after one classical Runge-Kutta step."""
    dt = schedule.dt
    a = kernel.rates(state, numbers, command, surroundings)
    b = kernel.rates(kernel.ahead(state, a, 0.5 * dt), numbers, command, surroundings)
    c = kernel.rates(kernel.ahead(state, b, 0.5 * dt), numbers, command, surroundings)
    d = kernel.rates(kernel.ahead(state, c, dt), numbers, command, surroundings)
    return kernel.normalised(kernel.ahead(state, kernel.mean(a, b, c, d), dt))
