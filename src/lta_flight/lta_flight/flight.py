"""
Fly the whole graph of nodes once: check, start, supervise and stop it.

All errors of the request are found before a process starts. During the flight, nodes that stall
the graph are named within a second. However the flight ends, no process remains.
"""

from collections.abc import Collection, Iterable, Mapping
from contextlib import suppress
import json
from pathlib import Path
from typing import Literal, TYPE_CHECKING

from lta_bridge.bag.writer import prepare_empty_folder
from lta_config.command_line import format_lta_command, relative_path
from lta_config.errors import BadInput
from lta_control.strategies import find_navigation_strategy
from lta_flight.domain_lock import DomainLock
from lta_flight.flight_run import FlightRun, SIMULATED_ROBOT
from lta_flight.preflight import check_plan
from lta_flight.progress import FlightProgress
from lta_flight.stall_watchdog import FLIGHT, StallMonitor
from lta_flight.unflown_bag import remove_unflown_bags
from lta_flight.viewers import find_viewers, report_live_views, require_free_live_ports
from lta_graph.child_process import ProcessExit
from lta_graph.health import HealthFact, HealthLevel
from lta_graph.launch_plan import ONE_PROCESS
from lta_graph.launcher import Launcher
from lta_graph.launches import FLY
from lta_model.scenario import load_scenario
from lta_model.vehicle import load_vehicle
from lta_report.results_folder import resolve_folder

if TYPE_CHECKING:
    from lta_graph.ros.listener import DiagnosticsListener

SIMULATORS = ('simulator', ONE_PROCESS[1])  # processes that print the outcome
STALL_PATIENCE = 10.0  # wall seconds of a stall after which the graph is stopped
POLL_PERIOD = 0.05  # wall seconds between polls of the processes and the diagnostics


def fly_once(
    vehicle: str,
    scenario: str,
    strategy: str,
    seed: int,
    watcher: FlightProgress,
    *,
    time: Literal['lockstep', 'realtime'] = 'lockstep',
    processes: Literal['many', 'one'] = 'many',
    live_port: int | None = None,
    out: Path | None = None,
) -> FlightRun:
    """
    Fly one flight and return its result.

    `vehicle`, `scenario`, `strategy`: names or files. `time`, `processes`: arguments of the
    launch. `live_port`: for Foxglove; None without a live view. `out`: folder of the results, in
    runs/ by default. Raise `BadInput` if the flight is invalid; nothing has been started then.
    """
    scene = load_scenario(scenario)
    find_navigation_strategy(strategy)
    folder = resolve_folder(out, f'{scene.name}-{seed}')
    control = load_vehicle(vehicle).file.control
    gains = control.gains if control else None
    arguments = {
        'robot': SIMULATED_ROBOT,
        **({'gains': gains} if gains else {}),
        'vehicle': vehicle,
        'scenario': scenario,
        'strategy': strategy,
        'time': time,
        'processes': processes,
        'seed': str(seed),
        'bag': str(folder / 'bag'),
        **({} if live_port is None else {'live': 'true', 'live_port': f'{live_port}'}),
    }
    plan = FLY.build_plan(arguments)
    check_plan(plan)
    spare = find_viewers(plan)
    # Imported late: flights in one process do not need ROS
    from lta_graph.ros.listener import DiagnosticsListener

    with DomainLock(SIMULATED_ROBOT), DiagnosticsListener(SIMULATED_ROBOT) as listener:
        require_free_live_ports(plan)
        # An existing empty folder belongs to the user and stays
        new = not folder.exists()
        # After all checks, so that a refused flight leaves no folder
        prepare_empty_folder(folder)
        report_live_views(plan, watcher.show_message)
        try:
            with Launcher(plan, on_line=lambda _name, _line: None) as launcher:
                supervise_flight(launcher, listener, watcher, spare)
        except KeyboardInterrupt:
            report_interrupted_flight(folder, watcher, new=new)
            raise
    return collect_result(folder, launcher, watcher, spare)


def report_interrupted_flight(folder: Path, watcher: FlightProgress, *, new: bool) -> None:
    """Show the bag and how to get its page; remove a `new` folder if the flight never began."""
    bag = folder / 'bag'
    remove_unflown_bags([bag])
    if bag.exists():
        place = relative_path(bag)
        watcher.show_message(f'Bag  {place}  (its page: {format_lta_command("report", place)})')
    elif new:
        with suppress(OSError):  # it has other contents
            folder.rmdir()


