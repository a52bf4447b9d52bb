"""lta bag info: summarize a recording."""

from pathlib import Path
import sys
from typing import Annotated

from lta_analysis.console import plain_console
from lta_cli.options.common_options import Json
from lta_data.bag.bag_folder import find_bag
from lta_data.bag.info import print_bag_info, summarize_bag
import typer


def info(
    path: Annotated[Path, typer.Argument(help='Bag folder, results folder or .mcap file.')],
    json: Json = False,
) -> None:
    """
    Show the contents of a bag: topics, counts, rates, duration and provenance.

    A truncated bag (killed recorder, full disk) is read as far as possible. Missing data, backward
    time steps, long gaps and topics that cannot be decoded are reported. --json includes the full
    vehicle and scenario files.
    """
    summary = summarize_bag(find_bag(path))
    if json:
        sys.stdout.write(summary.to_json() + '\n')
    else:
        print_bag_info(summary, plain_console())
