"""Validate light parameters."""

import math

from lta_config.errors import BadInput

MOST_EFFICACY = 683.0  # lm/W, by definition of the lumen, of green light at 555 nm


def require(holds: bool, sentence: str) -> None:
    """Raise `BadInput` with the sentence unless the condition holds."""
    if not holds:
        raise BadInput(sentence)


def require_efficacy(efficacy: float) -> None:
    """Raise `BadInput` for an impossible luminous efficacy. [lm/W]"""
    require(
        0.0 < efficacy <= MOST_EFFICACY,
        f'The light has a luminous efficacy of {efficacy} lm/W; it must be above 0 and at '
        f'most {MOST_EFFICACY:g} lm/W.',
    )


def require_lux(what: str, lux: float) -> None:
    """Raise `BadInput` for a negative or infinite illuminance. [lx]"""
    require(
        math.isfinite(lux) and lux >= 0.0,
        f'{what} is {lux} lx; it must be 0 or more.',
    )
