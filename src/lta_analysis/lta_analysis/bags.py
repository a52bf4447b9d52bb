# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Inspect, check, plot, repair and export recordings: the `lta bag` commands."""

from collections.abc import Sequence
from dataclasses import asdict
import math
from pathlib import Path
from typing import Any, final, TYPE_CHECKING

from lta_analysis.console import print_lines
from lta_bag.bag_folder import find_bag
from lta_config.errors import BadInput
from lta_data.bag.info import BagInfo, print_bag_info, summarize_bag
from lta_data.bag.recorded_flight import open_flight, RecordedFlight
from lta_report.progress_bar import ProgressBar
from lta_report.request import Action, argument, Folder, option, Outcome, ROBOT
from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    TextColumn,
)

if TYPE_CHECKING:
    from pandas import DataFrame

BAG_ARGUMENT: Any = argument('Bag folder, results folder or .mcap file.')
PLOT_FACTS = ('vehicle', 'scenario', 'strategy', 'seed', 'commit', 'created')  # facts of a plot


@final
class BagInfoRequest(Action, command='bag info', json=True):
    """
    Show the contents of a bag: topics, counts, rates, duration and provenance.

    A truncated bag (killed recorder, full disk) is read as far as possible. Missing data, backward
    time steps, long gaps and topics that cannot be decoded are reported. --json includes the full
    vehicle and scenario files.
    """

    path: Path = BAG_ARGUMENT

    def run(self, console: Console) -> Outcome[BagInfo]:
        """Print the summary, and return it."""
        summary = summarize_bag(find_bag(self.path))
        print_bag_info(summary, console)
        return Outcome(summary, asdict(summary))


@final
class BagCheckRequest(Action, command='bag check', json=True):
    """
    Check the data quality of recordings before drawing conclusions from them.

    Looks for constant, frozen and clipped channels, duplicated intervals, impossible values, wrong
    units, flipped signs and axes, inconsistent clocks, jumping stamps, undeclared heavy filtering
    or simulation, and a vehicle held by hand. Each finding names its channel, interval and
    evidence. Several bags are also
    compared in pairs to find duplicate runs.

    A damaged bag is checked as far as it can be read. What the checks can and cannot find:
    docs/trust.md.

    What was judged is listed, and what could not be, and why. If nothing could be, the result is
    "not checked".

    Exit status 0: nothing suspicious (notes and warnings are allowed). 1: something is suspicious
    or impossible, or nothing could be judged. 2: bad input.

    Example: lta bag check runs/*/bag
    """

    paths: tuple[Path, ...] = argument('Bag folders, results folders or .mcap files.')
    robot: str | None = option('Robot to check; by default every robot in a bag.', default=None)

    def run(self, console: Console) -> Outcome['DataFrame']:
        """Print the findings, and return a row for each: bag, robot, severity, evidence."""
        from lta_analysis.checked_bags import check_bags, encode_findings, print_findings
        import pandas as pd

        done = check_bags(self.paths, self.robot, console)
        for one in done:
            print_findings(one, console)
        rows = [
            {'bag': one.path, 'robot': one.robot, **asdict(finding)}
            for one in done
            for finding in one.report.findings
        ]
        status = int(any(one.is_grave for one in done))
        return Outcome(pd.DataFrame(rows), encode_findings(done), status)


@final
class BagPlotRequest(Action, command='bag plot'):
    """
    List the channels of a recording, or plot some of them.

    A channel is a topic and a message field: odom/pose.pose.position.z, motors/effort.up_left,
    light/peaks/snr[3]. Quaternions are shown as yaw, pitch and roll. A topic name selects all its
    channels. Channels with the same unit share an axis.

    Example: lta bag plot BAG

    Example: lta bag plot BAG odom/pose.pose.position.z ground_truth/odom/pose.pose.position.z

    Example: lta bag plot BAG motors 'light/peaks/snr*' --from 5 --to 10 --png look.png
    """

    bag: Path = BAG_ARGUMENT
    patterns: tuple[str, ...] = argument(
        'Channels or topics to plot; * matches any text. Without any, the command only lists the '
        'channels.',
        default=(), metavar='CHANNEL...',
    )  # fmt: skip
    begin: float = option('Start time in seconds.', default=-math.inf, name='from')
    end: float = option('End time in seconds.', default=math.inf, name='to')
    png: Path | None = option('PNG file to write; needs Chromium.', default=None)
    html: Path | None = option('Interactive HTML page to write.', default=None)
    robot: str | None = ROBOT

    def run(self, console: Console) -> Outcome[RecordedFlight]:
        """List or plot the channels, and return the recording."""
        from lta_analysis import plot as plots
        from lta_data.bag.channels import read_flight
        from lta_report.report_page import render_report
        from lta_report.results_folder import write_file

        # Also refuses NaN
        if not self.begin < self.end:
            raise BadInput(f'--from ({self.begin:g} s) must be less than --to ({self.end:g} s).')
        flight = open_flight(find_bag(self.bag), self.robot)
        whole = None if self.patterns else read_flight(flight)
        chosen = (
            plots.select_channels(flight, self.patterns)
            if whole is None
            else list(whole.channels.values())
        )
        channels = [
            plots.unwrap_to_degrees(plots.crop_channel(each, self.begin, self.end))
            for each in chosen
        ]
        if whole is not None:
            console.print(plots.build_channel_listing(channels, console.width))
            print_remarks(whole.losses, console)
            return Outcome(flight)
        # First and last time of each channel that has data
        times = [time for each in channels if len(each.time) for time in each.time[[0, -1]]]
        if not times:
            raise BadInput(
                'The chosen channels have no data between --from and --to; widen that time range.'
            )
        span, panels = (min(times), max(times)), list(plots.group_by_unit(channels))
        # Without files, draw in the terminal
        if self.png is None and self.html is None:
            plots.print_channels(panels, span, console)
        else:
            # One page for both outputs: the picture is taken of the page. Imported bags have only
            # some of the facts.
            origin = {
                key: flight.provenance[key] for key in PLOT_FACTS if key in flight.provenance
            }
            facts = {'bag': str(self.bag), **origin}
            page = plots.build_report(', '.join(self.patterns), panels, span, facts)
            text = render_report(page)
            if self.html is not None:
                print_lines(console, f'Page {write_file(text, self.html)}')
            if self.png is not None:
                print_lines(console, f'Picture {plots.write_png(text, self.png)}')
        print_remarks(flight.bag.losses, console)
        return Outcome(flight)


