"""lta vehicle check: all that is wrong with a vehicle file."""

import sys

from lta_cli.options.json_option import Json, print_json
from lta_cli.options.plain_console import plain_console
from lta_config.files import find_file
from lta_vehicle.argument import Named
from lta_vehicle.validation import validate_vehicle_file
from lta_vehicle.views import terminal
import typer


def check(name: Named, json: Json = False) -> None:
    """
    Say everything that is wrong with a vehicle file, and what should be looked at.

    Exit status 2 if the file cannot fly; warnings (an unsteady balance, rotors that cannot lift,
    thin margins, a hull that does not fit its gas, columns that do not fit their rotors, numbers
    that are assumed) leave it at 0.

    Example: lta vehicle check my_blimp.yaml
    """
    path = find_file('vehicle', name)
    found = validate_vehicle_file(path)
    if json:
        print_json({'file': str(path), 'faults': found.faults, 'warnings': found.warnings})
    else:
        for fault in found.faults:
            sys.stderr.write(f'{path}: {fault}\n')
        console = plain_console()
        terminal.show_warnings(found.warnings, console)
        if not found.faults:
            console.print(
                f'{path} is a vehicle that can be flown.', highlight=False, soft_wrap=True
            )
    if found.faults:
        raise typer.Exit(2)
