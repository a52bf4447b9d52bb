"""
What surrounds the cores in a flight of a batch, as plain functions of numbers and tuples.

The order of things is that of `lta_flight.loop`; what is different is said here. Chance is
counted; the lamp is heard as `lta_sim.counted_light` says, not through an ADC block; the energy
reserve is that of the true charge; and values pass no message, so that they keep all their bits.
"""

import math

from lta_control.attitude import heading
from lta_control.cascade import Setpoint, wrap
from lta_control.mission import MissionSettings
from lta_control.onboard import Heard, Onboard
from lta_control.per_rotor import PerRotor
from lta_control.strategies.bearing_angle import start, steer
from lta_control.strategies.protocol import Memory, Sight
from lta_flight.fleet.numbers import Craft, Goal, Tally, Vector
from lta_model.electrical.loads import demand
from lta_model.electrical.power_path import at_rest
from lta_model.light.lambertian import shine
from lta_model.light.panel_light import day_on_panel, lamp_on
from lta_model.light.surround import day_on
from lta_model.stiffness import SPEED_LIMIT
from lta_sim.counted_chance import uniforms
from lta_sim.counted_sensors import (
    Errors,
    force_at,
    imu_reading,
    pressure_reading,
    START,
)
from lta_sim.supply_step import Account, Meantime, supplied
from lta_vlc.direction import PART

State = tuple[float, ...]
LIFTED = 0.01  # m above where it stood: the drone has left the ground, as in the results

FLYING, REACHED, TIMEOUT, ESCAPED = 0, 1, 2, 3
RAN_AWAY = 4  # beyond the outcomes: the numbers, see `stiffness.watch`
REST, CLIMB, SEEK, LAND = 0, 1, 2, 5  # as `phases.Phase`; BAG never arrives


