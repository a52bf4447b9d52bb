"""
Write the source of a whole flight: model, sensors, estimator, control, mission and battery.

CPU and GPU use the same source; they differ in decorators and in how a thread finds its vehicle.
The kernel contains only the effects that some vehicle of the batch uses.
"""

from collections.abc import Callable, Sequence
from string import Template
from typing import Any

from lta_config.compilation.extract import SourceExtract
from lta_config.compilation.flat import PREFIX, TupleLayout
from lta_control.attitude import yaw_from_quaternion
from lta_control.mission import initial_mission, mission_step
from lta_control.onboard import (
    guidance_altitude,
    onboard_step,
    OnboardMemory,
    reckon_motion,
)
from lta_control.strategies.protocol import NavigationStrategy
from lta_flight.batch import flight
from lta_flight.batch.assembly import (
    assemble_source,
    build_surroundings,
    format_light_reading,
    format_rhythm,
    LIGHT,
)
from lta_flight.batch.targets import BatchRhythm, CompileTarget
from lta_model.effects import initial_memory
from lta_model.state import ACTUATORS, RIGID
from lta_sim import compiled_sensors, light_link
from lta_sim.environment import steady_wind_at
from lta_sim.kernels.kernel import LAYOUT
from lta_sim.kernels.layout import format_tuple
from lta_vlc.direction_fit import fit_direction

BEGIN = TupleLayout(OnboardMemory())
# Functions that the loop below calls, as core_NAME
CORES: tuple[Callable[..., Any], ...] = (
    onboard_step,
    light_link.write_ring_light,
    light_link.sample_magnitude,
    compiled_sensors.draw_errors,
    compiled_sensors.draw_turbulence_memory,
    compiled_sensors.sample_range,
    compiled_sensors.draw_white_noise,
    steady_wind_at,
    flight.draw_initial_state,
    flight.build_command,
    flight.read_sensors,
    flight.sensor_specific_force,
    flight.with_setpoint,
    flight.initial_tally,
    flight.amplitude_error,
    flight.is_lamp_detected,
    flight.sight_from_fit,
    flight.permission_by_charge,
    initial_mission,
    mission_step,
    reckon_motion,
    guidance_altitude,
    flight.initial_supply,
    flight.panel_irradiance,
    flight.step_supply,
    flight.hull_irradiance,
    flight.update_tally,
    flight.update_light_tally,
    yaw_from_quaternion,
)


# One control step of the drone: sensors, estimator, control, and the mission after each block
SENSE = """
        rate, held = rates(state, fixed, command, surroundings), step * $period < craft.held
        force = core_sensor_specific_force(craft, state, rate, held)
        rates_now = (state[10], state[11], state[12])
        heard = core_read_sensors(
            craft, errors, seed, step, step * $period, force, rates_now, state[2], distance,
            step % $pressure == 0,
        )
        distance = math.nan
        if told:
            onboard = core_with_setpoint(onboard, asked)
        onboard = core_onboard_step(craft.drone, onboard, heard, scratch)
        duties = onboard.duties
        if step % $light == $middle:
            middle, reckoned = state[0:7], core_reckon_motion(onboard)
        if step > 0 and step % $light == 0:
            position, q = middle[0:3], middle[3:7]
$heard
            day = $daylight
            amplitudes = $amplitudes
            lamp = light_fit_direction(craft.array, craft.expected, amplitudes, $errors, scratch)
            detected = core_is_lamp_detected($snrs, craft.listening.threshold)
            sight = core_sight_from_fit(
                craft, lamp, detected, amplitudes, reckoned, $light * $period
            )
            asked, mission = core_mission_step(
                craft.mission, mission, sight, core_guidance_altitude(onboard),
                core_permission_by_charge(craft.power, supply.flow.charge), 1, craft.reserve,
            )
            told = True
            began = (step - $light) * $period
            tally = core_update_light_tally(
                craft, tally, middle, sight.seen, sight.bearing, asked.speed, began
            )
"""

