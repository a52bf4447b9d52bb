"""
Generate the source of one leg: kernel, sensors, estimator, control, homing and cell.

The parts are those of a batch flight (`lta_flight.batch`), except that a leg starts from the state
that the leg before left, and returns its own state for the next.
"""

from collections.abc import Callable, Sequence
from string import Template
from typing import Any

from lta_config.compilation.compiler import ENTRY
from lta_config.compilation.extract import SourceExtract
from lta_config.compilation.flat import PREFIX, TupleLayout
from lta_control.onboard import guidance_altitude, onboard_step, reckon_motion
from lta_control.strategies.homing import STRATEGY
from lta_flight.batch import flight
from lta_flight.batch.assembly import (
    assemble_source,
    build_surroundings,
    format_light_reading,
    format_rhythm,
    LIGHT,
)
from lta_flight.batch.targets import BatchRhythm, CompileTarget, CPU, PENCILS, SCRATCH, STEP
from lta_model.effects import initial_memory
from lta_model.light.ray_bundles import LAMPS
from lta_model.state import RIGID
from lta_sim import compiled_sensors, light_link
from lta_sim.environment import steady_wind_at
from lta_sim.kernels.kernel import LAYOUT
from lta_sim.kernels.layout import format_tuple
from lta_studies.mission import leg_state
from lta_vlc.direction_fit import fit_direction

COARSE = 2  # steps of the full loop per step here; a Runge-Kutta step of 5 ms is as accurate

CORES: tuple[Callable[..., Any], ...] = (
    onboard_step,
    compiled_sensors.draw_errors,
    compiled_sensors.sample_range,
    compiled_sensors.draw_white_noise,
    flight.build_command,
    flight.amplitude_error,
    flight.with_setpoint,
    flight.is_lamp_detected,
    flight.hull_irradiance,
    flight.read_sensors,
    flight.panel_irradiance,
    flight.sensor_specific_force,
    leg_state.meter_charge,
    leg_state.has_moved,
    leg_state.assess_leg,
    leg_state.unreachable_pose,
    leg_state.step_leg_supply,
    leg_state.guide_leg,
    flight.sight_from_fit,
    steady_wind_at,
    guidance_altitude,
    reckon_motion,
)
# Cores with functions that share a name with others get a prefix of their own.
OWN: dict[str, tuple[Callable[..., Any], ...]] = {
    'hearing': (
        light_link.write_reflections,
        light_link.add_direct_light,
        light_link.sample_magnitude,
    ),
    LIGHT: (fit_direction,),
}

LEG = Template('''
$INLINE
def fly(fixed, c, g, m, s, seed, scratch, lights, echoes, pencils):
    """Fly one leg; m holds the leg state, s the state of the model."""
    craft = $craft
    leg = $leg
    memory = $memory
    state = $state
    errors = core_draw_errors(craft.sensors, seed)
    onboard, mission, asked, told, fresh, middle, reckoned, distance = memory[0:8]
    supply, irradiance, charge, step, ticks, begun, path, lowest, outcome = memory[8:17]
    if step == 0:
        distance = core_sample_range(craft.sensors, errors, seed, 0, state)
    noise, warmth = (0.0, 0.0, 0.0), 0.0
    command, gathered = core_build_command(craft, onboard.duties), core_unreachable_pose()
    while outcome == 0:
$before
        wind = core_steady_wind_at(craft.wind, state[0])
        surroundings = wind + noise + (warmth, supply.flow.voltage, 0.0, 0.0, 0.0)
        rate = rates(state, fixed, command, surroundings)
        force = core_sensor_specific_force(craft, state, rate, False)
        rates_now = (state[10], state[11], state[12])
        heard = core_read_sensors(
            craft, errors, seed, step, step * $period, force, rates_now, state[2], distance,
            step % $pressure == 0,
        )
        distance = math.nan
        if fresh:
            onboard, fresh = core_with_setpoint(onboard, asked), False
        onboard = core_onboard_step(craft.drone, onboard, heard, scratch)
        if step % $light == $middle:
            middle, reckoned = state[0:7], core_reckon_motion(onboard)
        if step > 0 and step % $light == 0:
            position, q = middle[0:3], middle[3:7]
            if core_has_moved(middle, gathered):
                gathered = middle
                hearing_write_reflections(craft.listening, position, q, echoes, pencils)
            lights[:] = echoes
            hearing_add_direct_light(craft.listening, position, q, lights)
            day = $daylight
$heard
            amplitudes = $amplitudes
            lamp = light_fit_direction(craft.array, craft.expected, amplitudes, $errors, scratch)
            detected = core_is_lamp_detected($snrs, craft.listening.threshold)
            sight = core_sight_from_fit(
                craft, lamp, detected, amplitudes, reckoned, $light * $period
            )
            asked, mission = core_guide_leg(
                craft.mission, leg.kind, mission, sight, core_guidance_altitude(onboard),
                craft.reserve,
            )
            told, fresh = True, True
        command = core_build_command(craft, onboard.duties)
        x, y = state[0], state[1]
$steps
        if step % $light == 0:
            irradiance = core_panel_irradiance(craft, state)
        thrusts = thrusts_of(state, fixed, command, surroundings)
        supply = core_step_leg_supply(craft, leg, supply, irradiance, thrusts, $period)
        charge = core_meter_charge(craft, leg, charge, supply.flow.current, $period)
        lowest = min(lowest, supply.flow.voltage)
        step += 1
        path += math.hypot(state[0] - x, state[1] - y)
        outcome = core_assess_leg(
            craft, leg, state, onboard, mission, supply.flow.fed, charge,
            (step - begun) * $period,
        )
    after = core_LegState(
        onboard, mission, asked, told, fresh, middle, reckoned, distance, supply,
        irradiance, charge, step, ticks, begun, path, lowest, outcome,
    )
$kept
    for k in range(len(state)):
        s[k] = state[k]
''')

