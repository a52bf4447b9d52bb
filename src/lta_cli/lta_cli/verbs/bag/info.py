"""lta bag info: what a recording holds."""

from pathlib import Path
import sys
from typing import Annotated

from lta_cli.options.plain_console import plain_console
from lta_data.bag.bag_folder import find_bag
from lta_data.bag.info import print_bag_info, summarize_bag
import typer


def info(
    path: Annotated[Path, typer.Argument(help='Bag folder, results folder or .mcap file.')],
    json: Annotated[bool, typer.Option('--json', help='Print JSON instead of a table.')] = False,
) -> None:
    """
    Show what a bag holds: topics, counts, rates, length, and where it comes from.

    A bag that was cut short (a killed recorder, a full disk) is read as far as it goes, and what
    is missing is said; so is what is odd: steps back in time, long silences, topics that cannot be
    decoded. The whole vehicle and scenario file that it carries come with --json.
    """
    found = summarize_bag(find_bag(path))
    if json:
        sys.stdout.write(found.to_json() + '\n')
    else:
        print_bag_info(found, plain_console())
