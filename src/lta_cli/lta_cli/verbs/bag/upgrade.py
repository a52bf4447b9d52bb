"""lta bag upgrade: convert a bag of version 1 to today's messages."""

from pathlib import Path
import sys
from typing import Annotated

from lta_analysis.console import plain_console
from lta_bridge.bag.storage import StorageFault
from lta_cli.options.common_options import folder_option
from lta_data.bag.bag_folder import find_bag
from lta_data.bag.upgrade import upgrade_bag
import typer


def upgrade(
    path: Annotated[Path, typer.Argument(help='Bag folder, results folder or .mcap file.')],
    out: Annotated[
        Path | None,
        folder_option('Folder for the new bag; BAG-upgraded next to the original by default.'),
    ] = None,
) -> None:
    """
    Convert a bag of version 1 to the messages of today.

    Version 1 could record photodiodes, light/peaks, motors and energy/status as standard
    messages; they become messages of lta_msgs. All others are copied as they are, and the
    original is not changed.

    Exit status 0: a new bag was written. 1: storage failed. 2: the bag needs no upgrade, or
    cannot be upgraded.

    Example: lta bag upgrade runs/20251120-lamp_room-1/bag --out runs/upgraded
    """
    bag = find_bag(path)
    place = bag.absolute()
    # A bag is a folder, or a single .mcap file
    name = place.name if place.is_dir() else place.stem
    target = out or place.parent / f'{name}-upgraded'
    try:
        done = upgrade_bag(bag, target)
    except StorageFault as fault:
        sys.stderr.write(f'{fault}\n')
        raise typer.Exit(1) from None
    for sentence in (done.describe(), *done.losses):
        plain_console().print(sentence, highlight=False, markup=False, soft_wrap=True)
