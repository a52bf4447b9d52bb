"""The outcome in words: one sentence, the figures on the tiles, and the table beside the paper."""

import math
from typing import Final, NamedTuple

from lta_flight.report.results import Results
from lta_report.formatting import amount, MISSING, number, spread, Tile

DEGREES: Final = 180.0 / math.pi


class Row(NamedTuple):
    """One line of the table: what, this flight, the paper."""

    name: str
    here: str
    paper: str = MISSING


def sentence(results: Results) -> str:
    """Return the outcome in one sentence."""
    if results.success is None:
        return 'A flight was recorded; whether it reached a lamp, its bag does not tell'
    count, near = int(results.lamps or 1), amount(results.closest, 'm', 1)
    time, path = amount(results.search_time, 's', 1), amount(results.path_length, 'm', 1)
    if count > 1 and results.success:
        return f'The drone reached all {count} lamps of its route in {time} over {path}'
    if count > 1:
        reached = f'{results.lamps_reached:.0f} of the {count} lamps of its route'
        return f'The drone reached {reached}, and came no nearer to the next than {near}'
    if results.success:
        return f'The drone found the lamp and reached it in {time} over {path}'
    return f'The drone did not reach the lamp: it came no nearer than {near}'


def tiles(results: Results) -> list[Tile]:
    """Return the figures that matter most."""
    r = results
    paper = amount(r.bearing_error, '°', 1, DEGREES)
    return [
        Tile('Time to the lamp', number(r.search_time, 1), 's',
             f'{amount(r.flight_time, "s", 1)} from leaving the ground'),
        Tile('Path', number(r.path_length), 'm',
             f'{"shortest way" if (r.lamps or 1) > 1 else "straight line"} to the goal '
             f'{amount(r.straight_length, "m")}'),
        Tile('Airspeed', number(r.airspeed), 'm/s',
             f'true mean, \N{PLUS-MINUS SIGN} {number(r.airspeed_spread)} over the cruise'),
        Tile('Altitude', number(r.altitude), 'm',
             f'{amount(r.altitude_error, "cm", 1, 100.0)} RMS off the set-point'),
        Tile('Direction of the lamp', number(r.lamp_error, 1, DEGREES), '° RMS off',
             f"as the drone steers by it; the paper's bearing {paper}"),
        Tile('Signal to noise', f'{number(r.snr_start, 0)} → {number(r.snr_end, 0)}', '',
             'best diode, first and last half second'),
        Tile('Power', number(r.cruise_power), 'W',
             f'{amount(r.energy, "J", 1)} from the cell, from leaving the ground to the goal'),
        Tile('Heading drift', number(r.heading_drift, 1, DEGREES), '°',
             'of the estimate, at the end'),
    ]  # fmt: skip


def table(results: Results) -> list[Row]:
    """
    Return this flight beside the indoor flight of the paper with the same strategy.

    The paper prints the power of all its strategies together.
    """
    r = results
    reached = {None: MISSING, True: 'yes', False: 'no'}[r.success]
    rows = [
        Row('came within the goal radius', reached, 'yes'),
        Row('path to the goal', amount(r.path_length, 'm'), '7.3 m'),
        Row('time from the first forward command', amount(r.search_time, 's', 1), '8.4 s'),
        Row('time from leaving the ground', amount(r.flight_time, 's', 1)),
        Row('forward airspeed, true, cruise, mean and SD',
            spread(r.airspeed, r.airspeed_spread, 'm/s'), '0.5 m/s'),
        Row('altitude of the hull centre, cruise', amount(r.altitude, 'm'), '0.5 m'),
        Row('altitude off its set-point, RMS, cruise', amount(r.altitude_error, 'cm', 1, 100.0)),
        Row('nose off the lamp, RMS, cruise', amount(r.heading_error, '°', 1, DEGREES)),
        Row('direction of the lamp that it steers by, RMS error',
            amount(r.lamp_error, '°', 1, DEGREES)),
        Row("the paper's bearing beside it, RMS error", amount(r.bearing_error, '°', 1, DEGREES)),
        Row('power, cruise', amount(r.cruise_power, 'W'), '1.52 to 1.54 W'),
        Row('energy from leaving the ground to the goal', amount(r.energy, 'J', 1)),
        Row('estimated altitude, RMS error', amount(r.altitude_estimate_error, 'cm', 1, 100.0)),
        Row('estimated airspeed, RMS error', amount(r.airspeed_estimate_error, 'm/s')),
        Row('estimated heading, RMS error', amount(r.heading_estimate_error, '°', 1, DEGREES)),
    ]  # fmt: skip
    return [row for row in rows if row.here != MISSING or row.paper != MISSING]
