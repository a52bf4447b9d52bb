"""
Simulate one flight in one process, and record the same bytes as the graph would.

The recorder is separate from the loop: without a bag no message is built.
"""

from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
import time
from typing import final, TYPE_CHECKING

from lta_bridge.bag.storage import StorageFault
from lta_bridge.bag.writer import BagWriter, prepare_empty_folder
from lta_bridge.provenance import collect_provenance
from lta_config.errors import BadInput
from lta_config.parameter_override import parse_assignment
from lta_config.topics import load_topic_table
from lta_flight.closed_loop import ClosedLoop
from lta_flight.flight import FlightObserver, FlightRun, ROBOT
from lta_flight.flight_spec import build_loop, FlightSpec, load_spec, write_files
from lta_flight.loop_view import LoopView
from lta_flight.report.results import compute_results, FlightResults
from lta_report.results_folder import resolve_folder

if TYPE_CHECKING:
    from lta_flight.messages import LoopRecorder

LOOK = 0.1  # wall seconds between two updates of the progress bar


@final
@dataclass(frozen=True, slots=True)
class SimulationRequest:
    """What to simulate: names, files and settings, checked by `simulate_once`."""

    vehicle: str
    scenario: str
    strategy: str
    gains: str
    seed: int
    changes: tuple[str, ...] = ()
    out: Path | None = None
    record: bool = True


def simulate_once(
    order: SimulationRequest, watcher: FlightObserver
) -> tuple[FlightRun, FlightResults]:
    """
    Simulate one flight and return the run and its results.

    Raises
    ------
    BadInput
        If the request is invalid, or the bag cannot be written.

    """
    spec = load_spec(order.vehicle, order.scenario, order.strategy, order.gains)
    spec = spec.with_values(dict(map(parse_assignment, order.changes)))
    loop = build_loop(spec, order.seed)
    folder = resolve_folder(order.out, f'{loop.world.scenario.name}-{order.seed}')
    try:
        with ExitStack() as closing:
            recorder = None
            if order.record:
                # Imported late: without a bag, ROS is not needed
                from lta_flight.messages import LoopRecorder

                prepare_empty_folder(folder)
                origin = build_provenance(order, spec, folder)
                writer = closing.enter_context(BagWriter(folder / 'bag', origin))
                recorder = LoopRecorder(writer, loop, load_topic_table(), ROBOT)
            view, pace = simulate_closed_loop(loop, recorder, watcher)
    # For example a full disk
    except StorageFault as fault:
        raise BadInput(str(fault)) from None
    world = loop.world
    outcome, sentence = world.outcome.name.lower(), str(world.outcome)
    flight = FlightRun(folder, folder / 'bag', outcome, sentence, pace, view.warning)
    return flight, compute_results(view)


def simulate_closed_loop(
    loop: ClosedLoop, recorder: 'LoopRecorder | None', watcher: FlightObserver
) -> tuple[LoopView, float]:
    """Fly a loop to its end; return its data and its pace."""
    view = LoopView(loop)
    world = loop.world
    begun = looked = time.monotonic()
    for _ in loop.iterate_steps():
        view.record_step()
        if recorder is not None:
            recorder.record_step()
        # Updating a terminal in every step would slow the simulation down
        now = time.monotonic()
        if now - looked >= LOOK:
            looked = now
            watcher.show_position(
                world.elapsed, world.goal_distance, world.elapsed / (now - begun)
            )
    return view, world.elapsed / (time.monotonic() - begun)


def build_provenance(order: SimulationRequest, spec: FlightSpec, folder: Path) -> dict[str, str]:
    """Return the provenance for the bag; changed files are written next to it."""
    names = write_files(spec, folder)
    changes = {'set': '; '.join(order.changes)} if order.changes else {}
    return collect_provenance(
        names['vehicle'],
        names['scenario'],
        names['gains'],
        strategy=order.strategy,
        seed=str(order.seed),
        time='lockstep',
        process='one, without DDS',
        **changes,
    )
