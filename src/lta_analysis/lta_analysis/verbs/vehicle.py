"""lta vehicle: what a vehicle is, what is wrong with it, how two differ, what one weighed."""

import json as json_text
from pathlib import Path
import sys
from typing import Annotated

from lta_analysis.bag.flight import open_flight
from lta_analysis.bag.folder import bag_in
from lta_analysis.plain_console import plain_console
from lta_analysis.report.frame import written
from lta_analysis.report.scene import parsed
from lta_analysis.tune.limit import helium_limit
from lta_analysis.tune.run import gains_of
from lta_analysis.typed import near, typed
from lta_analysis.vehicle import terminal
from lta_analysis.vehicle.difference import difference, vehicle_with
from lta_analysis.vehicle.faults import verdict_on, warnings
from lta_analysis.vehicle.page import write_page
from lta_analysis.vehicle.recorded import recorded
from lta_analysis.vehicle.scripts import plain, plain_difference
from lta_analysis.vehicle.sheet import sheet_of
from lta_analysis.vehicle.starting import write_start
from lta_analysis.vehicle.trim import weigh
from lta_analysis.vehicle.trimmed import plain_weighing, told
from lta_bridge.description import urdf as description
from lta_config.errors import BadInput
from lta_config.files import find
from lta_config.vehicle_file import VehicleFile
from lta_control.gains_file import load_gains
from lta_sim.vehicle import load_vehicle, Vehicle
from rich.console import Console
import typer

vehicle = typer.Typer(
    help='Make a vehicle file, look at it, and weigh what flew.', no_args_is_help=True
)
Json = Annotated[bool, typer.Option('--json', help='Print JSON instead of tables.')]
Named = Annotated[str, typer.Argument(metavar='VEHICLE', help='Shipped name or file.')]


@vehicle.callback()
def group() -> None:
    """Make a vehicle file, look at it, and weigh what flew."""


@vehicle.command()
def new(
    name: Annotated[str, typer.Argument(help='Of the new vehicle, for example my_blimp.')],
    model: Annotated[
        str, typer.Option('--from', metavar='VEHICLE', help='Name or file to copy.')
    ] = 'gtmab',
    out: Annotated[Path | None, typer.Option(help='File to write; NAME.yaml by default.')] = None,
) -> None:
    """
    Begin a vehicle file: a copy of one that flies, comments kept, under a new name.

    Nothing is overwritten. Put in your own numbers, each with its source, and look at it with
    "lta vehicle show".

    Example: lta vehicle new my_blimp --from gtmab
    """
    path = out or Path(f'{name}.yaml')
    write_start(name, model, path)
    console = plain_console()
    console.print(f'File {path}', highlight=False, soft_wrap=True)
    line = typed('vehicle', 'check', _as_file(path))
    console.print(f'Put in your own numbers, then: {line}', highlight=False, soft_wrap=True)


def _as_file(path: Path) -> str:
    """Return a path that nobody takes for a shipped name."""
    text = str(near(path))
    return text if '/' in text or text.endswith(('.yaml', '.yml')) else f'./{text}'


@vehicle.command()
def show(
    name: Named,
    out: Annotated[Path | None, typer.Option(help='HTML file of a page to write.')] = None,
    gains: Annotated[
        bool, typer.Option('--gains', help='Fly it heavier and heavier until its gains fail.')
    ] = False,
    sources: Annotated[
        bool, typer.Option('--sources', help='List every number of the file with its source.')
    ] = False,
    json: Json = False,
) -> None:
    """
    Show what a vehicle is and can do, in words and pictures, and where each number comes from.

    Mass by layer and part; where the weight hangs; hover duty; what the rotors can push along
    each axis; speeds; how it swings, leans and tumbles; when too much helium is lost to hover,
    and with --gains (some ten flights) to be flown by its gains. What nobody measured or
    published is marked as assumed. The page (--out) has all of it with three views, offline.

    Example: lta vehicle show gtmab --out gtmab.html
    """
    console = plain_console(stderr=json)
    found = load_vehicle(name)
    held = _held(name, console) if gains else None
    sheet = sheet_of(found, held)
    noted = warnings(sheet)
    if out is not None:
        write_page(sheet, noted, name, out)
    if json:
        _print(plain(sheet, noted))
    else:
        terminal.show_sheet(sheet, noted, console, sources)
    if out is not None:
        console.print(f'Page {out}', highlight=False, soft_wrap=True)


