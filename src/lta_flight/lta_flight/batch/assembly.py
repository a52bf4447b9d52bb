"""
Assemble the source of a batch flight from the model, the cores and the loop around them.

All such sources share the effects' thrusts and rates, the integration steps, the schedule of
sensors and control, and the light reading. `codegen` and `lta_studies.mission.leg_codegen` add the
loop.
"""

from collections.abc import Mapping, Sequence
from string import Template
from typing import Any

from lta_config.compilation.extract import SourceExtract
from lta_config.compilation.flat import PREFIX
from lta_flight.batch.kernel_access import VehicleAccess
from lta_flight.batch.targets import BatchRhythm, CompileTarget, STEP
from lta_model.effects import EFFECTS
from lta_model.light.ray_bundles import DAY
from lta_sim.kernels.compose import KernelForm, write_kernel_source
from lta_sim.kernels.gpu import STATES
from lta_sim.kernels.layout import format_tuple, indent_lines

LIGHT = 'light'  # prefix of the fit's names, since its constants differ from the other cores'

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

# Classical Runge-Kutta steps up to the next control step, with samples of the range finder
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
    """Return the lines that update the inputs of turbulence and superheat."""
    # The block must not be empty
    lines = ['pass']
    # Computed only for effects that use it, to save time in every step
    if 'turbulence' in names:
        lines.append('noise = core_draw_white_noise(seed, step, $period)')
    if 'superheat' in names:
        lines.append('warmth = core_hull_irradiance(craft, state)')
    return indent_lines(lines, 2)


def format_rhythm(rhythm: BatchRhythm) -> dict[str, str]:
    """Return the source of the schedule: periods in steps."""
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
    """Return the source of the light reading of each diode; `day` is that of the block before."""
    lines = [
        # One scalar variable per diode, because GPU code has no dynamic arrays
        f'a_{k}, s_{k} = core_sample_magnitude(\n'
        f'    craft.listening, {k}, lights, lights[{DAY}, {k}] - day[{k}], seed, step\n)'
        for k in range(diodes)
    ]
    daylight = format_tuple(f'lights[{DAY}, {k}]' for k in range(diodes))
    lines.insert(0, 'core_write_ring_light(craft.listening, position, q, lights, pencils)')
    return {
        'heard': indent_lines([line for text in lines for line in text.split('\n')], 3),
        'daylight': daylight,
        'dark': format_tuple(['0.0'] * diodes),
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
    Return the source assembled from the model, the cores and the loop.

    Parameters
    ----------
    names : sequence of str
        Effects of the kernel, in registry order.
    extract : SourceExtract
        The cores.
    kinds : mapping
        Fields of each named tuple that the loop creates.
    target : CompileTarget
        CPU or GPU.
    glue : Template
        The loop that calls the cores.
    parts : mapping of str to str
        Values of the placeholders in `glue`, except the decorator.
    entry : mapping
        Values of the placeholders in the entry of `target`.

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
    # Twice, because the inserted parts have placeholders themselves
    text = Template(glue.safe_substitute(parts)).substitute(parts)
    call = Template(target.entry).substitute(entry)
    return '\n\n\n'.join((model, '\n'.join(missing), cores, text, call))
