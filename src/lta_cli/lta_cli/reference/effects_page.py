"""
Render the effects page: `./lta effects --markdown > docs/effects.md`.

A test compares docs/effects.md with this output.
"""

from collections.abc import Iterator
import re

from lta_model.effects import select_built_in_effects
from lta_model.effects.protocol import (
    ActuatorEffect,
    AirEffect,
    BodyEffect,
    Effect,
    EffectParameter,
    InertiaEffect,
    MeasurementEffect,
    WrenchEffect,
)
from lta_model.effects.summary import describe_effect

HEAD = """# Effects

Generated from `lta_model.effects` by `./lta effects --markdown > docs/effects.md`.

The vehicle model is the sum of these effects. Each is one file in
`src/lta_model/lta_model/effects/` with its equations, limitations and sources. A vehicle file
enables an effect under `effects:` by giving a parameter a value other than its null value. With
null values the effect changes nothing, to the last bit. `./lta effects NAME` shows the source of
every bound. `name_1..` means one parameter per rotor.
"""

# Title and description of each kind, in the order in which a command passes through the model.
KINDS: dict[type, tuple[str, str]] = {
    AirEffect: ('Air', 'Wind at the hull. All other effects use the sum of these winds.'),
    ActuatorEffect: (
        'Actuators',
        'How a duty becomes the thrust of a rotor; applied in this order.',
    ),
    WrenchEffect: ('Force and moment', 'Forces and moments on the hull, which are summed.'),
    InertiaEffect: ('Added mass', 'Terms that are added to the mass matrix.'),
    BodyEffect: (
        'Mass and balance',
        'Changes of the mass and the displaced volume; applied before all others.',
    ),
    MeasurementEffect: ('Measurement', 'Errors of sensors, motion tracker and clocks.'),
}


def _format_parameter(parameter: EffectParameter, name: str) -> str:
    """Return a parameter with its unit, null value and bounds."""
    unit = '' if parameter.unit == '1' else f' {parameter.unit}'
    null = f', null {parameter.null:g}' if parameter.null else ''
    return f'`{name}` {parameter.low:g} to {parameter.high:g}{unit}{null}'


def format_parameters(effect: Effect) -> Iterator[str]:
    """Yield the parameters as text, with equal ones of several rotors merged."""
    if isinstance(effect, ActuatorEffect):
        yield from (_format_parameter(known, known.name) for known in effect.shared)
        yield from (
            f'{_format_parameter(known, known.name)} (each rotor)' for known in effect.each
        )
        return
    # Parameters with equal unit and bounds share one entry
    groups: dict[tuple[object, ...], list[str]] = {}
    for known in effect.parameters:
        # 'thrust_1' to 'thrust_8' become 'thrust_1..'
        stem = re.sub(r'_\d+$', '_1..', known.name)
        key = (known.unit, known.null, known.low, known.high)
        names = groups.setdefault(key, [])
        if stem not in names:
            names.append(stem)
    for (unit, null, low, high), names in groups.items():
        like = EffectParameter('', str(unit), float(null), float(low), float(high), 1.0, '')  # type: ignore[arg-type]
        yield _format_parameter(like, '`, `'.join(names))


def render_page() -> str:
    """Return the page with a table for each kind; effects of plug-ins are left out."""
    texts = [HEAD]
    for kind, (title, about) in KINDS.items():
        rows = [
            f'| `{name}` | {describe_effect(effect)} | {"; ".join(format_parameters(effect))} |\n'
            for name, effect in select_built_in_effects().items()
            if type(effect) is kind
        ]
        table = '| effect | description | parameters |\n|---|---|---|\n' + ''.join(rows)
        texts.append(f'\n## {title}\n{about}\n\n{table}')
    return ''.join(texts)