# The flight of one vehicle; $before and $decide are the inputs of effects and the control step
FLY = Template('''
$INLINE
def fly(fixed, c, seed, scratch, lights, pencils, out):
    """Fly one vehicle to the end of its flight."""
    nan = math.nan
    craft = $craft
    errors = core_draw_errors(craft.sensors, seed)
    state = core_draw_initial_state(craft, seed)$memory
    supply, irradiance = core_initial_supply(craft.power.charge), 0.0
    tally = core_initial_tally(craft)
    begin = $begin
    onboard = $onboard
    asked, told, mission = onboard.setpoint, False, core_initial_mission()
    middle, reckoned, day = state[0:7], core_reckon_motion(onboard), $dark
    distance = core_sample_range(craft.sensors, errors, seed, 0, state)
    duties = $still
    command = core_build_command(craft, duties)
    duties = craft.duties
    noise, warmth, step, ticks = (0.0, 0.0, 0.0), 0.0, 0, 0
    while tally.outcome == 0:
$before
        wind = core_steady_wind_at(craft.wind, state[0])
        surroundings = wind + noise + (warmth, supply.flow.voltage, 0.0, 0.0, 0.0)
$decide
        if not supply.flow.fed:
            duties = $still
        command = core_build_command(craft, duties)
        x, y, before = state[0], state[1], state
$steps
        if step * $period < craft.held:
            state = $frozen
        if step % $light == 0:
            irradiance = core_panel_irradiance(craft, state)
        thrusts = thrusts_of(state, fixed, command, surroundings)
        supply = core_step_supply(craft, supply, irradiance, thrusts, $period)
        step += 1
        tally = core_update_tally(craft, tally, (x, y), state, supply, step * $period, $period)
    results = $results
    for k in range(len(results)):
        out[k] = results[k]
''')

# Names of the results, and the expressions that give them
FIGURES = (
    'outcome', 'end', 'lift_off', 'search_start', 'path_length', 'closest', 'energy', 'blocks',
    'bearings', 'squares', 'charge', 'x', 'y', 'z', 'stopped',
)  # fmt: skip
RESULTS = (
    '1.0 * tally.outcome', 'step * $period',
    *(f'tally.{name}' for name in FIGURES[2:10]),
    'supply.flow.charge', 'state[0]', 'state[1]', 'state[2]', '1.0 * onboard.stopped',
)  # fmt: skip


def _format_memory(names: Sequence[str]) -> str:
    """Return the source of the initial memory of the effects, which is appended to the state."""
    whole = (0.0,) * RIGID + initial_memory()
    texts = []
    for name in names:
        first = LAYOUT.remembers[name]
        # Skip the rigid part of the state, which `draw_initial_state` gives
        values = whole[first : first + LAYOUT.memory_size(name)]
        if values:
            texts.append(format_tuple(repr(float(value)) for value in values))
        if name == 'turbulence':
            # Turbulence starts in its stationary state instead of at zero
            texts[-1] = 'core_draw_turbulence_memory(seed)'
    return ''.join(f' + {text}' for text in texts)


def format_held_state(names: Sequence[str]) -> str:
    """Return the source of a held drone's state: motors, gas and turbulence continue."""
    size = RIGID + sum(LAYOUT.memory_size(name) for name in names)
    return format_tuple(f'{"before" if k < RIGID else "state"}[{k}]' for k in range(size))


def _format_initial_values(names: Sequence[str]) -> dict[str, str]:
    """Return the source of the values before the first step, and of the results."""
    return {
        'memory': _format_memory(names),
        'begin': format_tuple(map(repr, BEGIN.write(OnboardMemory()).tolist())),
        'onboard': BEGIN.render_expression('begin'),
        'still': format_tuple(['0.0'] * ACTUATORS),
        'frozen': format_held_state(names),
        'before': build_surroundings(names),
        'results': format_tuple(RESULTS),
    }


def build_source(
    names: Sequence[str],
    strategy: NavigationStrategy,
    constants: TupleLayout[Any],
    diodes: int,
    rhythm: BatchRhythm,
    target: CompileTarget,
    *,
    closed: bool,
) -> str:
    """
    Return the source of a flight.

    Parameters
    ----------
    names : sequence of str
        Effects of the kernel, in registry order.
    strategy : NavigationStrategy
        How the drone navigates.
    craft : Layout
        Of `flight.FlightConstants`.
    diodes : int
        Number of diodes.
    rhythm : BatchRhythm
        The schedule.
    target : CompileTarget
        `CPU` or `GPU`.
    closed : bool
        Whether the drone decides; otherwise it keeps the duties of its constants.

    """
    extract = SourceExtract(strategy=strategy)
    for core in CORES:
        extract.add_function(core, PREFIX)
    extract.add_function(fit_direction, LIGHT)
    parts = {
        'craft': constants.render_expression('c'),
        'decide': SENSE if closed else '        pass',
        **_format_initial_values(names),
        **format_rhythm(rhythm),
        **format_light_reading(diodes),
    }
    kinds = {**constants.tuple_fields(), **BEGIN.tuple_fields()}
    return assemble_source(names, extract, kinds, target, FLY, parts, {'diodes': diodes})
