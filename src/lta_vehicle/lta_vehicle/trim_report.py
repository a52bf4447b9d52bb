"""Format a heaviness estimate as text and as JSON."""

import math

from lta_vehicle.trim import HeavinessEstimate

GRAMS = 1e3
SMALLEST = 0.05  # g; smaller changes of ballast are not practical


def describe_heaviness(estimate: HeavinessEstimate, name: str, simulated: bool) -> str:
    """
    Describe the estimated heaviness and the ballast to add or remove.

    `simulated`: whether the flight was simulated with the same thrust curve, which then has no
    error.
    """
    grams, error = GRAMS * estimate.heaviness, GRAMS * estimate.error
    heavy = 'heavier' if grams >= 0.0 else 'lighter'
    lines = [
        f'{name} was {abs(grams):.2f} g {heavy} than air, '
        f'\N{PLUS-MINUS SIGN} {error:.2f} g (95 %), from {estimate.duration:.0f} s of hover '
        f'at {_describe_effort(estimate)}.',
        _suggest_ballast(GRAMS * estimate.ballast_change, GRAMS * estimate.declared, error),
    ]
    if estimate.force is not None:
        lines.append(
            'An error in the gain of the commanded force adds to that; lta calibrate '
            'estimates the gain.'
        )
    elif not simulated:
        lines.append(
            f'The thrust curve adds an error of about {GRAMS * estimate.curve_error:.1f} '
            'g, if it is as accurate as that of a Crazyflie motor (2.9 mN rms per rotor).'
        )
    return '\n'.join(lines)


def _describe_effort(estimate: HeavinessEstimate) -> str:
    """Return the mean effort of the hover in words."""
    if estimate.duty is not None:
        return f'a duty of {100.0 * estimate.duty:.1f} %'
    return f'a force of {GRAMS * (estimate.force or 0.0):.1f} mN'


def _suggest_ballast(add: float, declared: float, error: float) -> str:
    """Return advice on the ballast; masses in g."""
    target = f'to reach trim.heaviness of the vehicle file ({declared:.2f} g)'
    if abs(add) < SMALLEST:
        return (
            f'This matches trim.heaviness of the vehicle file ({declared:.2f} g): leave the '
            'ballast as it is.'
        )
    action = f'Add {add:.2f} g' if add > 0.0 else f'Remove {-add:.2f} g'
    doubt = ' This is less than the error of the estimate: let the vehicle hover longer.'
    return f'{action} of ballast {target}.{doubt if abs(add) < error else ""}'


def encode_heaviness(estimate: HeavinessEstimate) -> dict[str, float | str | None]:
    """Return the estimate for JSON, masses in kg."""
    # The error is a 95 % interval, about two sigma.
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
        **({} if estimate.force is None else {'force': estimate.force}),
        'unit': 'kg',
    }
