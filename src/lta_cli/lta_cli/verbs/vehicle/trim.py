"""lta vehicle trim: estimate the heaviness of a vehicle from a flight."""

from pathlib import Path
from typing import Annotated

from lta_analysis.console import plain_console
from lta_cli.options.common_options import Json, print_json, RobotOption
from lta_config.errors import BadInput
from lta_config.schema.vehicle_file import VehicleFile
from lta_data.bag.bag_folder import find_bag
from lta_data.bag.recorded_flight import open_flight
from lta_data.scene import parse_provenance_file
from lta_model.vehicle import load_vehicle, Vehicle
from lta_vehicle.flight_record import read_flight_record
from lta_vehicle.trim import describe_heaviness, encode_heaviness, estimate_heaviness
import typer


def trim(
    bag: Annotated[Path, typer.Argument(help='Bag folder, results folder or .mcap file.')],
    vehicle: Annotated[
        str | None, typer.Option(help="Flown vehicle, name or file; by default the bag's.")
    ] = None,
    robot: RobotOption = None,
    json: Json = False,
) -> None:
    """
    Estimate a vehicle's heaviness from a flight, and the ballast to add or remove.

    Finds intervals of steady hover and equates the weight with the rotor thrust there, or with a
    commanded force (`wrench_command`) where no duties were recorded. 20 s of
    hover in still air give a standard error of 0.1 g. In a real flight the error of the thrust
    curve adds to that and is reported.

    Example: lta vehicle trim runs/20261120-lamp_room-1
    """
    path = find_bag(bag)
    flight = open_flight(path, robot)
    # Bags of LTA contain the vehicle file that was flown
    own = parse_provenance_file(VehicleFile, flight.bag.provenance, 'vehicle_file')
    if vehicle is not None:
        loaded_vehicle = load_vehicle(vehicle)
    elif own is not None:
        loaded_vehicle = Vehicle(own)
    else:
        raise BadInput(f"'{path}' does not contain a vehicle file; name one with --vehicle.")
    where, commands, topic = read_flight_record(flight, loaded_vehicle)
    estimate = estimate_heaviness(loaded_vehicle, where, commands)
    # Only simulated flights store a scenario
    simulated = 'scenario_file' in flight.bag.provenance
    if json:
        facts = {'vehicle': loaded_vehicle.file.name, 'poses': topic, 'simulated': simulated}
        print_json({**facts, **encode_heaviness(estimate)})
        return
    plain_console().print(
        describe_heaviness(estimate, loaded_vehicle.file.name, simulated),
        highlight=False,
        soft_wrap=True,
    )
