"""The outcome of a flight in words: a sentence, tiles, and a table with the paper's values."""

import math
from typing import Final, NamedTuple

from lta_flight.report.results import FlightResults
from lta_report.formatting import format_amount, format_number, format_spread, MISSING, Tile

GRAMS: Final = 1e3
DEGREES: Final = 180.0 / math.pi
SHADED: Final = 3.0  # RMS by median error above which a few blocks make the RMS


class OutcomeRow(NamedTuple):
    """One row of the table: quantity, this flight, the paper."""

    name: str
    here: str
    paper: str = MISSING


def describe_outcome(results: FlightResults) -> str:
    """Return the outcome in one sentence."""
    if results.success is None:
        return 'A recorded flight; the bag does not show whether it reached a lamp'
    count, near = (
        int(results.lamps or 1),
        format_amount(results.closest_horizontal, 'm', 1) + ' horizontally',
    )
    if results.altitude is not None:
        near += f', at a mean height of {format_amount(results.altitude, "m", 1)}'
    way = f'over {format_amount(results.path_length, "m", 1)}'
    if results.search_time is not None:  # None: blown there before it searched
        way = f'in {format_amount(results.search_time, "s", 1)} {way}'
    if count > 1 and results.success:
        return f'The drone reached all {count} lamps of its route {way}'
    # A route that was not completed
    if count > 1:
        reached = f'{results.lamps_reached:.0f} of the {count} lamps of its route'
        return f'The drone reached {reached}, and came no nearer to the next than {near}'
    if results.success:
        return f'The drone found the lamp and reached it {way}'
    return f'The drone did not reach the lamp: it came no nearer than {near}'


def build_tiles(results: FlightResults) -> list[Tile]:
    """Return tiles with the main results."""
    r = results
    warm = [] if r.gas_lift is None else [
        Tile('Lift by sunlight', format_number(r.gas_lift, 1, GRAMS), 'g',
             f'net lift gained by gas that is {format_amount(r.gas_warmth, "K", 1)} warmer than '
             'the air at the end (effect superheat)')
    ]  # fmt: skip
    return [
        Tile('Time to the lamp', format_number(r.search_time, 1), 's',
             f'{format_amount(r.flight_time, "s", 1)} from take-off'),
        Tile('Path', format_number(r.path_length), 'm',
             f'{"shortest way" if (r.lamps or 1) > 1 else "straight line"} to the goal '
             f'{format_amount(r.straight_length, "m")}'),
        Tile('Forward airspeed', format_number(r.forward_airspeed), 'm/s',
             f'true mean \N{PLUS-MINUS SIGN} {format_number(r.forward_airspeed_spread)} m/s '
             'in cruise'),
        Tile('Altitude', format_number(r.altitude), 'm',
             f'RMS error to the set-point {format_amount(r.altitude_error, "cm", 1, 100.0)}'),
        Tile('Direction of the lamp', format_number(r.lamp_error, 1, DEGREES), '° RMS error',
             explain_direction_errors(r)),
        Tile('Signal to noise', f'{format_number(r.snr_start, 0)} → '
        f'{format_number(r.snr_end, 0)}', '',
             'of the best photodiode, first and last half second'),
        Tile('Power', format_number(r.cruise_power), 'W',
             f'{format_amount(r.energy, "J", 1)} from the cell between take-off and goal'),
        Tile('Heading drift', format_number(r.heading_drift, 1, DEGREES), '°',
             'error of the estimated heading at the end'),
        *warm,
    ]  # fmt: skip


def explain_direction_errors(results: FlightResults) -> str:
    """Return the errors of the direction used for steering and of the paper's bearing, briefly."""
    r = results
    error, middle, usual = (
        format_amount(each, '°', 1, DEGREES)
        for each in (r.bearing_error, r.bearing_median, r.lamp_median)
    )
    if r.lamp_median is None or r.bearing_median is None:
        return f"paper's bearing {error}"
    text = f"median {usual}; paper's bearing {error}, median {middle}"
    return f'median {usual}: the hull hides the lamp at the end' if is_shaded(r) else text


def is_shaded(results: FlightResults) -> bool:
    """Return whether a few blocks make the RMS error: far more than a spread of noise would."""
    error, usual = results.lamp_error, results.lamp_median
    return error is not None and usual is not None and error >= SHADED * usual


def explain_shade(results: FlightResults) -> str:
    """
    Return why the RMS error of the direction is far above its median, or ''.

    Within some 1.6 m of a lamp that stands above the diodes, the hull hides it and the diodes see
    reflections alone: these last blocks make the RMS. The medians are those of the way there.
    """
    if not is_shaded(results):
        return ''
    usual, middle = (
        format_amount(each, '°', 1, DEGREES)
        for each in (results.lamp_median, results.bearing_median)
    )
    return (
        'A few blocks, most of them close to the lamp where the hull hides it, make the RMS '
        f"error of the direction; its median is {usual}, and {middle} for the paper's bearing. "
    )


def build_table(results: FlightResults, *, with_paper: bool = True) -> list[OutcomeRow]:
    """
    Return a table of this flight and, with `with_paper`, of the indoor flight of the paper.

    The paper prints one power for all its strategies.
    """
    r = results
    reached = {None: MISSING, True: 'yes', False: 'no'}[r.success]
    rows = [
        OutcomeRow('reached the goal (within its radius and height)', reached, 'yes'),
        OutcomeRow('path to the goal', format_amount(r.path_length, 'm'), '7.3 m'),
        OutcomeRow('time from the first forward command to the goal',
            format_amount(r.search_time, 's', 1), '8.4 s'),
        OutcomeRow('time from take-off to the goal', format_amount(r.flight_time, 's', 1)),
        OutcomeRow('true forward airspeed in cruise, mean and standard deviation',
            format_spread(r.forward_airspeed, r.forward_airspeed_spread, 'm/s'), '0.5 m/s'),
        OutcomeRow('mean altitude of the hull centre in cruise',
            format_amount(r.altitude, 'm'), '0.5 m'),
        OutcomeRow('altitude error to the set-point in cruise, RMS',
            format_amount(r.altitude_error, 'cm', 1, 100.0)),
        OutcomeRow('angle from the nose to the lamp in cruise, RMS',
            format_amount(r.heading_error, '°', 1, DEGREES)),
        OutcomeRow('direction of the lamp used for steering, RMS error',
            format_amount(r.lamp_error, '°', 1, DEGREES)),
        OutcomeRow("the paper's bearing, RMS error",
            format_amount(r.bearing_error, '°', 1, DEGREES)),
        OutcomeRow('mean power from the cell in cruise',
            format_amount(r.cruise_power, 'W'), '1.52 to 1.54 W'),
        OutcomeRow('energy from take-off to the goal', format_amount(r.energy, 'J', 1)),
        OutcomeRow('estimated altitude, RMS error',
            format_amount(r.altitude_estimate_error, 'cm', 1, 100.0)),
        OutcomeRow('estimated airspeed, RMS error',
            format_amount(r.airspeed_estimate_error, 'm/s')),
        OutcomeRow('estimated heading, RMS error',
            format_amount(r.heading_estimate_error, '°', 1, DEGREES)),
        OutcomeRow('net lift gained by gas that sunlight warmed, at the end',
            format_amount(r.gas_lift, 'g', 1, GRAMS)),
    ]  # fmt: skip
    if not with_paper:
        rows = [row._replace(paper=MISSING) for row in rows]
    # Leave out rows with no value at all
    return [row for row in rows if row.here != MISSING or row.paper != MISSING]
