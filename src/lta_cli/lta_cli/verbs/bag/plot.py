"""lta bag plot: list or plot the channels of a recording."""

from collections.abc import Sequence
import math
from pathlib import Path
from typing import Annotated

from lta_analysis.console import plain_console
from lta_cli.options.common_options import RobotOption
from lta_config.errors import BadInput
from lta_data.bag.bag_folder import find_bag
from lta_data.bag.channels import read_flight
from lta_data.bag.recorded_flight import open_flight, RecordedFlight
from lta_data.plot.report import (
    build_channel_listing,
    build_report,
    crop_channel,
    group_by_unit,
    print_channels,
    select_channels,
    unwrap_to_degrees,
    write_png,
)
from lta_report.report_page import render_report
from lta_report.results_folder import write_file
from rich.console import Console
import typer


def plot(
    bag: Annotated[Path, typer.Argument(help='Bag folder, results folder or .mcap file.')],
    patterns: Annotated[
        list[str] | None,
        typer.Argument(
            metavar='CHANNEL...',
            help='Channels or topics to plot; * matches any text. Without any, the command only '
            'lists the channels.',
        ),
    ] = None,
    begin: Annotated[float, typer.Option('--from', help='Start time in seconds.')] = -math.inf,
    end: Annotated[float, typer.Option('--to', help='End time in seconds.')] = math.inf,
    png: Annotated[Path | None, typer.Option(help='PNG file to write; needs Chromium.')] = None,
    html: Annotated[Path | None, typer.Option(help='Interactive HTML page to write.')] = None,
    robot: RobotOption = None,
) -> None:
    """
    List the channels of a recording, or plot some of them.

    A channel is a topic and a message field: odom/pose.pose.position.z, motors/effort.up_left,
    light/peaks/snr[3]. Quaternions are shown as yaw, pitch and roll. A topic name selects all its
    channels. Channels with the same unit share an axis.

    Example: lta bag plot BAG

    Example: lta bag plot BAG odom/pose.pose.position.z ground_truth/odom/pose.pose.position.z

    Example: lta bag plot BAG motors 'light/peaks/snr*' --from 5 --to 10 --png look.png
    """
    console = plain_console()
    # Also refuses NaN
    if not begin < end:
        raise BadInput(f'--from ({begin:g} s) must be less than --to ({end:g} s).')
    flight = open_flight(find_bag(bag), robot)
    if not patterns:
        print_channel_overview(flight, begin, end, console)
        return
    channels = [
        unwrap_to_degrees(crop_channel(item, begin, end))
        for item in select_channels(flight, patterns)
    ]
    # First and last time of each channel that has data
    times = [time for item in channels if len(item.time) for time in item.time[[0, -1]]]
    if not times:
        raise BadInput(
            'The chosen channels have no data between --from and --to; widen that time range.'
        )
    span, panels = (min(times), max(times)), list(group_by_unit(channels))
    # Without files, draw in the terminal
    if png is None and html is None:
        print_channels(panels, span, console)
        print_remarks(flight.bag.losses, console)
        return
    # One page for both outputs: the picture is taken of the page
    facts = {'bag': str(bag), **select_provenance(flight)}
    text = render_report(build_report(', '.join(patterns), panels, span, facts))
    if html is not None:
        console.print(f'Page {write_file(text, html)}', highlight=False, soft_wrap=True)
    if png is not None:
        console.print(f'Picture {write_png(text, png)}', highlight=False, soft_wrap=True)
    print_remarks(flight.bag.losses, console)


def print_channel_overview(
    flight: RecordedFlight, begin: float, end: float, console: Console
) -> None:
    """Print all channels, and the topics that could not be decoded."""
    whole = read_flight(flight)
    channels = [
        unwrap_to_degrees(crop_channel(item, begin, end)) for item in whole.channels.values()
    ]
    console.print(build_channel_listing(channels, console.width))
    print_remarks(whole.losses, console)


def print_remarks(remarks: Sequence[str], console: Console) -> None:
    """Print remarks on the recording, without duplicates."""
    # Remove duplicates and keep the order
    for remark in dict.fromkeys(remarks):
        console.print(remark, style='yellow', highlight=False, markup=False, soft_wrap=True)


def select_provenance(flight: RecordedFlight) -> dict[str, str]:
    """Return the main provenance entries of a flight."""
    keys = ('vehicle', 'scenario', 'strategy', 'seed', 'commit', 'created')
    # Imported bags have only some of these entries
    return {key: flight.provenance[key] for key in keys if key in flight.provenance}
