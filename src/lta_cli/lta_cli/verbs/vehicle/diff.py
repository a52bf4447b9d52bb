"""lta vehicle diff: what differs between two vehicles, and what follows from it."""

from typing import Annotated

from lta_cli.options.json_option import Json, print_json
from lta_cli.options.plain_console import plain_console
from lta_config.errors import BadInput
from lta_model.vehicle import load_vehicle
from lta_vehicle.argument import Named
from lta_vehicle.difference import compare_vehicles, load_vehicle_variant
from lta_vehicle.views import terminal
from lta_vehicle.views.json_output import encode_difference
import typer


def diff(
    name: Named,
    other: Annotated[
        str | None, typer.Argument(metavar='[OTHER]', help='To compare with; itself by default.')
    ] = None,
    changes: Annotated[
        list[str] | None,
        typer.Option('--set', metavar='PATH=VALUE', help='Change a number of OTHER; repeatable.'),
    ] = None,
    swaps: Annotated[
        list[str] | None,
        typer.Option(
            '--swap', metavar='LAYER=VEHICLE', help="Take another vehicle's layer; repeatable."
        ),
    ] = None,
    json: Json = False,
) -> None:
    """
    Compare two vehicles: what differs in their files, and what follows from it.

    With --set and --swap a change is tried without a file: --set 'trim.heaviness=4 g', or
    --swap harvesting=my_blimp.yaml for a layer out of another file.

    Example: lta vehicle diff gtmab --set 'layers.propulsion_and_control.battery.mass=14 g'
    """
    if other is None and not (changes or swaps):
        raise BadInput(
            'There is nothing to compare with; name a second vehicle or --set a number.'
        )
    second = other or name
    found = compare_vehicles(
        load_vehicle(name), load_vehicle_variant(second, changes or (), swaps or ())
    )
    if json:
        print_json(encode_difference(found))
        return
    label = f'{second} changed' if changes or swaps else second
    terminal.show_difference(found, (name, label), plain_console())
