"""Derive the stability figures: righting moment, pendulum modes, lean and tumbling speed."""

from collections.abc import Iterator
import math
from typing import Literal

from lta_model import limits
from lta_model.vehicle import Vehicle
from lta_vehicle.figures.figure import DerivedFigure
from lta_vehicle.figures.mass_budget import ALL, DEGREES
from lta_vehicle.figures.pendulum import compute_pendulum_mode
from lta_vehicle.figures.thrust_envelope import CARRIED, compute_or_explain, find_push_limit

STABILITY = 'Stability'
SWINGS: tuple[Literal['pitch', 'roll'], ...] = ('pitch', 'roll')


def derive_stability_figures(vehicle: Vehicle) -> Iterator[DerivedFigure]:
    """Yield the figures of the group 'Stability'."""
    pitch = compute_pendulum_mode(vehicle, 'pitch')
    # N m/rad to mN m per degree
    per_degree = 1e3 * pitch.stiffness / DEGREES
    rights = pitch.stiffness > 0.0
    yield DerivedFigure(
        'righting',
        STABILITY,
        'righting moment per degree',
        per_degree,
        'mN m',
        'weight times CG below CB',
        ALL,
        2,
        '' if rights else 'no righting moment; a controller must stabilise it',
    )
    # Periods and lean exist only with a positive righting moment
    if not rights:
        return
    for about in SWINGS:
        yield from _derive_swing_figures(vehicle, about)
    yield from _derive_lean_figure(vehicle, pitch.stiffness)
    yield from _derive_tumble_figure(vehicle)


def _derive_swing_figures(
    vehicle: Vehicle, about: Literal['pitch', 'roll']
) -> Iterator[DerivedFigure]:
    mode = compute_pendulum_mode(vehicle, about)
    rule = 'righting moment, inertia and added mass, free in the air'
    words = f'swings in {about} with a period of'
    yield DerivedFigure(f'swing_{about}', STABILITY, words, mode.period, 's', rule, ALL, 2)
    damping, note = mode.damping_ratio, 'no drag is given'
    if mode.half_amplitude_time is not None:
        note = (
            f'by steady drag alone, a swing of 5° halves in about {mode.half_amplitude_time:.0f} s'
        )
    share = None if damping is None else 100.0 * damping
    rule, words = 'rotational drag, linearised at 5°', f'damping in {about}, of critical'
    yield DerivedFigure(
        f'damping_{about}', STABILITY, words, share, '%', rule, (*ALL, 'aero'), 1, note
    )


def _derive_lean_figure(vehicle: Vehicle, stiffness: float) -> Iterator[DerivedFigure]:
    push = find_push_limit(vehicle, 'forward')[0]
    if push is None or push.most <= 0.0:
        return
    # Balance of the pitching moment of the rotors: M = k sin(lean)
    share = abs(push.wrench[4]) / stiffness
    lean = DEGREES * math.asin(share) if share < 1.0 else None
    yield DerivedFigure(
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


def _derive_tumble_figure(vehicle: Vehicle) -> Iterator[DerivedFigure]:
    tumble = limits.tumble_speed(vehicle)
    level, _ = compute_or_explain(lambda: limits.level_speed(vehicle))
    # The Munk moment destabilises only hulls whose added mass is larger across than along
    if math.isinf(tumble):
        note = 'never: the added mass across is not larger than along'
    elif level is None:
        note = 'the hull turns across its way above this (Munk)'
    elif level < tumble:
        note = f'the hull turns across its way above this (Munk); it flies {level:.2f} m/s at most'
    else:
        note = f'below its top speed of {level:.2f} m/s: hold it back'
    yield DerivedFigure(
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
