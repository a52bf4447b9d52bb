"""
How the text of a flight is put together: the model, its cores, and what calls them.

What every such text has: the thrusts and rates of its effects, the steps of the integrator, when
what is due, what each diode hears. `text` and `lta_studies.mission.leg_codegen` say what flies.
"""

from collections.abc import Mapping, Sequence
from string import Template
from typing import Any

from lta_config.compilation.extract import SourceExtract
from lta_config.compilation.flat import PREFIX
from lta_flight.batch.kernel_access import VehicleAccess
from lta_flight.batch.targets import BatchRhythm, CompileTarget, STEP
from lta_model.effects import EFFECTS
from lta_sim.kernels.compose import KernelForm, write_kernel_source
from lta_sim.kernels.gpu import STATES
from lta_sim.kernels.layout import format_tuple, indent_lines

LIGHT = 'light'  # before the names of the fit, which has constants of its own

MODEL = Template(
    f'''{STATES}

$INLINE
def rates(state, fixed, command, surroundings):
    """Return d/dt of the state."""
$bare
    return $rate


$INLINE
def thrusts_of(state, fixed, command, surroundings):
    """Return the thrust of each rotor."""
$actuation
    return u
'''
)

# Classical Runge-Kutta steps until what is aboard is due again, with the range finder's rhythm.
STEPS = """\
        for _ in range($substeps):
            a = rates(state, fixed, command, surroundings)
            there = ahead(state, a, 0.5 * $dt)
            b = rates(there, fixed, command, surroundings)
            there = ahead(state, b, 0.5 * $dt)
            d = rates(there, fixed, command, surroundings)
            there = ahead(state, d, $dt)
            e = rates(there, fixed, command, surroundings)
            state = normalised(ahead(state, mean(a, b, d, e), $dt))
            ticks += 1
            if ticks % $ranges == 0:
                distance = core_sample_range(
                    craft.sensors, errors, seed, ticks // $ranges, state
                )"""


def build_surroundings(names: Sequence[str]) -> str:
    """Return the lines that keep up what some effect looks at."""
    lines = ['pass']
    if 'turbulence' in names:
        lines.append('noise = core_draw_white_noise(seed, step, $period)')
    if 'superheat' in names:
        lines.append('warmth = core_hull_irradiance(craft, state)')
    return indent_lines(lines, 2)


def format_rhythm(rhythm: BatchRhythm) -> dict[str, str]:
    """Return the source of when what is due."""
    return {
        'dt': repr(STEP),
        'period': repr(STEP * rhythm.control),
        'substeps': str(rhythm.control),
        'ranges': str(rhythm.range),
        'pressure': str(rhythm.pressure),
        'light': str(rhythm.light),
        'middle': str(rhythm.light // 2),
    }


def format_light_reading(diodes: int) -> dict[str, str]:
    """Return the source of what each diode hears."""
    lines = [
        f'a_{k}, s_{k} = core_sample_magnitude(craft.listening, {k}, lights, seed, step)'
        for k in range(diodes)
    ]
    lines.insert(0, 'core_write_ring_light(craft.listening, position, q, lights, pencils)')
    return {
        'heard': indent_lines(lines, 3),
        'amplitudes': format_tuple(f'a_{k}' for k in range(diodes)),
        'snrs': format_tuple(f's_{k}' for k in range(diodes)),
        'errors': format_tuple(f'core_amplitude_error(a_{k}, s_{k})' for k in range(diodes)),
    }


def assemble_source(
    names: Sequence[str],
    extract: SourceExtract,
    kinds: Mapping[str, tuple[str, ...]],
    target: CompileTarget,
    glue: Template,
    parts: Mapping[str, str],
    entry: Mapping[str, Any],
) -> str:
    """
    Return a text put together from the model, its cores and what calls them.

    Parameters
    ----------
    names : sequence of str
        Effects of the kernel, in registry order.
    extract : Extract
        The cores.
    kinds : mapping
        Fields of each named tuple that the glue makes.
    target : Target
        What it is compiled for.
    glue : Template
        What calls the cores.
    parts : mapping of str to str
        What `glue` names, but for the decorator.
    entry : mapping
        What the entry of `target` names.

    """
    form = KernelForm(target.imports, target.inline, '', VehicleAccess(), MODEL)
    model = write_kernel_source({name: EFFECTS[name] for name in names}, form)
    cores = extract.render(target.inline)
    missing = [
        f'{PREFIX}_{kind} = namedtuple({kind!r}, {fields!r})'
        for kind, fields in kinds.items()
        if f'{PREFIX}_{kind} = ' not in cores
    ]
    parts = {'INLINE': target.inline, 'steps': STEPS, **parts}
    # Twice: what decides, and the steps, have names of their own.
    text = Template(glue.safe_substitute(parts)).substitute(parts)
    call = Template(target.entry).substitute(entry)
    return '\n\n\n'.join((model, '\n'.join(missing), cores, text, call))
