"""lta vehicle check: validate a vehicle file."""

import sys

from lta_analysis.console import plain_console
from lta_cli.options.common_options import Json, print_json, VehicleName
from lta_config.files import find_file
from lta_vehicle.validation import validate_vehicle_file
from lta_vehicle.views import sheet_summary
import typer


def check(name: VehicleName, json: Json = False) -> None:
    """
    Report all errors and warnings of a vehicle file.

    Warnings: unstable balance, too little lift from the rotors, small margins, a hull that does
    not fit its gas volume, slipstreams that do not fit their rotors, assumed numbers.

    Exit status 0: valid, possibly with warnings. 2: the vehicle cannot fly.

    Example: lta vehicle check my_blimp.yaml
    """
    path = find_file('vehicle', name)
    result = validate_vehicle_file(path)
    if json:
        print_json({'file': str(path), 'faults': result.faults, 'warnings': result.warnings})
    else:
        for fault in result.faults:
            # PATH: MESSAGE, the format that editors recognise
            sys.stderr.write(f'{path}: {fault}\n')
        console = plain_console()
        sheet_summary.show_warnings(result.warnings, console)
        if not result.faults:
            console.print(f'{path} is a valid vehicle file.', highlight=False, soft_wrap=True)
    # A faulty file is bad input, status 2
    if result.faults:
        raise typer.Exit(2)
