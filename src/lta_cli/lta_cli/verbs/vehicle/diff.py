"""lta vehicle diff: compare two vehicles."""

from typing import Annotated

from lta_analysis.console import plain_console
from lta_cli.options.common_options import Json, print_json, VehicleName
from lta_config.errors import BadInput
from lta_model.vehicle import load_vehicle
from lta_vehicle.difference import compare_vehicles, load_vehicle_variant
from lta_vehicle.views import sheet_summary
from lta_vehicle.views.sheet_summary import encode_difference
import typer


def diff(
    name: VehicleName,
    other: Annotated[
        str | None,
        typer.Argument(
            metavar='[OTHER]',
            help='Vehicle to compare with; by default the first, changed by --set or --swap.',
        ),
    ] = None,
    changes: Annotated[
        list[str] | None,
        typer.Option(
            '--set',
            metavar='PATH=VALUE',
            help='Override a parameter of the second vehicle; repeatable.',
        ),
    ] = None,
    swaps: Annotated[
        list[str] | None,
        typer.Option(
            '--swap',
            metavar='LAYER=VEHICLE',
            help='Replace a layer of the second vehicle with that of another vehicle; repeatable.',
        ),
    ] = None,
    json: Json = False,
) -> None:
    """
    Compare two vehicles: the differences of their files and of the derived quantities.

    --set and --swap try a change without a file: --set 'trim.heaviness=4 g', or --swap
    harvesting=my_blimp.yaml to use a layer of another file.

    Example: lta vehicle diff gtmab --set 'layers.propulsion_and_control.battery.mass=14 g'
    """
    if other is None and not (changes or swaps):
        raise BadInput('There is nothing to compare with; give a second vehicle, --set or --swap.')
    # Without a second vehicle, compare the first with its changed self
    second = other or name
    difference = compare_vehicles(
        load_vehicle(name), load_vehicle_variant(second, changes or (), swaps or ())
    )
    if json:
        print_json(encode_difference(difference))
        return
    label = f'{second} changed' if changes or swaps else second
    sheet_summary.show_difference(difference, (name, label), plain_console())
