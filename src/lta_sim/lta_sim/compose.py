"""
Write the source of one kernel that is the sum of all effects.

The text holds the effects' own functions (`extract`), the rigid body's, and the glue below that
knows where in the parameter vector and in the state each effect lives. All effects are always in
it: one that is at its null value costs a few multiplications, and switching it on is a number, not
a compilation.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from string import Template
from typing import final

from lta_sim import rigid_body
from lta_sim.effects.protocol import ActuatorEffect, Effect, WrenchEffect
from lta_sim.extract import Extract
from lta_sim.state import ACTUATORS, RIGID

HEAD = '''"""
The model of a vehicle, written by lta_sim.compose from the effects; edits here are lost.

A state is a tuple: position, quaternion, velocity, rates, memory of the effects.
"""

from collections import namedtuple
import math

'''

# Nothing is reordered and a division by zero gives inf: all forms of the model agree to the bit.
INLINE = "@njit(error_model='numpy', fastmath=False)"
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
    entries : Template
        The functions that are called from outside; `kernel_source` fills in the layout.

    """

    imports: str
    inline: str
    entry: str
    entries: Template


# The functions that know the layout; extracted functions go before them.
MODEL = Template('''
$INLINE
def rates(state, parameters, body, inverse, duty, wind):
    """Return d/dt of the state."""
$see
$actuators
$calls
    total = $total
    air = (v[0] - motion.airspeed[0], v[1] - motion.airspeed[1], v[2] - motion.airspeed[2])
    f = rigid_body_to_map(motion.rotation, v)
    g = rigid_body_quaternion_rate(q, w)
    a = rigid_body_acceleration(total, motion, air, body, inverse)
    return (*f, *g, *a, *$memory)


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
    return (*state[0:3], x * n, y * n, z * n, w * n, *state[7:])
''')

# One vehicle, from arrays to arrays.
SCALAR = Form(
    'from numba import njit\n',
    INLINE,
    ENTRY,
    Template('''
$ENTRY
def derivative(start, parameters, body, inverse, command, air, out):
    """Write d/dt of the state into out."""
$edge
    rate = rates(state, parameters, body, inverse, duty, wind)
    for i in range($size):
        out[i] = rate[i]


$ENTRY
def advance(start, parameters, body, inverse, command, air, dt, steps, out):
    """Write the state after `steps` steps of dt into out."""
$edge
    for _ in range(steps):
        a = rates(state, parameters, body, inverse, duty, wind)
        b = rates(ahead(state, a, 0.5 * dt), parameters, body, inverse, duty, wind)
        c = rates(ahead(state, b, 0.5 * dt), parameters, body, inverse, duty, wind)
        d = rates(ahead(state, c, dt), parameters, body, inverse, duty, wind)
        state = normalised(ahead(state, mean(a, b, c, d), dt))
    for i in range($size):
        out[i] = state[i]


$ENTRY
def wrenches(start, parameters, command, air, out):
    """Write the wrench of each wrench effect into a row of out."""
$edge
$see
$actuators
$calls
$store
'''),
)

# A vehicle is column i of a block: number k of it is at k * width + i, neighbours side by side.
COLUMNS = Template('''
$INLINE
def fixed_of(block, width, i):
    """Return what vehicle i keeps: its parameters, body, inverse, duty and wind."""
$fixed
    return parameters, body, inverse, duty, wind


$INLINE
def state_of(block, width, i):
    """Return the state of vehicle i, or what else has its length."""
    return $state


$INLINE
def put(block, width, i, state):
    """Store the state of vehicle i."""
$put
''')

# What each vehicle keeps in a block after its parameters: how many numbers of each.
FIXED = {'body': 16, 'inverse': 36, 'duty': ACTUATORS, 'wind': 3}

SEE = """
    q, v, w = state[3:7], state[7:10], state[10:13]
    motion = rigid_body_motion(state[0:3], q, v, w, wind)
""".strip('\n')


def _tuple(items: Iterator[str] | list[str]) -> str:
    """Return the source of a tuple of any length."""
    return '(' + ''.join(f'{item}, ' for item in items).rstrip() + ')'


def _items(name: str, first: int, count: int) -> str:
    """Return the source of the tuple of `count` items of `name` from `first` on."""
    return _tuple([f'{name}[{i}]' for i in range(first, first + count)])


