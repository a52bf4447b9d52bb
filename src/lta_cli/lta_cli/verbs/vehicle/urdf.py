"""lta vehicle urdf: print a vehicle as URDF."""

from pathlib import Path
import sys
from typing import Annotated

from lta_analysis.console import plain_console
from lta_bridge.description.urdf import build_urdf
from lta_cli.options.common_options import VehicleName
from lta_model.vehicle import load_vehicle
from lta_report.results_folder import write_file
import typer


def urdf(
    name: VehicleName,
    file: Annotated[
        Path | None, typer.Option(help='URDF file to write; printed by default.', metavar='FILE')
    ] = None,
) -> None:
    """
    Print a vehicle as URDF, for RViz, Foxglove and robot_state_publisher.

    Links match the message frames: base_link at the hull centre with all visuals, the sensors,
    rotor_NAME for each rotor, and cg_link with mass and inertia. Aerodynamic added mass is not
    included.

    Example: lta vehicle urdf gtmab --file gtmab.urdf
    """
    text = build_urdf(load_vehicle(name))
    # stdout may be piped to robot_state_publisher
    if file is None:
        sys.stdout.write(text)
        return
    write_file(text, file)
    plain_console().print(f'File {file}', highlight=False, markup=False, soft_wrap=True)