def supervise_flight(
    launcher: Launcher,
    listener: 'DiagnosticsListener',
    watcher: FlightProgress,
    optional: Collection[str] = (),
) -> None:
    """
    Follow a flight until a process ends it, or it has stalled for too long.

    The exit of an `optional` process is reported, but does not end the flight.
    """
    lookout = StallMonitor(watcher.show_message, listener.publish_error)
    while launcher.outcome is None:
        facts = listener.poll(POLL_PERIOD)
        for end in launcher.poll():
            if end.name in optional and not end.stopped:
                why = f' ({end.lines[-1]})' if is_refusal(end) else ''
                watcher.show_message(f'{end.sentence}{why}; the flight continues.')
        show_status(facts, watcher)
        # A viewer never delays or ends a flight
        running = [name for name in launcher.running_nodes if name not in optional]
        lookout.report_stalled_nodes(
            facts, listener.find_silent_nodes(running), listener.find_pending_nodes(running)
        )
        lookout.report_health(facts.values())
        if lookout.stall_duration > STALL_PATIENCE:
            sentence = f'The ROS graph made no progress for {STALL_PATIENCE:.0f} s and is stopped.'
            watcher.show_message(sentence)
            listener.publish_error(sentence)
            return
    end = launcher.outcome
    if not end.success:
        listener.publish_error(f'{end.sentence}.')
        listener.wait_until_received()
        # A refusal is raised as BadInput by `collect_result`
        if not is_refusal(end):
            watcher.show_message(f'{end.sentence}.')


def show_status(facts: Mapping[str, HealthFact], watcher: FlightProgress) -> None:
    """Show the newest status of the flight from the simulator."""
    fact = facts.get(FLIGHT)
    if (
        fact is not None
        and fact.level == HealthLevel.OK
        and (numbers := fact.parse_numbers('time_s', 'distance_m', 'pace'))
    ):
        watcher.show_position(*numbers)


def is_refusal(end: ProcessExit) -> bool:
    """Return whether a node exited with a sentence about bad input."""
    # Status 2 is that of `run_node` for BadInput
    return end.status == 2 and bool(end.lines)


def parse_final_status(
    ended: Iterable[ProcessExit], nodes: Collection[str] = SIMULATORS
) -> dict[str, str] | None:
    """Return the final status of a node, by default the simulator; None if it died without one."""
    for item in ended:
        # In one process, others may print after it
        for line in reversed(item.stdout) if item.name in nodes else ():
            if (status := parse_status(line)) is not None:
                return status
    return None


def parse_status(line: str) -> dict[str, str] | None:
    """Return the final status of a flight in a line that a simulator printed; None in others."""
    # It may be cut, or not the status at all
    with suppress(ValueError):
        if isinstance(content := json.loads(line), dict) and 'outcome' in content:
            return content
    return None


def describe_line(line: str) -> str:
    """Return a line that a node printed; the final status of a flight in words."""
    status = parse_status(line)
    if status is None or not {'sentence', 'time_s', 'distance_m'} <= status.keys():
        return line
    place = f'{status["distance_m"]} m from the lamp'
    robot = f'{status["robot"]} ' if 'robot' in status else ''
    return f'{robot}{status["sentence"]} after {status["time_s"]} s, {place}'


def collect_result(
    folder: Path, launcher: Launcher, watcher: FlightProgress, optional: Collection[str] = ()
) -> FlightRun:
    """
    Return the result of the flight from the exits of its processes.

    Raise `BadInput` if a node refused its input; with the node's sentence.
    """
    bag, end = folder / 'bag', launcher.outcome
    broken = end is None or not end.success
    # A stopped process exits with 0, but in a broken graph some had to be killed
    ended = [item for item in launcher.ended if item.name not in optional]
    faulty = [item for item in ended if item.status and not (broken and item.stopped)]
    for item in faulty:
        if is_refusal(item):
            raise BadInput(item.lines[-1])
        if item is not end:
            watcher.show_message(f'{item.sentence}.')
        if item.lines:
            watcher.show_message('\n'.join((f'Last lines printed by {item.name}:', *item.lines)))
    flight = parse_final_status(launcher.ended)
    if broken or faulty or flight is None:
        return FlightRun(
            folder,
            bag,
            'failed',
            'did not finish, because a node of the ROS graph failed or stalled',
            0.0,
        )
    return FlightRun(folder, bag, flight['outcome'], flight['sentence'], float(flight['pace']))
