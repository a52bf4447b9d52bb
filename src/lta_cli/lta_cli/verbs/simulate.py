"""lta simulate: fly once in one process, without DDS."""

from typing import Annotated

from lta_cli.options.common_options import Json, Out, plain_console, print_json
from lta_cli.verbs.fly import flight_to_dict, format_outcome, print_files
from lta_control.strategies import STRATEGIES
from lta_flight.progress import FlightProgress
from lta_flight.report.page import write_page
from lta_flight.simulate import simulate_once, SimulationRequest
from lta_sim.simulated_vehicle import is_compiled
import typer

KNOWN = ', '.join(STRATEGIES)
COMPILING = 'compiling the vehicle model (only the first time, about half a minute)'


def simulate(
    vehicle: Annotated[str, typer.Option(help='Vehicle name or file.')] = 'gtmab',
    scenario: Annotated[str, typer.Option(help='Scenario name or file.')] = 'lamp_room',
    strategy: Annotated[
        str, typer.Option(help=f'Navigation strategy: {KNOWN}, or a file such as ./mine.py.')
    ] = 'bag',
    gains: Annotated[
        str, typer.Option(help="Controller gains, name or file; the vehicle's by default.")
    ] = '',
    seed: Annotated[int, typer.Option(help='Random seed.', min=0, max=2**31 - 1)] = 1,
    changes: Annotated[
        list[str] | None,
        typer.Option('--set', metavar='PATH=VALUE', help='Override a parameter; repeatable.'),
    ] = None,
    out: Out = None,
    bag: Annotated[bool, typer.Option(help='Record a bag and write an HTML report.')] = True,
    json: Json = False,
) -> None:
    """
    Fly in one process: the same algorithms in the same order as the graph, without DDS.

    The bag matches that of "lta fly" with the same seed byte for byte, except for /clock and
    /diagnostics, which depend on the wall clock and are left out.

    --set overrides a file's parameter by its path: vehicle.trim.heaviness=4 g,
    scenario.air.wind=[0.2, 0, 0] m/s, scenario.air.wind.0=0.2 m/s (one element, counted from 0),
    gains.heading_kp=0.5; or a node's: mission.altitude=0.8. Roots are vehicle, scenario, gains,
    mission, reserve (action at low charge), estimator, demodulator, prior (lamp position) and
    energy_monitor. Changed files are saved next to the bag. The drone's own model uses the
    overridden values, too.

    Exit status 0: the drone reached its goal. 1: it did not. 2: bad input, nothing was flown.

    Example: lta simulate --seed 3 --set 'vehicle.trim.heaviness=4 g'
    """
    console = plain_console(stderr=json)

    order = SimulationRequest(
        vehicle, scenario, strategy, gains, seed, tuple(changes or ()), out, record=bag
    )
    with FlightProgress(console, 'loading the world') as progress:
        # Compilation takes half a minute without visible progress, so announce it
        if not is_compiled():
            progress.wait_for(COMPILING)
        flight, figures = simulate_once(order, progress)
    target = flight.folder / 'report.html' if bag else None
    if target is not None:
        # Figures of the recorded bag, the same as `lta report` shows
        figures = write_page(flight.bag, target)
    if json:
        content = flight_to_dict(flight, figures, target)
        if not bag:
            # No bag was written
            del content['bag']
        print_json(content)
    console.print(format_outcome(flight, figures), highlight=False, soft_wrap=True)
    console.print(f'Simulation speed: {flight.pace:.1f} x real time.', highlight=False)
    if bag:
        print_files(flight.bag, target, console)
    if flight.outcome != 'reached':
        raise typer.Exit(1)
