# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Write the page of a flight as one HTML file."""

from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
import shlex
from typing import Final

from lta_bag.bag_folder import find_bag_files
from lta_config.command_line import format_lta_command, relative_path
from lta_config.constants import DEGREES_PER_RADIAN
from lta_data.bag.recorded_flight import open_flight, RecordedFlight
from lta_flight.report.panels import FLIGHT_PANELS, FlightPanel
from lta_flight.report.results import compute_results, FlightResults
from lta_flight.report.scene import build_track, render_flight_scene
from lta_flight.report.view import FlightView
from lta_report.flight_scene import render_time_bar
from lta_report.formatting import format_amount, format_number, Tile
from lta_report.report import Grid, Picture, Report, TextSection, TextTable
from lta_report.report_page import render_report
from lta_report.result_table import format_value, unit_factor
from lta_report.results_folder import write_file

RECORDED_FILES: Final = ('vehicle_file', 'scenario_file', 'gains_file', 'strategy_file')
CHOSEN: Final = ('vehicle', 'scenario', 'strategy', 'seed', 'time')
OFFSET_RESULTS: Final = ('offset_x', 'offset_y')
SIMULATED: Final = (
    'A simulated flight. "Truth" is the state of the simulator, which the drone cannot access; '
    '"estimate" is what the drone computed from its simulated sensors.'
)
READOUT_FIELDS: Final = {
    'time': ('time', '\N{NO-BREAK SPACE}s', 1, 1.0),
    'distance': ('to the lamp', '\N{NO-BREAK SPACE}m', 2, 1.0),
    'z': ('altitude', '\N{NO-BREAK SPACE}m', 2, 1.0),
    'speed': ('airspeed', '\N{NO-BREAK SPACE}m/s', 2, 1.0),
    'bearing': ('bearing', '°', 0, DEGREES_PER_RADIAN),
    'snr': ('SNR', '', 0, 1.0),
}
PANEL_HEIGHTS: Final = {  # px; that of the path only if its room is as high as that
    'path': 560, 'heading': 340, 'light': 340, 'duty': 340, 'power': 340, 'samples': 300,
    'spectrum': 300,
}  # fmt: skip
MEASURED_NOTE: Final = (
    'The recording has no scenario. "Truth" is its recorded ground truth; "estimate" is what '
    'the drone computed from its sensors.'
)


def write_page(bag: Path, out: Path, robot: str | None = None) -> FlightResults:
    """
    Write the page of a flight and return its results.

    `bag`: rosbag2 folder or .mcap file. `out`: HTML file to write; an existing one is replaced.
    `robot`: namespace of the robot; needed only for a bag with several. Raise `BadInput` if there
    is no recording, the robot is unknown or ambiguous, or the page cannot be written.
    """
    flight = open_flight(bag, robot)
    view = FlightView(flight)
    results = compute_results(view)
    write_file(render_report(build_report(view, results, bag)), out)
    return results


def build_report(view: FlightView, results: FlightResults, bag: Path) -> Report:
    """Return the report of a flight in a bag."""
    path, *panels = (build_panel(panel, view) for panel in FLIGHT_PANELS)
    return Report(
        command='flight',
        subject=describe_setup(view.provenance),
        headline=f'{describe_outcome(results)}.',
        introduction=explain_truth_and_estimate(view),
        tiles=build_tiles(results),
        blocks=[
            Grid([path, build_result_table(results)]),
            Grid(panels),
        ],
        data={},
        facts=describe_provenance(view.flight),
        commands=suggest_commands(view, relative_path(bag)),
        files={
            key.replace('_', ' ').capitalize(): view.provenance[key]
            for key in RECORDED_FILES
            if key in view.provenance
        },
        scene=render_flight_scene(view),
        time_bar=render_time_bar(READOUT_FIELDS, 'flight'),
        track=build_track(view),
        asset='flight.html',
    )


def build_panel(panel: FlightPanel, view: FlightView) -> Picture | TextSection:
    """Return one figure with heading and caption, or a sentence on what is missing."""
    # A recording of other robots may lack topics
    if missing := [topic for topic in panel.needs if not view.has_topics(topic)]:
        return TextSection(panel.title, [f'The recording has nothing on {" and ".join(missing)}.'])
    figure, height = panel.picture(view), PANEL_HEIGHTS.get(panel.name, 270)
    return Picture(panel.name, panel.title, panel.caption, figure, height, timed=panel.timed)


def describe_setup(provenance: Mapping[str, str]) -> str:
    """Return vehicle, scenario, strategy and seed in one line."""
    names = [provenance.get(key, '') for key in ('vehicle', 'scenario', 'strategy')]
    seed = provenance.get('seed')
    return ' · '.join([name for name in names if name] + ([f'seed {seed}'] if seed else []))


def explain_truth_and_estimate(view: FlightView) -> str:
    """Return the explanation of "truth" and "estimate"."""
    if view.scene.scenario is None:
        return MEASURED_NOTE
    return SIMULATED


def describe_provenance(flight: RecordedFlight) -> dict[str, str]:
    """Return the provenance of the data."""
    entries = {key: value for key, value in flight.provenance.items() if key not in RECORDED_FILES}
    return entries | {
        # Losses are shown, because they may explain gaps in the figures
        'recording': 'complete' if flight.bag.is_complete else ' '.join(flight.bag.losses)
    }


def suggest_commands(view: FlightView, bag: Path) -> dict[str, str]:
    """Return commands for the next steps."""
    # A bag with /clock publishes the time itself; --clock would add a second source
    clock = [] if '/clock' in view.flight.bag.topics else ['--clock']
    return {
        'List what was recorded': format_lta_command('bag', 'info', bag),
        # PlotJuggler opens files, not folders.
        'Plot any topic': shlex.join(['plotjuggler', '-d', str(find_bag_files(bag)[0])]),
        'Replay in ROS 2': shlex.join(['ros2', 'bag', 'play', str(bag), *clock]),
        'Look at every channel': format_lta_command('bag', 'plot', bag),
        'Run the nodes again on the sensor data': format_lta_command('replay', bag, '--against'),
        'Fly it again': format_repeat_command(view.provenance),
    }


def format_repeat_command(provenance: Mapping[str, str]) -> str:
    """Return the command that repeats a flight; a moved start needs `lta launch`."""
    choices = {key: provenance[key] for key in CHOSEN if key in provenance}
    moved = {key: provenance[key] for key in OFFSET_RESULTS if key in provenance}
    if moved:
        return format_lta_command(
            'launch', 'fly', *(f'{key}:={value}' for key, value in (choices | moved).items())
        )
    return format_lta_command(
        'fly', *(word for key, value in choices.items() for word in (f'--{key}', value))
    )


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
        Tile('Signal to noise',
             f'{format_number(r.snr_start, 0)} → {format_number(r.snr_end, 0)}', '',
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
