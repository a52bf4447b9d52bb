"""lta bag recover: recover a damaged recording into a new bag."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
import sys
from typing import Annotated

from lta_analysis.console import plain_console
from lta_bridge.bag.storage import StorageFault
from lta_cli.options.common_options import folder_option, Json
from lta_data.bag.bag_folder import find_bag
from lta_data.bag.recover import recover_bag
from lta_report.progress_bar import ProgressBar
from rich.progress import BarColumn, DownloadColumn, TextColumn, TimeRemainingColumn
import typer


@contextmanager
def show_progress() -> Iterator[Callable[[int, int], None]]:
    """Show a progress bar on a terminal; yield a callback(bytes_done, bytes_total)."""
    console = plain_console(stderr=True)
    columns = (TextColumn('recovering'), BarColumn(), DownloadColumn(), TimeRemainingColumn())
    with ProgressBar(console, *columns) as bar:
        yield lambda done, total: bar.update_bar(completed=done, total=total)


def recover(
    path: Annotated[Path, typer.Argument(help='Bag folder, results folder or .mcap file.')],
    out: Annotated[
        Path | None,
        folder_option('Folder for the new bag; BAG-recovered next to the original by default.'),
    ] = None,
    json: Json = False,
) -> None:
    """
    Recover a damaged bag into a new, complete, indexed one.

    Repairs truncated bags (killed recorder, full disk), damaged bytes, and a missing summary or
    metadata.yaml. Recovers every message in intact chunks. The original is not changed.
    Reports the lost bytes, chunks and times, and the lost messages per topic as far as an index,
    metadata.yaml or the topic's rate shows them.

    Exit status 0: a new bag was written. 1: storage failed. 2: nothing to recover, or the bag is
    intact.

    Example: lta bag recover runs/20261120-lamp_room-1/bag --out runs/mended
    """
    bag = find_bag(path)
    place = bag.absolute()
    # A bag is a folder, or a single .mcap file
    name = place.name if place.is_dir() else place.stem
    # Next to the original, which is never changed
    target = out or place.parent / f'{name}-recovered'
    try:
        with show_progress() as at:
            recovery = recover_bag(bag, target, at)
    except StorageFault as fault:
        sys.stderr.write(f'{fault}\n')
        # Status 1: the disk failed; bad input (2) is raised as BadInput
        raise typer.Exit(1) from None
    if json:
        sys.stdout.write(recovery.to_json() + '\n')
        return
    for sentence in recovery.describe_losses():
        plain_console().print(sentence, highlight=False, markup=False, soft_wrap=True)
