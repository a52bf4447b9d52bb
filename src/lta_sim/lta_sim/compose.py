"""
Write the source of one kernel that is the sum of all effects.

The text holds the effects' own functions (`extract`), the rigid body's, and the glue below that
knows where in the parameter vector and in the state each effect lives. All effects are always in
it: one that is at its null values costs a look at its flag, and switching it on is a number, not a
compilation.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from string import Template
from typing import final

from lta_sim import rigid_body
from lta_sim.effects.protocol import Effect, KernelEffect
from lta_sim.extract import Extract
from lta_sim.stages import Access, indented, Layout, LOCAL, OWN, Stage, stages, tuple_of
from lta_sim.state import COMMAND, SURROUNDINGS

HEAD = '''"""
The model of a vehicle, written by lta_sim.compose from the effects; edits here are lost.

A state is a tuple: position, quaternion, velocity, rates, memory of the effects.
"""

from collections import namedtuple
import math

'''

# Nothing is reordered and a division by zero gives inf: all forms of the model agree to the bit.
INLINE = f'@njit({OWN})'
ENTRY = "@njit(error_model='numpy', fastmath=False, cache=True)"


@final
@dataclass(frozen=True, slots=True)
class Form:
    """
    What the model is compiled for.

    Parameters
    ----------
    imports : str
        What the text needs beside `math` and `namedtuple`.
    inline, entry : str
        Decorators of the model's own functions and of those that are called from outside.
    access : Access
        How the numbers of a vehicle are reached.
    entries : Template
        The functions that know the form; `kernel_source` fills in the layout.

    """

    imports: str
    inline: str
    entry: str
    access: Access
    entries: Template


# Functions of whole states; extracted functions go before them.
STEP = Template('''
$INLINE
def ahead(state, rate, dt):
    """Return the state after dt at a constant rate."""
    return $ahead


$INLINE
def mean(a, b, c, d):
    """Return the mean rate of the classical Runge-Kutta step."""
    return $mean


$INLINE
def normalised(state):
    """Return the state with a quaternion of length one."""
    x, y, z, w = state[3:7]
    n = 1.0 / math.sqrt(x * x + y * y + z * z + w * w)
    return state[0:3] + (x * n, y * n, z * n, w * n) + state[7:]
''')

# One vehicle, from arrays to arrays.
SCALAR = Form(
    'from numba import njit\n',
    INLINE,
    ENTRY,
    LOCAL,
    Template('''
$INLINE
def rates(state, parameters, on, body, inverse, command, surroundings):
    """Return d/dt of the state."""
$rates
    return $rate


$ENTRY
def derivative(start, parameters, on, body, inverse, orders, air, out):
    """Write d/dt of the state into out."""
$edge
    rate = rates(state, parameters, on, body, inverse, command, surroundings)
    for i in range($size):
        out[i] = rate[i]


$ENTRY
def advance(start, parameters, on, body, inverse, orders, air, dt, steps, out):
    """Write the state after `steps` steps of dt into out."""
$edge
    for _ in range(steps):
        a = rates(state, parameters, on, body, inverse, command, surroundings)
        s = ahead(state, a, 0.5 * dt)
        b = rates(s, parameters, on, body, inverse, command, surroundings)
        s = ahead(state, b, 0.5 * dt)
        c = rates(s, parameters, on, body, inverse, command, surroundings)
        s = ahead(state, c, dt)
        d = rates(s, parameters, on, body, inverse, command, surroundings)
        state = normalised(ahead(state, mean(a, b, c, d), dt))
    for i in range($size):
        out[i] = state[i]


$ENTRY
def look(start, parameters, on, body, orders, air, out, thrusts, breeze):
    """Write the wrench of each wrench effect, the thrusts and the wind at the hull."""
$edge
$looks
    for i in range(len(u)):
        thrusts[i] = u[i]
    for i in range(3):
        breeze[i] = wind[i]
'''),
)


def _guarded(stage: Stage, layout: Layout) -> list[str]:
    """Return the lines of a stage, behind the flag of its effect if it has one."""
    if not stage.effect:
        return list(stage.lines)
    place = layout.flag(stage.effect)
    off = [f'{name} = {value}' for name, value in stage.otherwise]
    return [*off, f'if on[{place}]:', *(f'    {line}' for line in stage.lines)]


def straight(parts: list[Stage], layout: Layout, *, guarded: bool = True) -> str:
    """Return all stages one after the other, for one vehicle in local variables."""
    lines: list[str] = []
    for stage in parts:
        lines += _guarded(stage, layout) if guarded else list(stage.lines)
    return indented(lines)


def _looks(parts: list[Stage], layout: Layout) -> str:
    """Return the stages up to the wrenches, each of which is stored in a row of out."""
    lines: list[str] = []
    row = 0
    for stage in parts[:-1]:
        lines += _guarded(stage, layout)
        if stage.effect in layout.wrenches:
            lines += [f'for i in range(6): out[{row}, i] = W_{stage.effect}[i]']
            row += 1
    return indented(lines)


def layout_of(effects: Mapping[str, Effect]) -> Layout:
    """Return where everything of these effects is."""
    return Layout({n: e for n, e in effects.items() if isinstance(e, KernelEffect)})


def _texts(layout: Layout, form: Form, extract: Extract) -> dict[str, str]:
    """Return the parts of the text that know the layout."""
    for function in rigid_body.TAKEN:
        extract.add(function, 'rigid_body')
    parts = stages(layout, form.access, extract)
    state = range(layout.size)
    edge = [
        f'state = {tuple_of(f"start[{i}]" for i in state)}',
        f'command = {tuple_of(f"orders[{i}]" for i in range(COMMAND))}',
        f'surroundings = {tuple_of(f"air[{i}]" for i in range(SURROUNDINGS))}',
    ]
    return {
        'size': str(layout.size),
        'ahead': tuple_of(f'state[{i}] + dt * rate[{i}]' for i in state),
        'mean': tuple_of(f'(a[{i}] + 2.0 * (b[{i}] + c[{i}]) + d[{i}]) / 6.0' for i in state),
        'edge': indented(edge),
        'rates': straight(parts, layout),
        'bare': straight(parts, layout, guarded=False),
        'rate': layout.rate,
        'looks': _looks(parts, layout),
        **form.access.texts(parts, layout),
    }


def kernel_source(effects: Mapping[str, Effect], form: Form = SCALAR) -> str:
    """
    Return the kernel of these effects as Python source.

    Parameters
    ----------
    effects : mapping of str to Effect
        Their order is the layout of the parameter vector and of the memory; those that act
        outside the kernel are passed over.
    form : Form
        What it is compiled for; by default one vehicle, with `derivative`, `advance` and `look`.

    Returns
    -------
    str
        A module that needs only numba.

    """
    extract = Extract()
    layout = layout_of(effects)
    texts = {'INLINE': form.inline, 'ENTRY': form.entry, **_texts(layout, form, extract)}
    glue = STEP.substitute(texts) + '\n' + form.entries.substitute(texts)
    return f'{HEAD}{form.imports}\n\n{extract.text(form.inline)}\n\n{glue}'
