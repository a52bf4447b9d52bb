"""
The stages of the rotors: a loop over all of them, or lines for each where a form has no arrays.

A loop is a eighth of the text to compile, and one vehicle's rotors go through vector instructions
as well.
"""

from lta_config.compilation.extract import Extract
from lta_model.effects.protocol import ActuatorEffect, no_rotor_rate
from lta_model.state import ACTUATORS
from lta_sim.kernels.layout import Access, Layout, Stage, tuple_of


def obey(layout: Layout, access: Access) -> Stage:
    """Return what the actuators begin with: the commanded duties."""
    if access.loops:
        line = f'{access.item("u", 0, layout, 1)} = {access.item("command", 0, layout, 1)}'
        return Stage((line,), each=True)
    duties = tuple_of(access.item('command', i, layout) for i in range(ACTUATORS))
    return Stage((f'u = {duties}',), (), ('u',))


def _seen(
    name: str, effect: ActuatorEffect, layout: Layout, access: Access, rotor: int = 0
) -> list[str]:
    """Return the lines that take up what an effect has of a rotor: of rotor j in a loop."""
    size, j = len(effect.memory), int(access.loops)
    first, shared = layout.first[name], len(effect.shared)
    each = [first + shared + k * ACTUATORS + rotor for k in range(len(effect.each))]
    memory = [layout.remembers[name] + rotor * size + k for k in range(size)]
    p = [access.item('parameters', first + k, layout) for k in range(shared)]
    p += [access.item('parameters', place, layout, j) for place in each]
    m = [access.item('state', place, layout, j * size) for place in memory]
    return [f'p = {tuple_of(p)}', f'm = {tuple_of(m)}']


def actuators(
    name: str, effect: ActuatorEffect, layout: Layout, access: Access, extract: Extract
) -> Stage:
    """Return the stage of an actuator effect: all rotors."""
    output = extract.add(effect.output, name)
    rate = '' if effect.rate is no_rotor_rate else extract.add(effect.rate, name)
    around = access.whole('surroundings', layout)
    size, first = len(effect.memory), layout.remembers[name]
    if access.loops:
        u = access.item('u', 0, layout, 1)
        lines = [*_seen(name, effect, layout, access), f'duty = {u}']
        if rate:
            lines.append(f'R = {rate}(p, m, duty, {around})')
            lines += [
                f'{access.item("rate", first + k, layout, size)} = R[{k}]' for k in range(size)
            ]
        lines.append(f'{u} = {output}(p, m, duty, {around})')
        return Stage(tuple(lines), effect=name, each=True)
    lines, rates = [], []
    for i in range(ACTUATORS):
        lines += _seen(name, effect, layout, access, i)
        if rate:
            lines.append(f'r_{i} = {rate}(p, m, u[{i}], {around})')
            rates += [f'r_{i}[{k}]' for k in range(size)]
        lines.append(f'u_{i} = {output}(p, m, u[{i}], {around})')
    if rate:
        lines.append(f'R_{name} = {tuple_of(rates)}')
    lines.append(f'u = {tuple_of(f"u_{i}" for i in range(ACTUATORS))}')
    return Stage(tuple(lines), ('u',), ('u',), name)
