"""
Render the effects page: `make reference`.

A test compares docs/effects.md with this output.
"""

from collections.abc import Iterator
import re

from lta_cli.verbs.effects import KINDS
from lta_config.schema.vehicle_law import FORMS, HIDDEN, HIDDEN_RATE, QUANTITIES
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

LAW = """
## A law without a name
What no effect of the library describes, a vehicle file can hold as a law: a sum of products of
measured quantities in its block `law`. It flies like an effect, as a force or moment about the
hull centre. `lta vehicle show` prints it as a formula, and `lta effects new NAME --from RUN`
writes a skeleton of an effect that computes the same, to be turned into the equations of the cause
(unless its hidden state depends on the thrust). [`lta discover`](discovery.md) names such a force
by what it follows, and leaves the law to you.

```yaml
law:
  source: fitted to runs/a, runs/b
  terms:
  - axis: yaw                                 # surge sway heave roll pitch yaw, map_x map_y map_z
    coefficient: -3.1e-4
    unit: N s2                                # follows from axis and factors; angles have none
    interval: [-3.5e-4, -2.7e-4]              # 95 %; may be left out, as the evidence in nats
    evidence: 12.5
    factors:                                  # at most 3, of at most 6 terms
    - {quantity: speed}
    - {quantity: r, form: power, exponent: 1.0}
  region:                                     # of every quantity: lowest and highest value
    speed: [0.0, 0.6]
    r: [-1.0, 1.0]
```

Numbers are in SI. Within the region the law applies in full. Outside of a range it falls smoothly
to zero over half of the width of the range, on each side. Forces along `map_x`, `map_y`, `map_z`
have the directions of the map. A hidden state follows a product of factors, its
drive, from `start` (0 by default) when a flight begins, with a lag of first order
(`time_constant`) or second order (`frequency` in rad/s, `damping`):

```yaml
  hidden:
    drive: [{quantity: thrust_surge, form: modulus}]
    time_constant: 3.0
```

`u`, `v`, `w` and `speed` are relative to the air; `p`, `q`, `r` are body rates, and `rate` is
their modulus; `x`, `y`, `height` are those of the hull centre. `thrust_1..` are the thrusts of the
rotors in the order of the file, `thrust_surge..` their sum along the axes of the rotors, and its
moment. Duties are not available, since a replay knows only thrusts.
"""
# Of quantities whose unit depends on the law
LAG_UNITS = {HIDDEN: 'of its drive', HIDDEN_RATE: 'of its drive, per s'}


# Title and description of each kind, in the order in which a command passes through the model.
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


def render_law() -> str:
    """Return the section on laws, with the tables of quantities and forms."""
    names: dict[str, list[str]] = {}
    for name, unit in QUANTITIES.items():
        names.setdefault(LAG_UNITS.get(name, unit), []).append(f'`{name}`')
    quantities = ''.join(f'| {", ".join(each)} | {unit} |\n' for unit, each in names.items())
    forms = ''.join(
        f'| `{name}` | {equation.replace("|", chr(92) + "|")} | {", ".join(needed)} '
        f'| {", ".join(optional)} |\n'
        for name, (equation, needed, optional) in FORMS.items()
    )
    return (
        f'{LAW}\n| quantity | unit |\n|---|---|\n{quantities}\n'
        f'| form | of a quantity x | needs | may have |\n|---|---|---|---|\n{forms}'
    )


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
    return ''.join([*texts, render_law()])
