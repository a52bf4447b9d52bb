"""Whether it stays upright: righting, swinging, leaning into a push, tumbling."""

from collections.abc import Iterator
import math
from typing import Literal

from lta_model import limits
from lta_model.vehicle import Vehicle
from lta_vehicle.figures.figure import Figure
from lta_vehicle.figures.pushing import CARRIED, held_or_not, or_why
from lta_vehicle.figures.swing import swing
from lta_vehicle.figures.weighing import ALL, DEGREES

STABILITY = 'Stability'
SWINGS: tuple[Literal['pitch', 'roll'], ...] = ('pitch', 'roll')


def steadiness_figures(vehicle: Vehicle) -> Iterator[Figure]:
    """Yield what rights it and how it swings."""
    pitch = swing(vehicle, 'pitch')
    per_degree = 1e3 * pitch.stiffness / DEGREES
    rights = pitch.stiffness > 0.0
    yield Figure(
        'righting',
        STABILITY,
        'righting moment, a degree',
        per_degree,
        'mN m',
        'weight times CG below CB',
        ALL,
        2,
        '' if rights else 'nothing rights it: a controller must',
    )
    if not rights:
        return
    for about in SWINGS:
        yield from _swinging(vehicle, about)
    yield from _leaning(vehicle, pitch.stiffness)
    yield from _tumbling(vehicle)


def _swinging(vehicle: Vehicle, about: Literal['pitch', 'roll']) -> Iterator[Figure]:
    found = swing(vehicle, about)
    rule = 'righting moment, inertia and added mass, free in the air'
    words = f'swings in {about} with a period of'
    yield Figure(f'swing_{about}', STABILITY, words, found.period, 's', rule, ALL, 2)
    damping, note = found.ratio, 'no drag is given'
    if found.half is not None:
        note = f'by steady drag alone a swing of 5° loses half in about {found.half:.0f} s'
    share = None if damping is None else 100.0 * damping
    rule, words = 'rotational drag, linearised at 5°', f'damping in {about}, of critical'
    yield Figure(f'damping_{about}', STABILITY, words, share, '%', rule, (*ALL, 'aero'), 1, note)


def _leaning(vehicle: Vehicle, stiffness: float) -> Iterator[Figure]:
    push = held_or_not(vehicle, 'forward')[0]
    if push is None or push.most <= 0.0:
        return
    share = abs(push.wrench[4]) / stiffness
    lean = DEGREES * math.asin(share) if share < 1.0 else None
    yield Figure(
        'push_lean',
        STABILITY,
        'leans at full push forward',
        lean,
        '°',
        'pitching moment of the rotors against righting',
        (*ALL, *CARRIED),
        note=''
        if lean is not None
        else f'it would go over: the moment is {share:.1f} times what can be righted',
    )


def _tumbling(vehicle: Vehicle) -> Iterator[Figure]:
    tumble = limits.tumble_speed(vehicle)
    level, _ = or_why(lambda: limits.level_speed(vehicle))
    if math.isinf(tumble):
        note = 'never: it is no wider than long'
    elif level is None:
        note = 'the hull turns across its way above this (Munk)'
    elif level < tumble:
        note = f'the hull turns across its way above this (Munk); it flies {level:.2f} m/s at most'
    else:
        note = f'below its top speed of {level:.2f} m/s: hold it back'
    yield Figure(
        'tumble_speed',
        STABILITY,
        'tumbles above',
        tumble,
        'm/s',
        'Munk moment against righting, drag left out',
        ALL,
        2,
        note,
    )
