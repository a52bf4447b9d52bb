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
        'weight times distance of the CG below the CB',
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
    rule = 'righting moment, inertia and added mass of the free vehicle'
    words = f'period of the {about} oscillation'
    yield DerivedFigure(f'swing_{about}', STABILITY, words, mode.period, 's', rule, ALL, 2)
    damping, note = mode.damping_ratio, 'no drag is given in the vehicle file'
    if mode.half_amplitude_time is not None:
        note = (
            'by steady drag alone, an oscillation of 5° halves in about '
            f'{mode.half_amplitude_time:.0f} s'
        )
    share = None if damping is None else 100.0 * damping
    rule, words = 'rotational drag, linearised at 5°', f'damping ratio in {about}'
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
        'tilt at full forward thrust',
        lean,
        '°',
        'pitching moment of the rotors against the righting moment',
        (*ALL, *CARRIED),
        note=''
        if lean is not None
        else f'the moment of the rotors is {share:.1f} times the largest righting moment',
    )


def _derive_tumble_figure(vehicle: Vehicle) -> Iterator[DerivedFigure]:
    tumble = limits.tumble_speed(vehicle)
    level, _ = compute_or_explain(lambda: limits.level_speed(vehicle))
    # The Munk moment destabilises only hulls whose added mass is larger across than along
    if math.isinf(tumble):
        note = 'the added mass across the hull is not larger than along it'
    elif level is None:
        note = 'above this speed, the Munk moment turns the hull sideways'
    elif level < tumble:
        note = (
            'above this speed, the Munk moment turns the hull sideways; its thrust allows '
            f'{level:.2f} m/s'
        )
    else:
        note = f'its thrust would allow {level:.2f} m/s; limit its speed'
    yield DerivedFigure(
        'tumble_speed',
        STABILITY,
        'tumbles above',
        tumble,
        'm/s',
        'Munk moment against the righting moment, without drag',
        ALL,
        2,
        note,
    )
