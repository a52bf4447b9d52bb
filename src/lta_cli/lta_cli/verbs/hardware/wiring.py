"""lta hardware wiring: draw how a drone is wired."""

from pathlib import Path
from typing import Annotated

from lta_analysis.console import plain_console
from lta_cli.options.common_options import VehicleName
from lta_config.schema.crazyflie_file import find_crazyflie
from lta_model.vehicle import load_vehicle
from lta_report.results_folder import create_folder, write_file
from lta_vehicle.views.wiring import draw_wiring
import typer


def wiring(
    vehicle: VehicleName,
    file: Annotated[
        Path,
        typer.Option(help='SVG file to write.', metavar='FILE'),
    ] = Path('runs/wiring.svg'),
) -> None:
    """
    Draw the wiring of a vehicle: motors, photodiodes, supply and signals.

    Motor numbers are those of the vehicle's Crazyflie file.

    Example: lta hardware wiring gtmab --file runs/wiring.svg
    """
    craft = load_vehicle(vehicle)
    text = draw_wiring(craft, find_crazyflie(vehicle, craft.file.name))
    create_folder(file.parent)
    write_file(text, file)
    plain_console().print(f'Drawing {file}', highlight=False, markup=False, soft_wrap=True)
