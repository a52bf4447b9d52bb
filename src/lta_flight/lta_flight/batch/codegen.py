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
from lta_control.onboard import onboard_step, OnboardMemory
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
    flight.initial_pose,
    flight.build_command,
    flight.read_sensors,
    flight.sensor_specific_force,
    flight.with_setpoint,
    flight.guidance_step,
    flight.initial_tally,
    flight.amplitude_error,
    flight.is_lamp_detected,
    flight.build_sight,
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
        force = core_sensor_specific_force(
            craft, state, rates(state, fixed, command, surroundings)
        )
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
            middle, facing = state[0:7], onboard.measured.heading
        if step > 0 and step % $light == 0:
            position, q = middle[0:3], middle[3:7]
$heard
            lamp = light_fit_direction(craft.array, craft.expected, $amplitudes, $errors, scratch)
            found = lamp.found and core_is_lamp_detected($snrs, craft.listening.threshold)
            angle = math.atan2(lamp.y, lamp.x)
            sight = core_build_sight(found, angle, facing, $light * $period)
            asked, phase, memory = core_guidance_step(
                craft.mission, phase, memory, sight, onboard.estimate.ready,
                onboard.measured.altitude, supply.flow.charge <= craft.power.reserve,
            )
            told = True
            began = (step - $light) * $period
            tally = core_update_light_tally(craft, tally, middle, found, angle, asked.speed, began)
"""

# The flight of one vehicle; $before and $decide are the inputs of effects and the control step
FLY = Template('''
$INLINE
def fly(fixed, c, seed, scratch, lights, pencils, out):
    """Fly one vehicle to the end of its flight."""
    nan = math.nan
    craft = $craft
    errors = core_draw_errors(craft.sensors, seed)
    state = core_initial_pose(craft, seed)$memory
    supply, irradiance = core_initial_supply(craft.power.charge), 0.0
    tally = core_initial_tally(craft)
    begin = $begin
    onboard = $onboard
    asked, told, phase, memory = onboard.setpoint, False, 0, (0.0,)
    middle, facing = state[0:7], 0.0
    distance = core_sample_range(craft.sensors, errors, seed, 0, state)
    duties = $still
    command = core_build_command(craft, duties)
    duties = craft.duties
    noise, warmth, step, ticks = (0.0, 0.0, 0.0), 0.0, 0, 0
    while tally.outcome == 0:
$before
        surroundings = craft.wind + noise + (warmth, supply.flow.voltage, 0.0, 0.0, 0.0)
$decide
        if not supply.flow.fed:
            duties = $still
        command = core_build_command(craft, duties)
        x, y = state[0], state[1]
$steps
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
        # Skip the rigid part of the state, which `initial_pose` gives
        values = whole[first : first + LAYOUT.memory_size(name)]
        if values:
            texts.append(format_tuple(repr(float(value)) for value in values))
        if name == 'turbulence':
            # Turbulence starts in its stationary state instead of at zero
            texts[-1] = 'core_draw_turbulence_memory(seed)'
    return ''.join(f' + {text}' for text in texts)


def _format_initial_values(names: Sequence[str]) -> dict[str, str]:
    """Return the source of the values before the first step, and of the results."""
    return {
        'memory': _format_memory(names),
        'begin': format_tuple(map(repr, BEGIN.write(OnboardMemory()).tolist())),
        'onboard': BEGIN.render_expression('begin'),
        'still': format_tuple(['0.0'] * ACTUATORS),
        'before': build_surroundings(names),
        'results': format_tuple(RESULTS),
    }


def build_source(
    names: Sequence[str],
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
    constants : TupleLayout
        Layout of the `FlightConstants`.
    diodes : int
        Number of diodes.
    rhythm : BatchRhythm
        The schedule.
    target : CompileTarget
        `CPU` or `GPU`.
    closed : bool
        Whether the drone decides; otherwise it keeps the duties of its constants.

    """
    extract = SourceExtract()
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