def _held(name: str, console: Console) -> float:
    """Return the loss of lift up to which the gains hold [kg], telling how the search goes."""

    def tell(loss: float, kept: bool) -> None:
        word = 'hold' if kept else 'fail'
        console.print(f'{1e3 * loss:6.1f} g of lift lost: the gains {word}', highlight=False)

    limit = helium_limit(name, load_gains(gains_of(name, None)), tell=tell)
    return 0.0 if limit.grams is None else 1e-3 * limit.grams


@vehicle.command()
def check(name: Named, json: Json = False) -> None:
    """
    Say everything that is wrong with a vehicle file, and what should be looked at.

    Exit status 2 if the file cannot fly; warnings (an unsteady balance, rotors that cannot lift,
    thin margins, a hull that does not fit its gas, columns that do not fit their rotors, numbers
    that are assumed) leave it at 0.

    Example: lta vehicle check my_blimp.yaml
    """
    path = find('vehicle', name)
    found = verdict_on(path)
    if json:
        _print({'file': str(path), 'faults': found.faults, 'warnings': found.warnings})
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


@vehicle.command()
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
    found = difference(load_vehicle(name), vehicle_with(second, changes or (), swaps or ()))
    if json:
        _print(plain_difference(found))
        return
    label = f'{second} changed' if changes or swaps else second
    terminal.show_difference(found, (name, label), plain_console())


@vehicle.command()
def trim(
    bag: Annotated[Path, typer.Argument(help='Bag folder, results folder or .mcap file.')],
    flown: Annotated[
        str | None,
        typer.Option('--vehicle', help="What flew, name or file; the bag's own by default."),
    ] = None,
    robot: Annotated[str | None, typer.Option(help='Whose flight, if there are several.')] = None,
    json: Json = False,
) -> None:
    """
    Weigh a vehicle by a flight: how heavy it was, and how much ballast to add or take off.

    Looks for stretches in which it hung still, and takes what its rotors pushed there for what
    they carried. 20 s of hover in still air weigh it to a tenth of a gram as far as scatter
    goes; in a real flight an error of the thrust curve comes on top, and is told.

    Example: lta vehicle trim runs/20261120-lamp_room-1
    """
    path = bag_in(bag)
    flight = open_flight(path, robot)
    own = parsed(VehicleFile, flight.bag.provenance, 'vehicle_file')
    if flown is not None:
        known = load_vehicle(flown)
    elif own is not None:
        known = Vehicle(own)
    else:
        raise BadInput(f"'{path}' does not say what flew; name it with --vehicle.")
    where, commands, topic = recorded(flight, known)
    found = weigh(known, where, commands)
    simulated = 'scenario_file' in flight.bag.provenance
    if json:
        _print({'vehicle': known.file.name, 'poses': topic, 'simulated': simulated,
                **plain_weighing(found)})  # fmt: skip
        return
    plain_console().print(told(found, known.file.name, simulated), highlight=False, soft_wrap=True)


@vehicle.command()
def urdf(
    name: Named,
    out: Annotated[Path | None, typer.Option(help='File to write; printed by default.')] = None,
) -> None:
    """
    Print a vehicle as URDF, for RViz, Foxglove and robot_state_publisher.

    Links are the frames of the messages: base_link at the hull centre with mass, inertia and all
    that is drawn, the sensors, and rotor_NAME for each rotor. Added mass of the air is not in it.

    Example: lta vehicle urdf gtmab --out gtmab.urdf
    """
    text = description(load_vehicle(name))
    if out is None:
        sys.stdout.write(text)
        return
    written(text, out)
    plain_console().print(f'File {out}', highlight=False, markup=False, soft_wrap=True)


def _print(content: object) -> None:
    sys.stdout.write(json_text.dumps(content, indent=1, ensure_ascii=False) + '\n')
