"""
Write the source of one kernel that is the sum of all effects.

The text holds the effects' own functions (`extract`), the rigid body's, and the glue below that
knows where in the parameter vector and in the state each effect lives. All effects are always in
it: one that is at its null value costs a few multiplications, and switching it on is a number, not
a compilation.
"""

from collections.abc import Iterator, Mapping

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

from numba import njit
'''

# Nothing is reordered and a division by zero gives inf: all forms of the model agree to the bit.
INLINE = "@njit(error_model='numpy', fastmath=False)"
ENTRY = "@njit(error_model='numpy', fastmath=False, cache=True)"


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


def _glue(effects: Mapping[str, Effect], extract: Extract) -> str:
    """Write the functions that know the layout."""
    memory = _memory(effects)
    size = RIGID + len(memory)
    actuators = '\n'.join(_actuators(effects, extract))
    wrenches = dict(_wrenches(effects, extract))
    calls = '\n'.join(f'    W_{name} = {call}' for name, call in wrenches.items())
    total = _tuple(
        [' + '.join(['0.0', *(f'W_{name}[{i}]' for name in wrenches)]) for i in range(6)]
    )
    store = '\n'.join(
        f'    for i in range(6):\n        out[{row}, i] = W_{name}[i]'
        for row, name in enumerate(wrenches)
    )
    edge = f"""
    state = {_items('start', 0, size)}
    duty, wind = {_items('command', 0, ACTUATORS)}, {_items('air', 0, 3)}
""".strip('\n')
    body = {
        name: extract.add(getattr(rigid_body, name), 'rigid_body')
        for name in ('motion', 'quaternion_rate', 'acceleration', 'to_map')
    }
    see = f"""
    q = (state[3], state[4], state[5], state[6])
    v = (state[7], state[8], state[9])
    w = (state[10], state[11], state[12])
    motion = {body['motion']}((state[0], state[1], state[2]), q, v, w, wind)
""".strip('\n')
    derivative = _items('f', 0, 3)[:-1] + ' ' + _items('g', 0, 4)[1:-1]
    derivative += ' ' + _items('a', 0, 6)[1:-1] + ' ' + _tuple(memory)[1:]
    return f'''
{INLINE}
def rates(state, parameters, body, inverse, duty, wind):
    """Return d/dt of the state."""
{see}
{actuators}
{calls}
    total = {total}
    air = (v[0] - motion.airspeed[0], v[1] - motion.airspeed[1], v[2] - motion.airspeed[2])
    f = {body['to_map']}(motion.rotation, v)
    g = {body['quaternion_rate']}(q, w)
    a = {body['acceleration']}(total, motion, air, body, inverse)
    return {derivative}


{INLINE}
def ahead(state, rate, dt):
    """Return the state after dt at a constant rate."""
    return {_tuple([f'state[{i}] + dt * rate[{i}]' for i in range(size)])}


{INLINE}
def mean(a, b, c, d):
    """Return the mean rate of the classical Runge-Kutta step."""
    return {_tuple([f'(a[{i}] + 2.0 * (b[{i}] + c[{i}]) + d[{i}]) / 6.0' for i in range(size)])}


{INLINE}
def normalised(state):
    """Return the state with a quaternion of length one."""
    x, y, z, w = {_items('state', 3, 4)}
    n = 1.0 / math.sqrt(x * x + y * y + z * z + w * w)
    return {_tuple([f'state[{i}] * n' if 3 <= i < 7 else f'state[{i}]' for i in range(size)])}


{ENTRY}
def derivative(start, parameters, body, inverse, command, air, out):
    """Write d/dt of the state into out."""
{edge}
    rate = rates(state, parameters, body, inverse, duty, wind)
    for i in range({size}):
        out[i] = rate[i]


{ENTRY}
def advance(start, parameters, body, inverse, command, air, dt, steps, out):
    """Write the state after `steps` steps of dt into out."""
{edge}
    for _ in range(steps):
        a = rates(state, parameters, body, inverse, duty, wind)
        b = rates(ahead(state, a, 0.5 * dt), parameters, body, inverse, duty, wind)
        c = rates(ahead(state, b, 0.5 * dt), parameters, body, inverse, duty, wind)
        d = rates(ahead(state, c, dt), parameters, body, inverse, duty, wind)
        state = normalised(ahead(state, mean(a, b, c, d), dt))
    for i in range({size}):
        out[i] = state[i]


{ENTRY}
def wrenches(start, parameters, command, air, out):
    """Write the wrench of each wrench effect into a row of out."""
{edge}
{see}
{actuators}
{calls}
{store}
'''


def kernel_source(effects: Mapping[str, Effect]) -> str:
    """
    Return the kernel of these effects as Python source.

    Parameters
    ----------
    effects : mapping of str to Effect
        Their order is the layout of the parameter vector and of the memory.

    Returns
    -------
    str
        A module with `derivative`, `advance` and `wrenches`, that needs only numba.

    """
    extract = Extract()
    glue = _glue(effects, extract)
    return f'{HEAD}\n\n{extract.text(INLINE)}\n\n{glue}'
