# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Render the effects page: `make reference`.

A test compares docs/effects.md with this output.
"""

from collections.abc import Iterator
import re

from lta_analysis.model_effects import EFFECT_KINDS
from lta_model.effects import select_built_in_effects
from lta_model.effects.protocol import (
    ActuatorEffect,
    describe_effect,
    Effect,
    EffectParameter,
)

HEAD = """# Effects

Generated from `lta_model.effects` by `make reference`.

The vehicle model is the sum of these effects. Each is a function in
`src/lta_model/lta_model/effects/` whose docstring has its equations, limitations and sources. A
vehicle file enables an effect under `effects:` by giving a parameter a value other than its null
value, which is 0 unless the table says otherwise. With null values the effect changes nothing, to
the last bit. `./lta effects NAME` shows the bounds and their source. `name_1..` means one
parameter per rotor.
"""


def _format_parameter(parameter: EffectParameter, name: str) -> str:
    """Return a parameter with its unit, and its null value if that is not 0."""
    unit = '' if parameter.unit == '1' else f' [{parameter.unit}]'
    null = f', null {parameter.null:g}' if parameter.null else ''
    return f'`{name}`{unit}{null}'


def format_parameters(effect: Effect) -> Iterator[str]:
    """Yield the parameters as text, with equal ones of several rotors merged."""
    if isinstance(effect, ActuatorEffect):
        yield from (_format_parameter(parameter, parameter.name) for parameter in effect.shared)
        yield from (
            f'{_format_parameter(parameter, parameter.name)} (each rotor)'
            for parameter in effect.each
        )
        return
    # Parameters with equal unit and null value share one entry
    groups: dict[tuple[str, float], list[str]] = {}
    for parameter in effect.parameters:
        # 'thrust_1' to 'thrust_8' become 'thrust_1..'
        stem = re.sub(r'_\d+$', '_1..', parameter.name)
        key = (parameter.unit, parameter.null)
        names = groups.setdefault(key, [])
        if stem not in names:
            names.append(stem)
    for (unit, null), names in groups.items():
        like = EffectParameter('', unit, null, null, null, 1.0, '')
        yield _format_parameter(like, '`, `'.join(names))


def render_page() -> str:
    """Return the page with a table for each kind; effects of plug-ins are left out."""
    texts = [HEAD]
    for kind, (title, about) in EFFECT_KINDS.items():
        rows = [
            f'| `{name}` | {describe_effect(effect)} | {"; ".join(format_parameters(effect))} |\n'
            for name, effect in select_built_in_effects().items()
            if type(effect) is kind
        ]
        table = '| effect | description | parameters |\n|---|---|---|\n' + ''.join(rows)
        texts.append(f'\n## {title}\n{about}\n\n{table}')
    return ''.join(texts)