def print_remarks(remarks: Sequence[str], console: Console) -> None:
    """Print remarks on the recording, without duplicates."""
    print_lines(console, *dict.fromkeys(remarks), style='yellow')


@final
class BagUpgradeRequest(Action, command='bag upgrade'):
    """
    Convert a bag of version 1 to the messages of today.

    Version 1 could record photodiodes, light/peaks, motors and energy/status as standard
    messages; they become messages of lta_msgs. All others are copied as they are, and the
    original is not changed.

    Example: lta bag upgrade runs/20251120-lamp_room-1/bag --out runs/upgraded
    """

    path: Path = BAG_ARGUMENT
    out: Folder | None = option(
        'Folder for the new bag; BAG-upgraded next to the original by default.', default=None,
        metavar='FOLDER',
    )  # fmt: skip

    def run(self, console: Console) -> Outcome[Path]:
        """Write the new bag, and return its folder."""
        from lta_data.importers.upgrade import upgrade_bag

        bag = find_bag(self.path)
        place = bag.absolute()
        # A bag is a folder, or a single .mcap file
        name = place.name if place.is_dir() else place.stem
        target = self.out or place.with_name(f'{name}-upgraded')
        done = upgrade_bag(bag, target)
        print_lines(console, done.describe(), *done.losses)
        return Outcome(target)


@final
class BagExportRequest(Action, command='bag export', json=True):
    """
    Export a recording to Parquet, CSV or MATLAB, one file per topic, with units.

    Each file has stamp_ns and time (seconds since the start of the flight), then the message
    fields by path; quaternions are followed by yaw, pitch and roll. Photodiode blocks give one row
    per sample, lamp peaks one row per beacon and diode. With --rate, all topics are resampled into
    one table; gaps longer than three periods of a topic stay empty.

    Units are stored in the field metadata of Parquet files, in units.csv next to CSV files, and in
    the struct "units" of MATLAB files. In MATLAB each topic is a struct of its message fields.
    Topics that cannot be decoded are left out and reported.

    Example: lta bag export runs/20261120-lamp_room-1/bag --format csv --topics odom,motors

    Example: lta bag export runs/20261120-lamp_room-1/bag --format mat --rate 50 --method linear
    """

    bag: Path = BAG_ARGUMENT
    form: str = option(
        'Format of the exported files: parquet, csv, mat.', default='parquet', name='format'
    )
    topics: str = option(
        'Topics to export, separated by commas, such as odom,motors; all by default.', default=''
    )
    out: Folder | None = option(
        'Folder for the files, new or empty; runs/<time>-export by default.', default=None,
        metavar='FOLDER',
    )  # fmt: skip
    rate: float | None = option(
        'Resample all topics to this rate and write them as one table.', default=None, metavar='HZ'
    )
    method: str = option(
        'Interpolation for --rate: previous (hold the last value) or linear.', default='previous'
    )
    robot: str | None = ROBOT

    def run(self, console: Console) -> Outcome[Path]:
        """Write the files, and return their folder."""
        from lta_data.export.run import export_recording, ExportRequest
        from lta_report.results_folder import resolve_folder

        flight = open_flight(self.bag, self.robot)
        # An empty tuple means all topics
        names = tuple(name.strip() for name in self.topics.split(',') if name.strip())
        target = resolve_folder(self.out, 'export')
        with ExportProgress(console) as progress:
            request = ExportRequest(self.form, names, self.rate, self.method)
            done = export_recording(flight, request, target, progress)
        print_lines(
            console,
            *(f'{file.topic}: {file.rows} rows, {file.columns} columns' for file in done.files),
        )
        print_lines(console, *done.remarks, style='yellow')
        print_lines(console, f'Files {target}')
        files = [{**asdict(each), 'file': str(each.file)} for each in done.files]
        return Outcome(target, {'folder': str(target), 'files': files, 'remarks': done.remarks})


@final
class ExportProgress(ProgressBar):
    """Progress bar of an export, with the current topic."""

    def __init__(self, console: Console) -> None:
        columns = (BarColumn(), MofNCompleteColumn(), TextColumn('{task.description}'))
        super().__init__(console, *columns, begin='reading')

    def show_topic(self, topic: str, done: int, total: int) -> None:
        """Show the topic that is being written."""
        self.update_bar(description=topic, completed=done, total=total)
