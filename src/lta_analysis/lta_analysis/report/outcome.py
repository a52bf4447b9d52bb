"""The outcome in words: one sentence, the figures on the tiles, and the table beside the paper."""

import math
from typing import Final, NamedTuple

from lta_analysis.report.results import Results

MISSING: Final = '–'


class Tile(NamedTuple):
    """One figure large: what, how much, in which unit, and what belongs to it."""

    name: str
    value: str
    unit: str
    note: str


class Row(NamedTuple):
    """One line of the table: what, this flight, the paper."""

    name: str
    here: str
    paper: str


def number(value: float | None, digits: int = 2, factor: float = 1.0) -> str:
    """Return a figure as people read it."""
    return (
        MISSING if value is None else f'{value * factor:.{digits}f}'.replace('-', '\N{MINUS SIGN}')
    )


def degrees(value: float | None, digits: int = 1) -> str:
    """Return an angle in rad as degrees."""
    return number(value, digits, 180.0 / math.pi)


def sentence(results: Results) -> str:
    """Return the outcome in one sentence."""
    if results.success is None:
        return 'A flight was recorded; whether it reached a lamp, its bag does not tell'
    if results.success:
        return (
            f'The drone found the lamp and reached it in {number(results.search_time, 1)} s over '
            f'{number(results.path_length, 1)} m'
        )
    return (
        f'The drone did not reach the lamp: it came no nearer than {number(results.closest, 1)} m'
    )


def tiles(results: Results) -> list[Tile]:
    """Return the figures that matter most."""
    share = number(results.bearing_share, 0, 100.0)
    return [
        Tile('Time to the lamp', number(results.search_time, 1), 's',
             f'{number(results.flight_time, 1)} s from leaving the ground'),
        Tile('Path', number(results.path_length), 'm',
             f'straight line to the goal {number(results.straight_length)} m'),
        Tile('Airspeed', number(results.airspeed), 'm/s',
             f'true mean, ± {number(results.airspeed_spread)} over the cruise'),
        Tile('Altitude', number(results.altitude), 'm',
             f'{number(results.altitude_error, 1, 100.0)} cm RMS off the set-point'),
        Tile('Bearing error', degrees(results.bearing_error), '° RMS',
             f'from {share} % of the light blocks'),
        Tile('Signal to noise', f'{number(results.snr_start, 0)} → {number(results.snr_end, 0)}', '',
             'best diode, first and last half second'),
        Tile('Power', number(results.cruise_power), 'W',
             f'{number(results.energy, 1)} J from the cell for the flight'),
        Tile('Heading drift', degrees(results.heading_drift), '°',
             'of the estimate, at the end'),
    ]  # fmt: skip


def table(results: Results) -> list[Row]:
    """
    Return this flight beside the paper's indoor flight with the same strategy.

    The paper prints power for all strategies together.
    """
    reached = {None: MISSING, True: 'yes', False: 'no'}[results.success]
    altitude = f'{number(results.altitude)} ± {number(results.altitude_error, 3)} m'
    airspeed = f'{number(results.airspeed)} ± {number(results.airspeed_spread)} m/s'
    return [
        Row('came within 1 m of the lamp', reached, 'yes'),
        Row('path to the goal', f'{number(results.path_length)} m', '7.3 m'),
        Row('time from the first forward command', f'{number(results.search_time, 1)} s', '8.4 s'),
        Row('time from leaving the ground', f'{number(results.flight_time, 1)} s', MISSING),
        Row('forward airspeed, true, cruise', airspeed, '0.5 m/s'),
        Row('altitude of the hull centre, cruise', altitude, '0.5 m'),
        Row('nose off the lamp, RMS, cruise', f'{degrees(results.heading_error)}°', MISSING),
        Row('bearing error, RMS', f'{degrees(results.bearing_error)}°', MISSING),
        Row('power, cruise', f'{number(results.cruise_power)} W', '1.52 to 1.54 W'),
        Row('energy of the flight', f'{number(results.energy, 1)} J', MISSING),
        Row(
            'estimated altitude, RMS error',
            f'{number(results.altitude_estimate_error, 1, 100)} cm',
            MISSING,
        ),
        Row(
            'estimated airspeed, RMS error',
            f'{number(results.airspeed_estimate_error)} m/s',
            MISSING,
        ),
        Row(
            'estimated heading, RMS error', f'{degrees(results.heading_estimate_error)}°', MISSING
        ),
        Row('flight time per wall time', f'{number(results.real_time_factor, 1)} ×', MISSING),
    ]
