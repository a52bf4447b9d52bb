"""
Write the text of one leg: kernel, sensors, estimator, control, homing and cell, to be continued.

The parts are those of a flight of a batch (`fleet.assembly`); what the leg has of its own is that
it begins with what the leg before left, and leaves the same to the next.
"""

from collections.abc import Callable, Sequence
from string import Template
from typing import Any

from lta_config.compilation.compiled import ENTRY
from lta_config.compilation.extract import Extract
from lta_config.compilation.flat import Layout, PREFIX
from lta_control.onboard import onboard_step
from lta_flight.fleet import flight
from lta_flight.fleet.assembly import assembled, counts, heard_by, LIGHT, surrounded
from lta_flight.fleet.targets import CPU, PENCILS, Rhythm, SCRATCH, STEP, Target
from lta_model.effects import initial_memory
from lta_model.light.pencils import LAMPS
from lta_model.state import RIGID
from lta_sim import counted_light as heard
from lta_sim import counted_sensors
from lta_sim.kernels.kernel import LAYOUT
from lta_sim.kernels.layout import tuple_of
from lta_studies.mission import aloft
from lta_vlc.fit import fit

COARSE = 2  # steps of the full loop in one of a leg: a Runge-Kutta step of 5 ms is as good

CORES: tuple[Callable[..., Any], ...] = (
    onboard_step,
    counted_sensors.draw_errors,
    counted_sensors.range_reading,
    counted_sensors.white_noise,
    flight.command_of,
    flight.error_of,
    flight.guided,
    flight.heard,
    flight.irradiance_on_hull,
    flight.sense,
    flight.shone,
    flight.true_force,
    aloft.counted,
    aloft.elsewhere,
    aloft.strength_of,
    aloft.judged,
    aloft.nowhere,
    aloft.paid,
    aloft.reckoned_of,
)
# Cores whose functions have the names of others stand behind a prefix of their own.
OWN: dict[str, tuple[Callable[..., Any], ...]] = {
    'hearing': (heard.echoes, heard.direct, heard.magnitude),
    'homing': (aloft.led, aloft.seen),
    LIGHT: (fit,),
}

LEG = Template('''
$INLINE
def fly(fixed, c, g, m, s, seed, scratch, lights, echoes, pencils):
    """Fly one leg; what is remembered stands in m, the state of the model in s."""
    craft = $craft
    leg = $leg
    memory = $memory
    state = $state
    errors = core_draw_errors(craft.sensors, seed)
    onboard, homing, asked, told, fresh, phase, middle, reckoned, distance = memory[0:9]
    supply, irradiance, charge, step, ticks, begun, path, lowest, outcome = memory[9:18]
    if step == 0:
        distance = core_range_reading(craft.sensors, errors, seed, 0, state)
    noise, warmth = (0.0, 0.0, 0.0), 0.0
    command, gathered = core_command_of(craft, onboard.duties), core_nowhere()
    while outcome == 0:
$before
        surroundings = craft.wind + noise + (warmth, supply.flow.voltage, 0.0, 0.0, 0.0)
        force = core_true_force(craft, state, rates(state, fixed, command, surroundings))
        rates_now = (state[10], state[11], state[12])
        heard = core_sense(
            craft, errors, seed, step, step * $period, force, rates_now, state[2], distance,
            step % $pressure == 0,
        )
        distance = math.nan
        if fresh:
            onboard, fresh = core_guided(onboard, asked), False
        onboard = core_onboard_step(craft.drone, onboard, heard, scratch)
        if step % $light == $middle:
            middle, reckoned = state[0:7], core_reckoned_of(onboard)
        if step > 0 and step % $light == 0:
            position, q = middle[0:3], middle[3:7]
            if core_elsewhere(middle, gathered):
                gathered = middle
                hearing_echoes(craft.listening, position, q, echoes, pencils)
            lights[:] = echoes
            hearing_direct(craft.listening, position, q, lights)
$heard
            amplitudes = $amplitudes
            lamp = light_fit(craft.array, craft.expected, amplitudes, $errors, scratch)
            found = lamp.found and core_heard($snrs, craft.listening.threshold)
            listening = craft.listening
            strength = core_strength_of(listening.cosines, listening.sines, amplitudes)
            sight = homing_seen(lamp, found, strength, reckoned, $light * $period)
            wish, phase, homing = homing_led(
                craft.mission, leg.kind, phase, homing, sight, onboard.estimate.ready,
                onboard.measured.altitude,
            )
            asked = core_Setpoint(wish[0], wish[1], wish[2])
            told, fresh = True, True
        command = core_command_of(craft, onboard.duties)
        x, y = state[0], state[1]
$steps
        if step % $light == 0:
            irradiance = core_shone(craft, state)
        thrusts = thrusts_of(state, fixed, command, surroundings)
        supply = core_paid(craft, leg, supply, irradiance, thrusts, $period)
        charge = core_counted(craft, leg, charge, supply.flow.current, $period)
        lowest = min(lowest, supply.flow.voltage)
        step += 1
        path += math.hypot(state[0] - x, state[1] - y)
        outcome = core_judged(
            craft, leg, state, onboard, homing, phase, supply.flow.fed, charge,
            (step - begun) * $period,
        )
    after = core_Aloft(
        onboard, homing, asked, told, fresh, phase, middle, reckoned, distance, supply,
        irradiance, charge, step, ticks, begun, path, lowest, outcome,
    )
$kept
    for k in range(len(state)):
        s[k] = state[k]
''')

