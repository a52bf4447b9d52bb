"""
A force or moment without a name: a sum of products, which a vehicle file holds as data.

    F_i = fade * sum of coefficient * form(quantity) * form(quantity) * ...

on each axis i. `lta_config.schema.vehicle_law` defines quantities, forms, hidden state and region.
The parameters are the numbers of the file's block `law`, as `list_law_parameters` packs them; a
code of 0 is an axis, quantity or state that is absent. Forces act at the hull centre.

`fade` is 1 within the region of the law. Outside of the range [a, b] of a quantity it falls as
1 - 3 s^2 + 2 s^3 to zero, s the distance to the range over (b - a) / 2. The drive of the hidden
state fades by the other quantities only: else a state out of its range would never come back.
"""

import math
from typing import Final

from lta_config.schema.vehicle_law import (
    AXES,
    FACTORS,
    FORMS,
    Law,
    LawFactor,
    PERIOD,
    QUANTITIES,
    REGION,
    TERMS,
)
from lta_model.effects.protocol import EffectParameter, Values, VehicleMotion, Wrench, WrenchEffect
from lta_model.rotor_forces import sum_rotor_forces
from lta_model.state import ROTOR_PLACE, VOLTAGE

_LAW_SOURCE = 'found by discovery, in the block law of the vehicle file'
_FACTOR = ('quantity', 'form', 'first', 'second')
_PARAMETER_NAMES = (
    *(
        f'{name}_{term}'
        for term in range(1, TERMS + 1)
        for name in (
            'axis',
            'coefficient',
            *(f'{part}_{factor}' for factor in range(1, FACTORS + 1) for part in _FACTOR),
        )
    ),
    'order',
    'lag',
    'damping',
    'start',
    *(f'drive_{part}_{factor}' for factor in range(1, FACTORS + 1) for part in _FACTOR),
    *(f'{end}_{k}' for k in range(1, REGION + 1) for end in ('limited', 'low', 'high')),
)
PARAMETERS = tuple(
    EffectParameter(name, '1', 0.0, -1e9, 1e9, 1.0, _LAW_SOURCE) for name in _PARAMETER_NAMES
)

# Places in the parameters
FACTOR = len(_FACTOR)
TERM = 2 + FACTOR * FACTORS
ORDER = TERM * TERMS
START = ORDER + 3
DRIVE = ORDER + 4
RANGES = DRIVE + FACTOR * FACTORS
# Codes of forms and of the heading, which alone is periodic
LINEAR, MODULUS, POWER, POSITIVE, NEGATIVE, ABOVE, SIGN, DECAY, SINE, COSINE = range(len(FORMS))
YAW = list(QUANTITIES).index('yaw')
HIDDEN_INDEX, HIDDEN_RATE_INDEX = (
    list(QUANTITIES).index('hidden'),
    list(QUANTITIES).index('hidden_rate'),
)
LARGEST_EXPONENT = 50.0  # exponent of a decay, which must not overflow far outside of its region
# First number of a form (exponent, threshold or phase) where the file gives none; 0 elsewhere
_DEFAULTS: Final = {'modulus': 1.0}


def list_quantities(memory: Values, motion: VehicleMotion, thrust: Values) -> Values:
    """Return all quantities, in the order of `QUANTITIES`. [SI]"""
    v, w, x, r = motion.airspeed, motion.rates, motion.position, motion.rotation
    state = (
        v[0],
        v[1],
        v[2],
        math.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]),
        w[0],
        w[1],
        w[2],
        math.sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]),
        x[0],
        x[1],
        x[2],
        math.atan2(r[7], r[8]),
        math.atan2(-r[6], math.sqrt(r[7] * r[7] + r[8] * r[8])),
        math.atan2(r[3], r[0]),
        motion.surroundings[VOLTAGE],
        memory[2],
        memory[0],
        memory[1],
    )
    return state + thrust + sum_rotor_forces(motion.body[ROTOR_PLACE:], thrust)


def apply_form(form: int, x: float, first: float, second: float) -> float:
    """Return a form of a quantity; `first` is exponent, threshold or phase, `second` the scale."""
    if form == LINEAR:
        return x
    if form == MODULUS:
        return math.pow(abs(x), first)
    if form == POWER:
        return math.copysign(math.pow(abs(x), first), x)
    if form == POSITIVE:
        return max(x - first, 0.0)
    if form == NEGATIVE:
        return max(first - x, 0.0)
    if form == ABOVE:
        return 0.5 * (1.0 + math.tanh((x - first) / second))
    if form == SIGN:
        return math.tanh(x / second)
    if form == DECAY:
        return math.exp(min(-x / second, LARGEST_EXPONENT))
    angle = 2.0 * math.pi * x / second - first
    return math.sin(angle) if form == SINE else math.cos(angle)


def multiply_factors(p: Values, first: int, values: Values) -> float:
    """Return the product of the factors whose numbers begin at a place; 1 without any."""
    product = 1.0
    for k in range(FACTORS):
        place = first + FACTOR * k
        quantity = int(p[place])
        if quantity > 0:
            product *= apply_form(
                int(p[place + 1]), values[quantity - 1], p[place + 2], p[place + 3]
            )
    return product


