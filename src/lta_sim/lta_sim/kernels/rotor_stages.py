"""
Generate the stages of the rotors: a loop, or unrolled lines for targets without arrays.

A loop needs an eighth of the source to compile, and the compiler vectorises it over one vehicle's
rotors.
"""

from lta_config.compilation.extract import SourceExtract
from lta_model.effects.protocol import ActuatorEffect, no_rotor_rate
from lta_model.state import ACTUATORS
from lta_sim.kernels.layout import EffectLayout, format_tuple, KernelAccess, ModelStage


def is_straight(name: str, extract: SourceExtract) -> bool:
    """Return whether the functions of an effect have no loop and call nothing but sqrt."""
    # What the compiler cannot vectorise would keep it from vectorising its neighbours
    return not extract.is_in_pieces(name, r'^ *(for|while) |math\.(?!sqrt|pi)')


def build_command_stage(layout: EffectLayout, access: KernelAccess) -> ModelStage:
    """Return the first actuator stage: the commanded duties."""
    if access.loops:
        line = (
            f'{access.format_number("u", 0, layout, 1)} = '
            f'{access.format_number("command", 0, layout, 1)}'
        )
        return ModelStage((line,), each=True, joins=True)
    duties = format_tuple(access.format_number('command', i, layout) for i in range(ACTUATORS))
    return ModelStage((f'u = {duties}',), (), ('u',))


def _format_rotor_inputs(
    name: str, effect: ActuatorEffect, layout: EffectLayout, access: KernelAccess, rotor: int = 0
) -> list[str]:
    """Return the lines that load an effect's inputs of one rotor: of rotor j in a loop."""
    size, j = len(effect.memory), int(access.loops)
    # Parameter layout: shared ones first, then each per-rotor parameter for all rotors
    first, shared = layout.first[name], len(effect.shared)
    each = [first + shared + k * ACTUATORS + rotor for k in range(len(effect.each))]
    memory = [layout.remembers[name] + rotor * size + k for k in range(size)]
    p = [access.format_number('parameters', first + k, layout) for k in range(shared)]
    p += [access.format_number('parameters', place, layout, j) for place in each]
    m = [access.format_number('state', place, layout, j * size) for place in memory]
    return [f'p = {format_tuple(p)}', f'm = {format_tuple(m)}']


def build_actuator_stage(
    name: str,
    effect: ActuatorEffect,
    layout: EffectLayout,
    access: KernelAccess,
    extract: SourceExtract,
) -> ModelStage:
    """Return the stage of an actuator effect for all rotors."""
    output = extract.add_function(effect.output, name)
    rate = '' if effect.rate is no_rotor_rate else extract.add_function(effect.rate, name)
    around = access.format_all_numbers('surroundings', layout)
    size, first = len(effect.memory), layout.remembers[name]
    if access.loops:
        u = access.format_number('u', 0, layout, 1)
        lines = [*_format_rotor_inputs(name, effect, layout, access), f'duty = {u}']
        if rate:
            lines.append(f'R = {rate}(p, m, duty, {around})')
            lines += [
                f'{access.format_number("rate", first + k, layout, size)} = R[{k}]'
                for k in range(size)
            ]
        lines.append(f'{u} = {output}(p, m, duty, {around})')
        joins = is_straight(name, extract)
        return ModelStage(tuple(lines), effect=name, each=True, joins=joins)
    lines, rates = [], []
    for i in range(ACTUATORS):
        lines += _format_rotor_inputs(name, effect, layout, access, i)
        if rate:
            lines.append(f'r_{i} = {rate}(p, m, u[{i}], {around})')
            rates += [f'r_{i}[{k}]' for k in range(size)]
        lines.append(f'u_{i} = {output}(p, m, u[{i}], {around})')
    if rate:
        lines.append(f'R_{name} = {format_tuple(rates)}')
    lines.append(f'u = {format_tuple(f"u_{i}" for i in range(ACTUATORS))}')
    return ModelStage(tuple(lines), ('u',), ('u',), name)
