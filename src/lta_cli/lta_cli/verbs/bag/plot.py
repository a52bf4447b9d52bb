"""lta bag plot: a quick look at the channels of a recording."""

from collections.abc import Sequence
import math
from pathlib import Path
from typing import Annotated

from lta_cli.options.plain_console import plain_console
from lta_config.errors import BadInput
from lta_data.bag.channels import all_channels
from lta_data.bag.flight import Flight, open_flight
from lta_data.bag.folder import bag_in
from lta_data.plot.choice import between, by_unit, chosen, readable
from lta_data.plot.page import page, write_png
from lta_data.plot.terminal import listing, show
from lta_report.frame import written
from rich.console import Console
import typer


def plot(
    bag: Annotated[Path, typer.Argument(help='Bag folder, results folder or .mcap file.')],
    patterns: Annotated[
        list[str] | None,
        typer.Argument(metavar='CHANNEL...', help='Channels, topics, or either with *.'),
    ] = None,
    begin: Annotated[float, typer.Option('--from', help='First instant to show. [s]')] = -math.inf,
    end: Annotated[float, typer.Option('--to', help='Last instant to show. [s]')] = math.inf,
    png: Annotated[Path | None, typer.Option(help='PNG file to write; needs a Chromium.')] = None,
    html: Annotated[Path | None, typer.Option(help='Page to write, to zoom and point at.')] = None,
    robot: Annotated[
        str | None, typer.Option(help='Robot to look at; needed where the bag holds several.')
    ] = None,
) -> None:
    """
    Look at a recording: every channel in a line, or some of them as curves.

    A channel is a topic and a field of its messages: odom/pose.pose.position.z,
    motors/effort.up_left, light/peaks/snr[3]; quaternions come as yaw, pitch and roll. A topic
    stands for all of its channels. What has one unit shares an axis.

    Example: lta bag plot BAG

    Example: lta bag plot BAG odom/pose.pose.position.z ground_truth/odom/pose.pose.position.z

    Example: lta bag plot BAG motors 'light/peaks/snr*' --from 5 --to 10 --png look.png
    """
    console = plain_console()
    if not begin < end:
        raise BadInput(f'From {begin:g} s to {end:g} s there is nothing; give --from below --to.')
    flight = open_flight(bag_in(bag), robot)
    if not patterns:
        overview(flight, begin, end, console)
        return
    found = [readable(between(item, begin, end)) for item in chosen(flight, patterns)]
    times = [time for item in found if len(item.time) for time in item.time[[0, -1]]]
    if not times:
        raise BadInput('The channels hold nothing in that stretch of time; widen it.')
    span, panels = (min(times), max(times)), list(by_unit(found))
    if png is None and html is None:
        show(panels, span, console)
        say(flight.bag.losses, console)
        return
    text = page(', '.join(patterns), panels, span, {'bag': str(bag), **origin(flight)})
    if html is not None:
        console.print(f'Page {written(text, html)}', highlight=False, soft_wrap=True)
    if png is not None:
        console.print(f'Picture {write_png(text, png)}', highlight=False, soft_wrap=True)
    say(flight.bag.losses, console)


def overview(flight: Flight, begin: float, end: float, console: Console) -> None:
    """Print every channel, and what could not be decoded."""
    found = all_channels(flight)
    shown = [readable(between(item, begin, end)) for item in found.channels.values()]
    console.print(listing(shown, console.width))
    say([*found.remarks, *flight.bag.losses], console)


def say(remarks: Sequence[str], console: Console) -> None:
    """Print what a reader should know of the recording, each once."""
    for remark in dict.fromkeys(remarks):
        console.print(remark, style='yellow', highlight=False, markup=False, soft_wrap=True)


def origin(flight: Flight) -> dict[str, str]:
    """Return where the flight comes from, in short."""
    wanted = ('vehicle', 'scenario', 'strategy', 'seed', 'commit', 'created')
    return {key: flight.provenance[key] for key in wanted if key in flight.provenance}