ON_CPU = Target(
    CPU.imports,
    CPU.inline,
    f'''
{ENTRY.replace('cache=True', 'nogil=True, cache=True')}
def fly_leg(fixed, c, g, m, s, seed):
    """Fly one leg and write what is remembered over what was."""
    scratch, lights = np.empty({SCRATCH}), np.empty(({LAMPS + 1}, $diodes))
    echoes, pencils = np.empty_like(lights), np.empty({PENCILS})
    fly(fixed, c, g, m, s, seed, scratch, lights, echoes, pencils)
''',
)


def remembered(names: Sequence[str]) -> list[float]:
    """Return what the effects remember at the start; what the state of a leg ends with."""
    whole = (0.0,) * RIGID + initial_memory()
    values: list[float] = []
    for name in names:
        first = LAYOUT.remembers[name]
        values += whole[first : first + LAYOUT.remembered(name)]
    return values


def source(
    names: Sequence[str],
    craft: Layout[Any],
    leg: Layout[Any],
    memory: Layout[Any],
    diodes: int,
    rhythm: Rhythm,
) -> str:
    """
    Return the text of a leg.

    Parameters
    ----------
    names : sequence of str
        Effects of the kernel, in registry order.
    craft, leg, memory : Layout
        Of `fleet.numbers.Craft`, `aloft.Leg` and `aloft.Aloft`.
    diodes : int
        In the ring.
    rhythm : Rhythm
        When what is due.

    """
    extract = Extract()
    for core in CORES:
        extract.add(core, PREFIX)
    for prefix, cores in OWN.items():
        for core in cores:
            extract.add(core, prefix)
    size = RIGID + len(remembered(names))
    hearing = heard_by(diodes)
    told = hearing['heard'].replace(f'{PREFIX}_', 'hearing_').splitlines()
    hearing['heard'] = '\n'.join(line for line in told if 'on_ring' not in line)
    began = memory.expression('m')
    for kind in ('Homing', 'Fix'):
        began = began.replace(f'{PREFIX}_{kind}(', f'homing_{kind}(')
    parts = {
        'craft': craft.expression('c'),
        'leg': leg.expression('g'),
        'memory': began,
        'state': tuple_of(f's[{k}]' for k in range(size)),
        'kept': '\n'.join(f'    m[{k}] = after.{path}' for k, path in enumerate(memory.paths)),
        'before': surrounded(names),
        **counts(rhythm),
        'dt': repr(COARSE * STEP),
        'substeps': str(rhythm.control // COARSE),
        'ranges': str(rhythm.range // COARSE),
        **hearing,
    }
    kinds = {**craft.kinds(), **leg.kinds(), **memory.kinds()}
    return assembled(names, extract, kinds, ON_CPU, LEG, parts, {'diodes': diodes})
