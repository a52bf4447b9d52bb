"""
Write the text of a whole flight: kernel, sensors, estimator, control, allocation, mission, cell.

One text for the processor and for a GPU; they differ in decorators and in how a thread finds its
vehicle. The kernel holds only the effects that some vehicle of the batch has on.
"""

from collections.abc import Callable, Sequence
from string import Template
from typing import Any

from lta_config.compilation.extract import Extract
from lta_config.compilation.flat import Layout, PREFIX
from lta_control.attitude import heading
from lta_control.onboard import Onboard, onboard_step
from lta_flight.fleet import flight
from lta_flight.fleet.assembly import assembled, counts, heard_by, LIGHT, surrounded
from lta_flight.fleet.targets import Rhythm, Target
from lta_model.effects import initial_memory
from lta_model.state import ACTUATORS, RIGID
from lta_sim import counted_light as heard
from lta_sim import counted_sensors
from lta_sim.kernels.kernel import LAYOUT
from lta_sim.kernels.layout import tuple_of
from lta_vlc.fit import fit

BEGIN = Layout(Onboard())
CORES: tuple[Callable[..., Any], ...] = (
    onboard_step,
    heard.on_ring,
    heard.magnitude,
    counted_sensors.draw_errors,
    counted_sensors.eddies,
    counted_sensors.range_reading,
    counted_sensors.white_noise,
    flight.pose_at_start,
    flight.command_of,
    flight.sense,
    flight.true_force,
    flight.guided,
    flight.guide,
    flight.begun,
    flight.error_of,
    flight.heard,
    flight.sighted,
    flight.full,
    flight.shone,
    flight.drained,
    flight.irradiance_on_hull,
    flight.flown,
    flight.lit_tally,
    heading,
)


SENSE = """
        force = core_true_force(craft, state, rates(state, fixed, command, surroundings))
        rates_now = (state[10], state[11], state[12])
        heard = core_sense(
            craft, errors, seed, step, step * $period, force, rates_now, state[2], distance,
            step % $pressure == 0,
        )
        distance = math.nan
        if told:
            onboard = core_guided(onboard, asked)
        onboard = core_onboard_step(craft.drone, onboard, heard, scratch)
        duties = onboard.duties
        if step % $light == $middle:
            middle, facing = state[0:7], onboard.measured.heading
        if step > 0 and step % $light == 0:
            position, q = middle[0:3], middle[3:7]
$heard
            lamp = light_fit(craft.array, craft.expected, $amplitudes, $errors, scratch)
            found = lamp.found and core_heard($snrs, craft.listening.threshold)
            angle = math.atan2(lamp.y, lamp.x)
            sight = core_sighted(found, angle, facing, $light * $period)
            asked, phase, memory = core_guide(
                craft.mission, phase, memory, sight, onboard.estimate.ready,
                onboard.measured.altitude, supply.flow.charge <= craft.power.reserve,
            )
            told = True
            began = (step - $light) * $period
            tally = core_lit_tally(craft, tally, middle, found, angle, asked.speed, began)
"""

FLY = Template('''
$INLINE
def fly(fixed, c, seed, scratch, lights, pencils, out):
    """Fly one vehicle to the end of its flight."""
    nan = math.nan
    craft = $craft
    errors = core_draw_errors(craft.sensors, seed)
    state = core_pose_at_start(craft, seed)$memory
    supply, irradiance = core_full(craft.power.charge), 0.0
    tally = core_begun(craft)
    begin = $begin
    onboard = $onboard
    asked, told, phase, memory = onboard.setpoint, False, 0, (0.0,)
    middle, facing = state[0:7], 0.0
    distance = core_range_reading(craft.sensors, errors, seed, 0, state)
    duties = $still
    command = core_command_of(craft, duties)
    duties = craft.duties
    noise, warmth, step, ticks = (0.0, 0.0, 0.0), 0.0, 0, 0
    while tally.outcome == 0:
$before
        surroundings = craft.wind + noise + (warmth, supply.flow.voltage, 0.0, 0.0, 0.0)
$decide
        if not supply.flow.fed:
            duties = $still
        command = core_command_of(craft, duties)
        x, y = state[0], state[1]
$steps
        if step % $light == 0:
            irradiance = core_shone(craft, state)
        thrusts = thrusts_of(state, fixed, command, surroundings)
        supply = core_drained(craft, supply, irradiance, thrusts, $period)
        step += 1
        tally = core_flown(craft, tally, (x, y), state, supply, step * $period, $period)
    results = $results
    for k in range(len(results)):
        out[k] = results[k]
''')

FIGURES = (
    'outcome', 'end', 'lift_off', 'search_start', 'path_length', 'closest', 'energy', 'blocks',
    'bearings', 'squares', 'charge', 'x', 'y', 'z', 'stopped',
)  # fmt: skip
RESULTS = (
    '1.0 * tally.outcome', 'step * $period',
    *(f'tally.{name}' for name in FIGURES[2:10]),
    'supply.flow.charge', 'state[0]', 'state[1]', 'state[2]', '1.0 * onboard.stopped',
)  # fmt: skip


def _remembered(names: Sequence[str]) -> str:
    """Return the source of what the effects remember at the start, as more of the state."""
    whole = (0.0,) * RIGID + initial_memory()
    texts = []
    for name in names:
        first = LAYOUT.remembers[name]
        values = whole[first : first + LAYOUT.remembered(name)]
        if values:
            texts.append(tuple_of(repr(float(value)) for value in values))
        if name == 'turbulence':
            texts[-1] = 'core_eddies(seed)'
    return ''.join(f' + {text}' for text in texts)


def _beginning(names: Sequence[str]) -> dict[str, str]:
    """Return the source of what is there before the first step, and of what comes out."""
    return {
        'memory': _remembered(names),
        'begin': tuple_of(map(repr, BEGIN.write(Onboard()).tolist())),
        'onboard': BEGIN.expression('begin'),
        'still': tuple_of(['0.0'] * ACTUATORS),
        'before': surrounded(names),
        'results': tuple_of(RESULTS),
    }


def source(
    names: Sequence[str],
    craft: Layout[Any],
    diodes: int,
    rhythm: Rhythm,
    target: Target,
    *,
    closed: bool,
) -> str:
    """
    Return the text of a flight.

    Parameters
    ----------
    names : sequence of str
        Effects of the kernel, in registry order.
    craft : Layout
        Of `flight.Craft`.
    diodes : int
        In the ring.
    rhythm : Rhythm
        When what is due.
    target : Target
        `CPU` or `GPU`.
    closed : bool
        Whether the drone decides; otherwise it keeps `Craft.duties`.

    """
    extract = Extract()
    for core in CORES:
        extract.add(core, PREFIX)
    extract.add(fit, LIGHT)
    parts = {
        'craft': craft.expression('c'),
        'decide': SENSE if closed else '        pass',
        **_beginning(names),
        **counts(rhythm),
        **heard_by(diodes),
    }
    kinds = {**craft.kinds(), **BEGIN.kinds()}
    return assembled(names, extract, kinds, target, FLY, parts, {'diodes': diodes})
