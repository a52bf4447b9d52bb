"""
One flight in one process, without DDS: recorded as the graph records it, to the same bytes.

The recorder is beside the loop, not in it: without a bag nothing is turned into a message.
"""

from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
import time
from typing import final, TYPE_CHECKING

from lta_bridge.bag.storage import StorageFault
from lta_bridge.bag.writer import BagWriter, empty_folder
from lta_bridge.provenance import provenance
from lta_config.errors import BadInput
from lta_config.override import assignment
from lta_config.topics import topic_table
from lta_flight.flight import Flown, ROBOT, Watcher
from lta_flight.ingredients import gather, Ingredients, loop_of, write_files
from lta_flight.loop import Loop
from lta_flight.loop_view import LoopView
from lta_flight.report.results import Results, results_of
from lta_report.results_folder import results_folder

if TYPE_CHECKING:
    from lta_flight.messages import LoopRecorder

LOOK = 0.1  # wall seconds between two looks of the watcher


@final
@dataclass(frozen=True, slots=True)
class Simulated:
    """What to simulate; names, files and settings, checked by `simulate_once`."""

    vehicle: str
    scenario: str
    strategy: str
    gains: str
    seed: int
    changes: tuple[str, ...] = ()
    out: Path | None = None
    record: bool = True


def simulate_once(order: Simulated, watcher: Watcher) -> tuple[Flown, Results]:
    """
    Fly one flight in this process and return how it went and what it came to.

    Raises
    ------
    BadInput
        If the order cannot be flown, or the disk cannot take its bag.

    """
    made_of = gather(order.vehicle, order.scenario, order.strategy, order.gains)
    made_of = made_of.with_values(dict(map(assignment, order.changes)))
    loop = loop_of(made_of, order.seed)
    folder = results_folder(order.out, f'{loop.world.scenario.name}-{order.seed}')
    try:
        with ExitStack() as closing:
            recorder = None
            if order.record:
                # Here, and not above: who wants no bag needs no ROS.
                from lta_flight.messages import LoopRecorder

                empty_folder(folder)
                origin = origin_of(order, made_of, folder)
                writer = closing.enter_context(BagWriter(folder / 'bag', origin))
                recorder = LoopRecorder(writer, loop, topic_table(), ROBOT)
            view, pace = fly(loop, recorder, watcher)
    except StorageFault as fault:
        raise BadInput(str(fault)) from None
    world = loop.world
    outcome, sentence = world.outcome.name.lower(), str(world.outcome)
    return Flown(folder, folder / 'bag', outcome, sentence, pace), results_of(view)


def fly(loop: Loop, recorder: 'LoopRecorder | None', watcher: Watcher) -> tuple[LoopView, float]:
    """Fly a loop to its end; return what it came through and its pace."""
    view = LoopView(loop)
    world = loop.world
    begun = looked = time.monotonic()
    for _ in loop.flight():
        view.take()
        if recorder is not None:
            recorder.take()
        now = time.monotonic()
        if now - looked >= LOOK:
            looked = now
            watcher.at(world.elapsed, world.distance, world.elapsed / (now - begun))
    return view, world.elapsed / (time.monotonic() - begun)


def origin_of(order: Simulated, made_of: Ingredients, folder: Path) -> dict[str, str]:
    """Return what the bag says of its origin; files that were changed are kept beside it."""
    names = write_files(made_of, folder)
    changes = {'set': '; '.join(order.changes)} if order.changes else {}
    return provenance(
        names['vehicle'],
        names['scenario'],
        names['gains'],
        strategy=order.strategy,
        seed=str(order.seed),
        time='lockstep',
        process='one, without DDS',
        **changes,
    )
