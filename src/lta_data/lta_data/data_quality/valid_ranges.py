"""Declare the possible values of each quantity, with the reason."""

import re
from typing import Final, NamedTuple


class ValidRange(NamedTuple):
    """The possible values of a channel, whatever the flight."""

    names: re.Pattern[str]
    low: float
    high: float
    reason: str


INFINITE: Final = float('inf')
RANGES: Final = (
    ValidRange(
        re.compile(r'^motors/effort\.|^motors/effort\['), -1.0, 1.0, 'a duty is between -1 and 1'
    ),
    ValidRange(re.compile(r'(^|/)range/range$'), 0.0, INFINITE, 'a distance cannot be negative'),
    ValidRange(
        re.compile(r'(^|/)illuminance/illuminance$'),
        0.0,
        2e5,
        'an illuminance cannot be negative, nor far above sunlight (1.3e5 lx)',
    ),
    ValidRange(re.compile(r'/percentage$'), 0.0, 1.0, 'a state of charge is between 0 and 1'),
    ValidRange(
        re.compile(r'/fluid_pressure$'),
        3e4,
        1.1e5,
        'the air pressure below 9 km altitude is between 3e4 and 1.1e5 Pa',
    ),
    ValidRange(
        re.compile(r'linear_acceleration\.[xyz]$'),
        -320.0,
        320.0,
        'no accelerometer measures more than 32 g',
    ),
    ValidRange(
        re.compile(r'angular(_velocity)?\.[xyz]$'),
        -70.0,
        70.0,
        'no gyroscope measures more than 4000 deg/s (70 rad/s)',
    ),
    ValidRange(
        re.compile(r'linear\.[xyz]$'), -60.0, 60.0, 'no indoor vehicle is faster than 60 m/s'
    ),
    ValidRange(
        # 7 is just above 2 pi
        re.compile(r'\.(yaw|pitch|roll)$'),
        -7.0,
        7.0,
        'an angle in radians is between -2 pi and 2 pi',
    ),
    ValidRange(
        re.compile(r'^light/peaks/snr\['),
        0.0,
        INFINITE,
        'a signal-to-noise ratio cannot be negative',
    ),
    ValidRange(
        re.compile(r'/temperature$'),
        -60.0,
        150.0,
        'a temperature in flight is between -60 and 150 degrees Celsius',
    ),
)
COUNTS: Final = re.compile(r'^photodiodes/(min|max|mean)\[|^light/peaks/amplitude\[')
SPREAD: Final = re.compile(r'^photodiodes/std\[')
# Single cells and packs; no battery has less than 2.5 V or 4.4 to 5 V. [V]
CELLS: Final = ((2.5, 4.4), (5.0, 61.0))


def build_light_ranges(top: float | None) -> tuple[ValidRange, ...]:
    """
    Return the possible readings of light.

    `top` is the largest reading of the ADC [counts]; None if unknown.
    """
    if top is None:
        return tuple(
            ValidRange(n, 0.0, INFINITE, 'an ADC reading cannot be negative')
            for n in (COUNTS, SPREAD)
        )
    return (
        ValidRange(COUNTS, 0.0, top, f'the ADC counts from 0 to {top:.0f}'),
        # The standard deviation of bounded values is at most half their range
        ValidRange(
            SPREAD,
            0.0,
            (top + 1.0) / 2.0,
            'a standard deviation is at most half of the range of the ADC '
            f'({top + 1.0:.0f} counts)',
        ),
    )