def full(charge: float) -> Account:
    """Return a supply at rest in the dark, with its cell at a state of charge."""
    return Account(at_rest(charge), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def pose_at_start(craft: Craft, seed: int) -> State:
    """Return the rigid part of the state: at rest, with the heading that the seed draws."""
    share, _ = uniforms(seed, START, 0, 0)
    half = 0.5 * (craft.heading + craft.spread * (2.0 * share - 1.0))
    x, y, z = craft.place
    return (
        x, y, z, 0.0, 0.0, math.sin(half), math.cos(half), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    )  # fmt: skip


def clipped(duty: float, low: float) -> float:
    """Return a duty within what a rotor can do."""
    return min(max(duty, low), 1.0)


def command_of(craft: Craft, u: PerRotor) -> tuple[float, ...]:
    """Return a command as the kernel takes it."""
    low, (x, y, z) = craft.lowest, craft.mass_place
    return (
        clipped(u[0], low[0]), clipped(u[1], low[1]), clipped(u[2], low[2]), clipped(u[3], low[3]),
        clipped(u[4], low[4]), clipped(u[5], low[5]), clipped(u[6], low[6]), clipped(u[7], low[7]),
        x, y, z,
    )  # fmt: skip


def sense(
    craft: Craft,
    errors: Errors,
    seed: int,
    step: int,
    elapsed: float,
    force: Vector,
    rates: Vector,
    height: float,
    distance: float,
    pressure_due: bool,
) -> Heard:
    """Return what the estimator hears; force and rates are those at the sensor."""
    felt, turned = imu_reading(errors, seed, step, force, rates)
    pressure = math.nan
    if pressure_due:
        pressure = pressure_reading(craft.sensors, errors, seed, step, height, elapsed)
    return Heard(turned, felt, distance, pressure)


def true_force(craft: Craft, state: State, rate: State) -> Vector:
    """Return the specific force at the sensor. [m/s2]"""
    return force_at(craft.sensors, state, rate)


def guided(memory: Onboard, setpoint: Setpoint) -> Onboard:
    """Return what the drone remembers, with a setpoint."""
    return Onboard(
        memory.estimate, memory.measured, True, setpoint, memory.control, memory.duties,
        memory.stopped,
    )  # fmt: skip


def guide(
    settings: MissionSettings,
    phase: int,
    memory: Memory,
    sight: Sight,
    ready: bool,
    altitude: float,
    reserve: bool,
) -> tuple[Setpoint, int, Memory]:
    """Return what to hold, and the mission: `mission.mission_step` with a number for a phase."""
    if not ready or (phase == REST and reserve):
        return Setpoint(0.0, sight.heading, 0.0), phase, memory
    if phase == REST:
        phase, memory = CLIMB, start(sight.heading)
    if phase == CLIMB and altitude > settings.altitude - settings.reached:
        phase = SEEK
    if reserve:
        phase = LAND
    if phase == SEEK:
        course, memory = steer(settings, memory, sight)
        return Setpoint(settings.altitude, course.heading, course.speed), phase, memory
    height = settings.landing if phase == LAND else settings.altitude
    return Setpoint(height, memory[0], 0.0), phase, memory


def shone(craft: Craft, state: State) -> float:
    """Return the light that the panel now has. [W/m2]"""
    position, q = (state[0], state[1], state[2]), (state[3], state[4], state[5], state[6])
    power, lamp, around = craft.power, craft.listening.lamp, craft.listening.around
    bright = power.lamp_share * lamp_on(power.panel, around, lamp, position, q)
    day = power.day_share * day_on_panel(power.panel, around, position, q)
    return bright + day + power.panel.share * power.ambient


def drained(
    craft: Craft, supply: Account, irradiance: float, thrusts: PerRotor, dt: float
) -> Account:
    """Return the supply after a control period in such light [W/m2] with such thrusts. [N, s]"""
    asked = demand(craft.power.loads, thrusts, True) + craft.power.looking
    meantime = Meantime(irradiance, asked, dt, False, False)
    return supplied(craft.power.parts, supply, meantime, 0.0)


def irradiance_on_hull(craft: Craft, state: State) -> float:
    """Return the irradiance at the hull centre on planes that face each light. [W/m2]"""
    lamp = craft.listening.lamp
    light = shine(lamp, (state[0], state[1], state[2]))[0] + lamp.diffuse
    power, s = craft.power, craft.listening.around
    day = day_on(s, (state[0], state[1], state[2]), (s.sun_x, s.sun_y, s.sun_z))
    return power.lamp_share * light + power.ambient + power.day_share * day


def begun(craft: Craft) -> Tally:
    """Return the tally before the first step."""
    x, y, _ = craft.place
    away = math.hypot(craft.goal.x - x, craft.goal.y - y)
    return Tally(FLYING, math.nan, math.nan, 0.0, away, 0.0, 0.0, 0.0, 0.0)


def error_of(amplitude: float, snr: float) -> float:
    """Return the standard deviation of a reading by noise, as `lta_vlc.direction`. [counts]"""
    return PART * amplitude / snr if snr > 0.0 else math.inf


def heard(snrs: tuple[float, ...], threshold: float) -> bool:
    """Tell whether a diode hears the lamp."""
    for snr in snrs:  # noqa: SIM110 - what compiles
        if snr >= threshold:
            return True
    return False


def sighted(found: bool, angle: float, facing: float, interval: float) -> Sight:
    """Return what a light block says, as far as BAG looks at it."""
    return Sight(
        found, angle, facing, (0.0,), interval, 0.0, 0.0, 0.0, (0.0, 0.0), (0.0, 0.0)
    )  # fmt: skip


def judge(goal: Goal, x: float, y: float, z: float, elapsed: float) -> int:
    """Return how a flight stands, as `lta_sim.referee`."""
    if math.hypot(goal.x - x, goal.y - y) <= goal.radius:
        return REACHED
    if not (abs(x) <= goal.half_length and abs(y) <= goal.half_width and z <= goal.height):
        return ESCAPED
    return TIMEOUT if elapsed >= goal.limit else FLYING


def sane(state: State) -> bool:
    """Tell whether velocity and rates are what anything that flies here has."""
    return (
        abs(state[7]) < SPEED_LIMIT and abs(state[8]) < SPEED_LIMIT
        and abs(state[9]) < SPEED_LIMIT and abs(state[10]) < SPEED_LIMIT
        and abs(state[11]) < SPEED_LIMIT and abs(state[12]) < SPEED_LIMIT
    )  # fmt: skip


def flown(
    craft: Craft,
    tally: Tally,
    before: tuple[float, float],
    state: State,
    supply: Account,
    elapsed: float,
    dt: float,
) -> Tally:
    """Return the tally after one more control period; `before` is where it began. [m]"""
    x, y, z = state[0], state[1], state[2]
    goal = craft.goal
    lift_off, energy = tally.lift_off, tally.energy
    if math.isfinite(lift_off):
        energy -= supply.flow.voltage * supply.flow.current * dt
    elif z > craft.place[2] + LIFTED:
        lift_off = elapsed
    return Tally(
        judge(goal, x, y, z, elapsed) if sane(state) else RAN_AWAY,
        lift_off,
        tally.search_start,
        tally.path_length + math.hypot(x - before[0], y - before[1]),
        min(tally.closest, math.hypot(goal.x - x, goal.y - y)),
        energy,
        tally.blocks,
        tally.bearings,
        tally.squares,
    )


def lit_tally(
    craft: Craft,
    tally: Tally,
    middle: State,
    found: bool,
    angle: float,
    speed: float,
    began: float,
) -> Tally:
    """Return the tally after a light block that began at a time [s], seen from its middle."""
    search_start = tally.search_start
    if not math.isfinite(search_start) and speed > 0.0:
        search_start = began
    blocks, bearings, squares = tally.blocks, tally.bearings, tally.squares
    if math.isfinite(search_start):
        blocks += 1.0
        if found:
            q = (middle[3], middle[4], middle[5], middle[6])
            true = math.atan2(craft.goal.y - middle[1], craft.goal.x - middle[0]) - heading(q)
            bearings += 1.0
            squares += wrap(angle - true) ** 2
    return Tally(
        tally.outcome, tally.lift_off, search_start, tally.path_length, tally.closest,
        tally.energy, blocks, bearings, squares,
    )  # fmt: skip