def compute_fade(p: Values, values: Values, of_drive: bool) -> float:
    """Return 1 within the region of the law, less outside; `of_drive` without the hidden state."""
    fade = 1.0
    for k in range(REGION):
        place = RANGES + 3 * k
        quantity = int(p[place])
        is_own = quantity - 1 == HIDDEN_INDEX or quantity - 1 == HIDDEN_RATE_INDEX
        if quantity > 0 and not (of_drive and is_own):
            half = 0.5 * (p[place + 2] - p[place + 1])
            off = values[quantity - 1] - 0.5 * (p[place + 2] + p[place + 1])
            if quantity - 1 == YAW:
                off -= 2.0 * math.pi * math.floor(off / (2.0 * math.pi) + 0.5)
            s = min(max(abs(off) / half - 1.0, 0.0), 1.0)
            fade *= 1.0 - s * s * (3.0 - 2.0 * s)
    return fade


def list_law_quantities(
    p: Values, memory: Values, motion: VehicleMotion, thrust: Values
) -> Values:
    """Return all quantities, with the hidden state of a law of these parameters. [SI]"""
    # The memory counts from the start
    hidden = memory[0] + p[START]
    values = list_quantities((hidden, memory[1], memory[2]), motion, thrust)
    if p[ORDER] != 1.0:
        return values
    drive = compute_fade(p, values, True) * multiply_factors(p, DRIVE, values)
    return list_quantities((hidden, (drive - hidden) / p[ORDER + 1], memory[2]), motion, thrust)


def compute_wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Force or moment without a name: a sum of products, which a vehicle file holds as data."""
    values = list_law_quantities(p, memory, motion, thrust)
    fade = compute_fade(p, values, False)
    # Six body axes, then three of the map
    a, b, c, d, e, f, x, y, z = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for term in range(TERMS):
        first = TERM * term
        axis = int(p[first])
        if axis == 0:
            continue
        value = fade * p[first + 1] * multiply_factors(p, first + 2, values)
        a += value if axis == 1 else 0.0
        b += value if axis == 2 else 0.0
        c += value if axis == 3 else 0.0
        d += value if axis == 4 else 0.0
        e += value if axis == 5 else 0.0
        f += value if axis == 6 else 0.0
        x += value if axis == 7 else 0.0
        y += value if axis == 8 else 0.0
        z += value if axis == 9 else 0.0
    r = motion.rotation
    return (
        a + r[0] * x + r[3] * y + r[6] * z,
        b + r[1] * x + r[4] * y + r[7] * z,
        c + r[2] * x + r[5] * y + r[8] * z,
        d,
        e,
        f,
    )


def compute_memory_rate(
    p: Values, memory: Values, motion: VehicleMotion, thrust: Values
) -> Values:
    """Return d/dt of the hidden state, of its rate, and of the time since the start."""
    order, lag, damping = p[ORDER], p[ORDER + 1], p[ORDER + 2]
    # Without a term there is no law: vehicles without one may share its code
    clock = 1.0 if p[0] > 0.0 else 0.0
    if order == 0.0:
        return (0.0, 0.0, clock)
    values = list_quantities(memory, motion, thrust)
    drive = compute_fade(p, values, True) * multiply_factors(p, DRIVE, values)
    off = drive - (memory[0] + p[START])
    if order == 1.0:
        return (off / lag, 0.0, clock)
    # `lag` is the natural frequency
    return (memory[1], lag * lag * off - 2.0 * damping * lag * memory[1], clock)


LAW = WrenchEffect(
    'law',
    PARAMETERS,
    compute_wrench,
    memory=(('hidden', 0.0), ('hidden_rate', 0.0), ('time', 0.0)),
    rate=compute_memory_rate,
    placed=True,
    is_law=True,
)


def _pack_factors(factors: list[LawFactor]) -> list[float]:
    """Return the numbers of up to FACTORS factors, zeros for absent ones."""
    numbers = [0.0] * (FACTOR * FACTORS)
    for k, factor in enumerate(factors):
        first = factor.exponent or factor.threshold or factor.phase
        numbers[FACTOR * k : FACTOR * (k + 1)] = [
            1.0 + list(QUANTITIES).index(factor.quantity),
            float(list(FORMS).index(factor.form)),
            _DEFAULTS.get(factor.form, 0.0) if first is None else first,
            PERIOD if factor.scale is None else factor.scale,
        ]
    return numbers


def list_law_parameters(law: Law) -> dict[str, float]:
    """Return a law as the parameters of the effect `law`, in their order."""
    numbers: list[float] = []
    for term in law.terms:
        axis = 1.0 + list(AXES).index(term.axis)
        numbers += [axis, term.coefficient, *_pack_factors(term.factors)]
    numbers += [0.0] * (ORDER - len(numbers))
    if hidden := law.hidden:
        first = hidden.time_constant is not None
        lag = hidden.time_constant if first else hidden.frequency
        numbers += [1.0 if first else 2.0, lag or 0.0, hidden.damping or 0.0, hidden.start or 0.0]
        numbers += _pack_factors(hidden.drive)
    numbers += [0.0] * (RANGES - len(numbers))
    for name, (low, high) in law.region.items():
        numbers += [1.0 + list(QUANTITIES).index(name), low, high]
    numbers += [0.0] * (len(_PARAMETER_NAMES) - len(numbers))
    return dict(zip(_PARAMETER_NAMES, numbers, strict=True))
