# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Simulate one flight in one process, and record the same bytes as the graph would.

The recorder is separate from the loop: without a bag no message is built.
"""

from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path
import time
from typing import final, TYPE_CHECKING

from lta_bag.provenance import collect_provenance
from lta_bag.storage import StorageFault
from lta_bag.writer import BagWriter, prepare_empty_folder
from lta_config.errors import BadInput
from lta_config.parameter_override import format_value
from lta_config.topics import load_topic_table
from lta_flight.closed_loop import ClosedLoop
from lta_flight.flight_run import FlightRun, SIMULATED_ROBOT
from lta_flight.flight_spec import (
    build_loop,
    build_vehicle_scenario_stack,
    FlightSpec,
    write_files,
)
from lta_flight.loop_view import LoopView
from lta_flight.progress import FlightProgress
from lta_flight.report.results import compute_results, FlightResults
from lta_report.results_folder import check_creatable, resolve_folder
from lta_sim.simulated_vehicle import is_compiled
from lta_sim.world import World
import numpy as np

if TYPE_CHECKING:
    from lta_flight.messages import LoopRecorder

COMPILING = 'compiling the vehicle model (only the first time, about half a minute)'
BAR_PERIOD = 0.1  # wall seconds between two updates of the progress bar


@final
@dataclass(frozen=True, slots=True)
class CommandRequest:
    """The part of a recording whose commands are flown instead of those of a controller [s]."""

    bag: Path
    robot: str | None = None
    begin: float = 0.0
    end: float | None = None


def simulate_once(
    spec: FlightSpec,
    seed: int,
    out: Path | None,
    watcher: FlightProgress,
    *,
    record: bool = True,
    commands: CommandRequest | None = None,
) -> tuple[FlightRun, FlightResults]:
    """
    Simulate one flight and return the run and its results.

    `out`: folder of the results, in runs/ by default. `record`: whether to write a bag.
    `commands`: recorded commands to fly instead of those of a controller. Raise `BadInput` if the
    flight is invalid, or the bag cannot be written.
    """
    if record:
        require_messages()
        if out is not None:
            check_creatable(out.absolute())  # before half a minute of compiling
    if commands is None:
        announce_compilation(watcher)
        loop = build_loop(spec, seed)
    else:
        loop = build_commanded_loop(spec, seed, commands, watcher)
    folder = resolve_folder(out, f'{loop.world.scenario.name}-{seed}')
    try:
        with ExitStack() as closing:
            recorder = None
            if record:
                # Imported late: without a bag, no messages are needed
                from lta_flight.messages import LoopRecorder

                prepare_empty_folder(folder)
                origin = build_provenance(spec, seed, folder, commands)
                if loop.policy.commands is not None and not loop.policy.commands.has_scene:
                    # Its page would judge the flight by a lamp that was not there
                    del origin['scenario'], origin['scenario_file']
                writer = closing.enter_context(BagWriter(folder / 'bag', origin))
                recorder = LoopRecorder(writer, loop, loop.table, SIMULATED_ROBOT)
            view, pace = simulate_closed_loop(loop, recorder, watcher)
    # For example a full disk
    except StorageFault as fault:
        raise BadInput(str(fault)) from None
    outcome, sentence = describe_end(loop, view)
    flight = FlightRun(folder, folder / 'bag', outcome, sentence, pace, view.warning)
    return flight, compute_results(view)


def require_messages() -> None:
    """Raise `BadInput` if the message classes of ROS 2, which a bag needs, are not installed."""
    try:
        import_module('lta_flight.messages')
    except ModuleNotFoundError as missing:
        package = (missing.name or '').partition('.')[0]
        raise BadInput(
            f"A bag needs the messages of ROS 2, and '{package}' is not installed; install "
            'ros-jazzy-common-interfaces with pip (Linux on x86-64), or simulate with --no-bag.'
        ) from None


def announce_compilation(watcher: FlightProgress) -> None:
    """Show that the model will be compiled, which takes long and shows no progress."""
    if not is_compiled():
        watcher.wait_for(COMPILING)


def simulate_closed_loop(
    loop: ClosedLoop, recorder: 'LoopRecorder | None', watcher: FlightProgress
) -> tuple[LoopView, float]:
    """Fly a loop to its end; return its data and its pace."""
    view = LoopView(loop)
    world, commands = loop.world, loop.policy.commands
    steps: Iterator[object] = (
        loop.iterate_steps()
        if commands is None
        else loop.iterate_until(lambda: world.elapsed > commands.duration)
    )
    begun = looked = time.monotonic()
    for _ in steps:
        view.record_step()
        if recorder is not None:
            recorder.record_step()
        # Updating a terminal in every step would slow the simulation down
        now = time.monotonic()
        if now - looked >= BAR_PERIOD:
            looked = now
            watcher.show_position(
                world.elapsed, world.goal_distance, world.elapsed / (now - begun)
            )
    return view, world.elapsed / (time.monotonic() - begun)


def build_commanded_loop(
    spec: FlightSpec, seed: int, order: CommandRequest, watcher: FlightProgress
) -> ClosedLoop:
    """Return a flight of recorded commands, on the clock of the recording."""
    # Imported late: it loads scipy, which other flights do without
    from lta_flight.recorded_commands import read_commands

    vehicle, scenario, policy = build_vehicle_scenario_stack(spec, hovers=False)
    commands = read_commands(order.bag, vehicle, order.robot, order.begin, order.end)
    announce_compilation(watcher)
    table = load_topic_table().with_start(commands.begin)
    world = World(
        vehicle, scenario, table, seed, spec.strategy,
        wrench_commanded=commands.wrenches is not None,
    )  # fmt: skip
    world.begin_at(commands.motion.tolist(), commands.find_duties(0.0))
    return ClosedLoop(world, table, replace(policy, commands=commands))


def describe_end(loop: ClosedLoop, view: LoopView) -> tuple[str, str]:
    """Return the outcome of a flight, and as a sentence after 'The drone'."""
    world, commands = loop.world, loop.policy.commands
    if commands is None:
        return world.outcome.name.lower(), str(world.outcome)
    truth = view.true_positions
    apart = commands.distances_from(truth[:, 0], truth[:, 1:])
    raised = (
        f' (the recorded track is raised by {commands.raised:.2f} m out of the floor)'
        if commands.raised
        else ''
    )
    return 'flown', (
        f'flew {commands.duration:.1f} s of recorded commands: it is '
        f'{_format_distance(float(np.sqrt(np.mean(apart**2))))} from the recording on average '
        f'(RMS) and {_format_distance(float(apart[-1]))} at the end{raised}'
    )


def _format_distance(distance: float) -> str:
    """Return a distance with two digits, in cm below a metre."""
    return f'{distance:.2f} m' if distance >= 1.0 else f'{100.0 * distance:.2g} cm'


def build_provenance(
    spec: FlightSpec, seed: int, folder: Path, commands: CommandRequest | None
) -> dict[str, str]:
    """Return the provenance for the bag; changed files are written next to it."""
    names = write_files(spec, folder)
    changes = [f'{path}={format_value(value)}' for path, value in spec.replaced.items()]
    more = {'set': '; '.join(changes)} if changes else {}
    if commands is not None:
        more['commands'] = str(commands.bag)
    return collect_provenance(
        names['vehicle'],
        names['scenario'],
        names['gains'],
        strategy=spec.strategy,
        seed=str(seed),
        time='lockstep',
        process='one, without DDS',
        **more,
    )