ON_CPU = CompileTarget(
    CPU.imports,
    CPU.inline,
    f'''
{ENTRY.replace('cache=True', 'nogil=True, cache=True')}
def fly_leg(fixed, c, g, m, s, seed):
    """Fly one leg and write the new leg state to m, the state of the model to s."""
    scratch, lights = np.empty({SCRATCH}), np.empty(({LAMPS + 1}, $diodes))
    echoes, pencils = np.empty_like(lights), np.empty({PENCILS})
    fly(fixed, c, g, m, s, seed, scratch, lights, echoes, pencils)
''',
)


def initial_effect_memory(names: Sequence[str]) -> list[float]:
    """Return the initial memory of the effects, the last part of a leg's state."""
    whole = (0.0,) * RIGID + initial_memory()
    values: list[float] = []
    for name in names:
        first = LAYOUT.remembers[name]
        values += whole[first : first + LAYOUT.memory_size(name)]
    return values


def generate_source(
    names: Sequence[str],
    constants: TupleLayout[Any],
    leg: TupleLayout[Any],
    memory: TupleLayout[Any],
    diodes: int,
    rhythm: BatchRhythm,
) -> str:
    """
    Return the source of a leg.

    Parameters
    ----------
    names : sequence of str
        Effects of the kernel, in registry order.
    constants, leg, memory : TupleLayout
        Layouts of `FlightConstants`, `LegPlan` and `LegState`.
    diodes : int
        Number of diodes in the ring.
    rhythm : BatchRhythm
        Periods of control, sensors and light blocks.

    """
    extract = SourceExtract(strategy=STRATEGY)
    for core in CORES:
        extract.add_function(core, PREFIX)
    for prefix, cores in OWN.items():
        for core in cores:
            extract.add_function(core, prefix)
    size = RIGID + len(initial_effect_memory(names))
    hearing = format_light_reading(diodes)
    told = hearing['heard'].replace(f'{PREFIX}_', 'hearing_').splitlines()
    # `day` is that of this block: stored reflections do not tell how daylight sweeps.
    # A leg adds the light of its lamp itself, from stored reflections.
    hearing['heard'] = '\n'.join(line for line in told if 'write_ring_light' not in line)
    parts = {
        'craft': constants.render_expression('c'),
        'leg': leg.render_expression('g'),
        'memory': memory.render_expression('m'),
        'state': format_tuple(f's[{k}]' for k in range(size)),
        'kept': '\n'.join(f'    m[{k}] = after.{path}' for k, path in enumerate(memory.paths)),
        'before': build_surroundings(names),
        **format_rhythm(rhythm),
        'dt': repr(COARSE * STEP),
        'substeps': str(rhythm.control // COARSE),
        'ranges': str(rhythm.range // COARSE),
        **hearing,
    }
    kinds = {**constants.tuple_fields(), **leg.tuple_fields(), **memory.tuple_fields()}
    return assemble_source(names, extract, kinds, ON_CPU, LEG, parts, {'diodes': diodes})
