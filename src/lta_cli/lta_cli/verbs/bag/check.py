"""lta bag check: whether recordings can be believed."""

from pathlib import Path
import sys
from typing import Annotated

from lta_cli.options.plain_console import plain_console
from lta_data.data_quality.check_report import (
    check_bags,
    CheckedRecording,
    findings_to_json,
    print_findings,
)
import typer


def check(
    paths: Annotated[
        list[Path], typer.Argument(help='Bag folders, results folders or .mcap files.')
    ],
    robot: Annotated[
        str | None, typer.Option(help='Whose data; by default each robot in a bag.')
    ] = None,
    json: Annotated[bool, typer.Option('--json', help='Print JSON instead of a table.')] = False,
) -> None:
    """
    Check whether recordings can be believed, before anything is concluded from them.

    Looks for constant, frozen and clipped channels, stretches that are there twice, impossible
    values, wrong units, turned signs and axes, clocks that do not agree, stamps that jump, heavy
    filtering or simulation that is not declared, and a craft held by hand. Each finding names its
    channel, interval and evidence. What cannot be judged, because what it needs was not recorded,
    is said and not guessed. Of several bags each pair is compared: one run may be there twice.

    A damaged bag is checked as far as it goes. What the checks find and what they cannot:
    docs/trust.md.

    Exit status 0: nothing suspicious (notes and warnings there may be). 1: something is suspicious
    or cannot be true. 2: bad input.

    Example: lta bag check runs/*/bag
    """
    console = plain_console(stderr=json)
    done: list[CheckedRecording] = check_bags(paths, robot, console)
    if json:
        sys.stdout.write(findings_to_json(done) + '\n')
    else:
        for one in done:
            print_findings(one, console)
    if any(one.is_grave for one in done):
        raise typer.Exit(1)
