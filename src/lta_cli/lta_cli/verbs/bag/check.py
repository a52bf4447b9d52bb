"""lta bag check: check the data quality of recordings."""

from pathlib import Path
import sys
from typing import Annotated

from lta_analysis.console import plain_console
from lta_cli.options.common_options import Json
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
        str | None, typer.Option(help='Robot to check; by default every robot in a bag.')
    ] = None,
    json: Json = False,
) -> None:
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
    # With --json, stdout holds JSON only
    console = plain_console(stderr=json)
    done: list[CheckedRecording] = check_bags(paths, robot, console)
    if json:
        sys.stdout.write(findings_to_json(done) + '\n')
    else:
        for one in done:
            print_findings(one, console)
    if any(one.is_grave for one in done):
        raise typer.Exit(1)