def _actuators(effects: Mapping[str, Effect], extract: Extract) -> Iterator[str]:
    """Write the way of the duty through the actuator effects, and the rate of their memory."""
    yield '    u = duty'
    place, first = RIGID, 0
    for name, effect in effects.items():
        count = len(effect.parameters)
        if isinstance(effect, ActuatorEffect):
            output, size = extract.add(effect.output, name), len(effect.memory)
            rate = extract.add(effect.rate, name)
            yield f'    p = {_items("parameters", first, count)}'
            for i in range(ACTUATORS):
                yield f'    m_{i} = {_items("state", place + i * size, size)}'
                yield f'    R_{name}_{i} = {rate}(p, m_{i}, u[{i}])'
            outputs = [f'{output}(p, m_{i}, u[{i}])' for i in range(ACTUATORS)]
            yield f'    u = {_tuple(outputs)}'
            place += ACTUATORS * size
        first += count


def _wrenches(effects: Mapping[str, Effect], extract: Extract) -> Iterator[tuple[str, str]]:
    """Write the call of each wrench effect, by name."""
    first = 0
    for name, effect in effects.items():
        count = len(effect.parameters)
        if isinstance(effect, WrenchEffect):
            function = extract.add(effect.wrench, name)
            yield name, f'{function}({_items("parameters", first, count)}, motion, u)'
        first += count


def _memory(effects: Mapping[str, Effect]) -> list[str]:
    """Write the rate of each state of the memory."""
    return [
        f'R_{name}_{i}[{k}]'
        for name, effect in effects.items()
        if isinstance(effect, ActuatorEffect)
        for i in range(ACTUATORS)
        for k in range(len(effect.memory))
    ]


def _sum(names: list[str]) -> str:
    """Write the sum of wrenches."""
    return _tuple([' + '.join(['0.0', *(f'W_{name}[{i}]' for name in names)]) for i in range(6)])


def _column(first: int, count: int) -> str:
    """Return the source of the tuple of some numbers of a vehicle in a block."""
    return _tuple([f'block[{k} * width + i]' for k in range(first, first + count)])


def _fixed(counts: Mapping[str, int]) -> Iterator[str]:
    """Write what a vehicle keeps, in the order of FIXED."""
    first = 0
    for name, count in counts.items():
        yield f'    {name} = {_column(first, count)}'
        first += count


def _layout(effects: Mapping[str, Effect], extract: Extract) -> dict[str, str]:
    """Write the parts of the text that know the layout."""
    for function in rigid_body.motion, rigid_body.to_map, rigid_body.quaternion_rate:
        extract.add(function, 'rigid_body')
    extract.add(rigid_body.acceleration, 'rigid_body')
    memory = _memory(effects)
    state = range(RIGID + len(memory))
    calls = dict(_wrenches(effects, extract))
    parameters = sum(len(effect.parameters) for effect in effects.values())
    return {
        'see': SEE,
        'size': str(len(state)),
        'actuators': '\n'.join(_actuators(effects, extract)),
        'calls': '\n'.join(f'    W_{name} = {call}' for name, call in calls.items()),
        'total': _sum(list(calls)),
        'memory': _tuple(memory),
        'ahead': _tuple([f'state[{i}] + dt * rate[{i}]' for i in state]),
        'mean': _tuple([f'(a[{i}] + 2.0 * (b[{i}] + c[{i}]) + d[{i}]) / 6.0' for i in state]),
        'edge': f'    state = {_items("start", 0, len(state))}\n'
        f'    duty = {_items("command", 0, ACTUATORS)}\n'
        f'    wind = {_items("air", 0, 3)}',
        'store': '\n'.join(
            f'    for i in range(6):\n        out[{row}, i] = W_{name}[i]'
            for row, name in enumerate(calls)
        ),
        'fixed': '\n'.join(_fixed({'parameters': parameters, **FIXED})),
        'state': _column(0, len(state)),
        'put': '\n'.join(f'    block[{k} * width + i] = state[{k}]' for k in state),
    }


def kernel_source(effects: Mapping[str, Effect], form: Form = SCALAR) -> str:
    """
    Return the kernel of these effects as Python source.

    Parameters
    ----------
    effects : mapping of str to Effect
        Their order is the layout of the parameter vector and of the memory.
    form : Form
        What it is compiled for; by default one vehicle, with `derivative`, `advance` and
        `wrenches`.

    Returns
    -------
    str
        A module that needs only numba.

    """
    extract = Extract()
    layout = {'INLINE': form.inline, 'ENTRY': form.entry, **_layout(effects, extract)}
    glue = MODEL.substitute(layout) + '\n' + form.entries.substitute(layout)
    return f'{HEAD}{form.imports}\n\n{extract.text(form.inline)}\n\n{glue}'
