"""lta vehicle new: create a vehicle file from size, mass and motors, or from an existing one."""

from pathlib import Path
from typing import Annotated

from lta_analysis.console import plain_console
from lta_config.command_line import format_lta_command, relative_path
from lta_config.errors import BadInput
from lta_vehicle.new_vehicle import describe_balance, write_new_vehicle, write_sized_vehicle
from lta_vehicle.vehicle_size import MOTORS, parse_size, VehicleSize
import typer

ALTITUDE = 0.5  # m, of a mission by default
NEEDED = ('diameter', 'mass', 'thrust', 'arm')
Text = str | None


def new(
    name: Annotated[str, typer.Argument(help='Name of the new vehicle, for example my_blimp.')],
    model: Annotated[
        str | None,
        typer.Option(
            '--from', metavar='VEHICLE', help='Copy this vehicle (name or file) instead.'
        ),
    ] = None,
    diameter: Annotated[Text, typer.Option(help="Diameter of the envelope: '50 cm'.")] = None,
    length: Annotated[
        Text, typer.Option(help='Length of a cigar; without it and --height, a sphere.')
    ] = None,
    height: Annotated[Text, typer.Option(help='Height of a flattened balloon.')] = None,
    mass: Annotated[
        Text, typer.Option(help='Mass of everything without gas and ballast: what a scale shows.')
    ] = None,
    motors: Annotated[
        int,
        typer.Option(
            help='; '.join(f'{count}: {where}' for count, where in MOTORS.items()) + '.',
            min=min(MOTORS),
            max=max(MOTORS),
        ),
    ] = 3,
    thrust: Annotated[Text, typer.Option(help="Thrust of one motor at full: '0.1 N'.")] = None,
    arm: Annotated[Text, typer.Option(help='Distance of the side motors from the middle.')] = None,
    hang: Annotated[
        Text,
        typer.Option(
            help='Depth of the gondola with the motors below the centre of the envelope; by '
            'default 3 cm below the envelope.'
        ),
    ] = None,
    envelope: Annotated[
        Text, typer.Option(help='Mass of the empty envelope; by default from its area.')
    ] = None,
    heaviness: Annotated[
        Text, typer.Option(help="Weight less lift after ballasting; '2 g' by default.")
    ] = None,
    battery: Annotated[
        Text, typer.Option(help="Capacity of the battery, one cell; '250 mA h' by default.")
    ] = None,
    file: Annotated[
        Path | None,
        typer.Option(help='Vehicle file to write; NAME.yaml by default.', metavar='FILE'),
    ] = None,
) -> None:
    """
    Create a vehicle file from what you can weigh and measure, or copy an existing one.

    From size, mass and motors follow volume, lift, ballast, inertia and added mass, and an
    estimate of the drag. All other numbers are assumed, with a range, and marked so in the file.
    Gains that fit are written beside it, so that it flies at once. With --from, the file is a copy
    with its comments, under a new name. Existing files are not overwritten.

    Measure next what the file marks as assumed ("lta vehicle show --sources"); what a scale and a
    ruler do not tell, the flights of "lta tests plan" do.

    Example: lta vehicle new my_blimp --length 1.2m --diameter 0.5m --mass 120g --motors 3 --thrust
    0.1N --arm 0.2m
    """
    path = file or Path(f'{name}.yaml')
    texts = {
        'diameter': diameter, 'length': length, 'height': height, 'mass': mass, 'thrust': thrust,
        'arm': arm, 'hang': hang, 'envelope': envelope, 'heaviness': heaviness,
        'battery': battery,
    }  # fmt: skip
    options = {key: text for key, text in texts.items() if text is not None}
    console = plain_console()
    if not options or model is not None:
        if options:
            raise BadInput(
                '--from copies a vehicle as it is; leave out --from, or '
                f'{", ".join(f"--{key}" for key in options)}.'
            )
        _copy_vehicle(name, model or 'gtmab', path)
        return
    if missing := [f'--{key}' for key in NEEDED if key not in options]:
        raise BadInput(
            f'Size, mass and motors are needed together: {", ".join(missing)} is missing; or copy '
            'a vehicle with --from.'
        )
    sizes = {key: parse_size(key, text) for key, text in options.items()}
    vehicle, gains = write_sized_vehicle(name, VehicleSize(motors=motors, **sizes), path)
    balance = f'Its gas lifts {1e3 * vehicle.gross_lift:.0f} g; {describe_balance(vehicle)}.'
    for line in (f'File {path}', f'Gains {gains}', balance):
        console.print(line, highlight=False, soft_wrap=True)
    path_text = _format_explicit_path(path)
    stands = vehicle.hull_height_on_floor
    climb = ['--set', f'mission.altitude={stands + 0.3:.1f}'] if stands > ALTITUDE - 0.1 else []
    flies = ('Fly it', ('simulate', '--vehicle', path_text, *climb))
    if motors == min(MOTORS):
        console.print('No motor pushes up, so no control law of LTA can hold its altitude.')
        recorded = ('simulate', '--commands', 'BAG', '--vehicle', path_text)
        flies = ('Fly it by the commands of a flight', recorded)
    for purpose, words in (
        ('See its figures', ('vehicle', 'show', path_text)),
        flies,
        ('Measure what is assumed', ('tests', 'plan', path_text)),
    ):
        console.print(f'{purpose}: {format_lta_command(*words)}', highlight=False, soft_wrap=True)


def _copy_vehicle(name: str, model: str, path: Path) -> None:
    write_new_vehicle(name, model, path)
    console = plain_console()
    console.print(f'File {path}', highlight=False, soft_wrap=True)
    line = format_lta_command('vehicle', 'check', _format_explicit_path(path))
    console.print(
        f'Replace the numbers copied from {model} with your own, then run: {line}',
        highlight=False,
        soft_wrap=True,
    )


def _format_explicit_path(path: Path) -> str:
    """Format a path so that it cannot be mistaken for a shipped name."""
    text = str(relative_path(path))
    # A word without slash and ending is taken as the name of a shipped vehicle
    return text if '/' in text or text.endswith(('.yaml', '.yml')) else f'./{text}'
