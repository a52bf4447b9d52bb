"""The outcome of a flight in words: a sentence, tiles, and a table."""

from dataclasses import fields
from typing import Final

from lta_config.constants import DEGREES_PER_RADIAN
from lta_flight.report.results import FlightResults
from lta_report.formatting import format_amount, format_number, Tile
from lta_report.report import TextTable
from lta_report.result_table import format_value, unit_factor

GRAMS: Final = 1e3
CRUISE_NOTE: Final = (
    '“Cruise” starts when the true forward airspeed first reaches 90 % of the commanded one.'
)


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
        Tile('Direction of the lamp',
             format_number(r.lamp_median, 1, DEGREES_PER_RADIAN), '° median error',
             explain_direction_errors(r)),
        Tile('Signal to noise', f'{format_number(r.snr_start, 0)} → '
        f'{format_number(r.snr_end, 0)}', '',
             'of the best photodiode, first and last half second'),
        Tile('Power', format_number(r.cruise_power), 'W',
             f'{format_amount(r.energy, "J", 1)} from the cell between take-off and goal'),
        Tile('Heading drift', format_number(r.heading_drift, 1, DEGREES_PER_RADIAN), '°',
             'error of the estimated heading at the end'),
        *warm,
    ]  # fmt: skip


def explain_direction_errors(results: FlightResults) -> str:
    """Return the errors of the direction used for steering and of the paper's bearing, briefly."""
    r = results
    lamp, bearing, usual = (
        format_amount(each, '°', 1, DEGREES_PER_RADIAN)
        for each in (r.lamp_error, r.bearing_error, r.bearing_median)
    )
    # Near a lamp above the diodes the hull hides it, and these last blocks make the RMS
    return f"RMS {lamp} with the last blocks; paper's bearing: median {usual}, RMS {bearing}"


def build_result_table(results: FlightResults) -> TextTable:
    """Return the table of the results, in the units and digits that their fields declare."""
    rows = []
    for item in fields(FlightResults):
        value, digits = getattr(results, item.name), item.metadata['digits']
        if digits is None or value is None:
            continue
        unit = item.metadata['display']
        factor = 1.0 if unit == item.metadata['unit'] else unit_factor(unit)
        # One line, also on a phone
        cell = format_amount(value, unit, digits, factor).replace(' ', '\N{NO-BREAK SPACE}')
        rows.append([
            item.metadata['about'], format_value(value) if isinstance(value, bool) else cell,
        ])  # fmt: skip
    return TextTable('In numbers', ('quantity', 'this flight'), rows, CRUISE_NOTE)
