"""What a weighing says, in words and for scripts."""

import math

from lta_vehicle.trim import HeavinessEstimate

GRAMS = 1e3
SMALLEST = 0.05  # g; nobody weighs ballast finer


def describe_heaviness(estimate: HeavinessEstimate, name: str, simulated: bool) -> str:
    """
    Return how heavy a vehicle was and what to do, in a few sentences.

    Parameters
    ----------
    found : Weighing
        What the flight said.
    name : str
        Of the vehicle.
    simulated : bool
        Whether the flight was simulated by the same thrust curve, which then cannot be wrong.

    """
    grams, error = GRAMS * estimate.heaviness, GRAMS * estimate.error
    heavy = 'heavier' if grams >= 0.0 else 'lighter'
    lines = [
        f'{name} was {abs(grams):.2f} g {heavy} than air, '
        f'\N{PLUS-MINUS SIGN} {error:.2f} g (95 %), by {estimate.duration:.0f} s of hanging still '
        f'at a duty of {100.0 * estimate.duty:.1f} %.',
        _suggest_ballast(GRAMS * estimate.ballast_change, GRAMS * estimate.declared, error),
    ]
    if not simulated:
        lines.append(
            f'An error of the thrust curve comes on top: {GRAMS * estimate.curve_error:.1f} g if '
            f'it '
            'is as good as that of a Crazyflie motor against its bench table (2.9 mN rms a rotor).'
        )
    return '\n'.join(lines)


def _suggest_ballast(add: float, declared: float, error: float) -> str:
    """Return what to do about the ballast. [g]"""
    target = f'to be {declared:.2f} g heavy as its file says'
    if abs(add) < SMALLEST:
        return f'That is as its file says ({declared:.2f} g): leave the ballast.'
    action = f'Add {add:.2f} g' if add > 0.0 else f'Take off {-add:.2f} g'
    doubt = ' The flight cannot tell that from nothing: let it hover longer.'
    return f'{action} of ballast {target}.{doubt if abs(add) < error else ""}'


def encode_heaviness(estimate: HeavinessEstimate) -> dict[str, float | str]:
    """Return a weighing for scripts, masses in kg."""
    total = math.hypot(estimate.error / 2.0, estimate.curve_error)
    return {
        'heaviness': estimate.heaviness,
        'error': estimate.error,
        'thrust_curve_error': estimate.curve_error,
        'total_sigma': total,
        'declared': estimate.declared,
        'add': estimate.ballast_change,
        'duration': estimate.duration,
        'duty': estimate.duty,
        'unit': 'kg',
    }
