# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Fly the whole graph of nodes once: check, start, supervise and stop it.

All errors of the request are found before a process starts. During the flight, nodes that stall
the graph are named within a second. However the flight ends, no process remains.
"""

from collections.abc import Collection, Iterable, Mapping, Sequence
from contextlib import suppress
import fcntl
import json
import os
from pathlib import Path
import shutil
import tempfile
from typing import final, Literal, Self, TYPE_CHECKING

from lta_bag.writer import prepare_empty_folder
from lta_config.command_line import format_lta_command, relative_path
from lta_config.errors import BadInput
from lta_control.strategies import find_navigation_strategy
from lta_data.bag.info import summarize_bag
from lta_flight.flight_run import FlightRun, SIMULATED_ROBOT
from lta_flight.preflight import check_plan
from lta_flight.progress import FlightProgress
from lta_flight.stall_watchdog import FLIGHT, StallMonitor
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


GRAPH_TOPICS = ('/clock', '/diagnostics', '/parameter_events', '/rosout')  # also without a flight


def remove_unflown_bags(bags: Iterable[Path]) -> None:
    """Remove the bags that hold no message of a robot; the others stay."""
    for bag in bags:
        if bag.is_dir() and not has_flight(bag):
            shutil.rmtree(bag, ignore_errors=True)


def has_flight(bag: Path) -> bool:
    """Return whether a folder has anything but a readable bag without a message of a robot."""
    if not any(bag.iterdir()):
        return False
    try:
        topics = summarize_bag(bag).topics
    except BadInput:
        return True  # what is not understood is kept
    return any(topic.count for topic in topics if topic.name not in GRAPH_TOPICS)


HIGHEST_DOMAIN = 232  # the ports of a higher one would exceed 16 bits
LONGEST_NAMES = 4096  # bytes read of the robots' names


@final
class DomainLock:
    """
    Hold the current ROS domain during a flight; the kernel releases it even after SIGKILL.

    Parameters
    ----------
    robots : str
        Namespaces of the robots; they share one /clock.

    Raises
    ------
    BadInput
        On entering, if another flight of this user holds the domain, or it does not exist.

    """

    def __init__(self, *robots: str) -> None:
        self._domain = os.environ.get('ROS_DOMAIN_ID', '0') or '0'
        folder = Path(os.environ.get('XDG_RUNTIME_DIR') or tempfile.gettempdir())
        self._path = folder / f'lta-{os.getuid()}-{self._domain}.lock'
        self._robots = robots

    def __enter__(self) -> Self:
        """Acquire the lock."""
        if not (self._domain.isdecimal() and int(self._domain) <= HIGHEST_DOMAIN):
            raise BadInput(
                f"ROS_DOMAIN_ID is '{self._domain}', but must be a number from 0 to "
                f'{HIGHEST_DOMAIN}; correct or unset it.'
            )
        try:
            # No symbolic links: in a shared /tmp one could make us overwrite another file
            flags = os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_CLOEXEC
            self._file = os.open(self._path, flags, 0o600)
        except OSError as error:
            raise BadInput(
                f"The lock file '{self._path}' cannot be opened ({error.strerror}); remove the "
                'file.'
            ) from None
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            holder = os.pread(self._file, LONGEST_NAMES, 0).decode(errors='replace')
            os.close(self._file)
            raise BadInput(
                f'{holder or "A robot is"} flying on ROS domain {self._domain} already, and all '
                'robots on a domain share /clock; wait until this flight ends, or choose another '
                f'domain: export ROS_DOMAIN_ID={(int(self._domain) + 1) % (HIGHEST_DOMAIN + 1)}.'
            ) from None
        # A shorter name must not leave the end of an older one
        os.ftruncate(self._file, 0)
        os.pwrite(self._file, format_holders(self._robots).encode(), 0)
        return self

    def __exit__(self, *_: object) -> None:
        """Release the lock."""
        # Do not remove the file: a process that has opened it would then lock an invisible file
        os.close(self._file)


def format_holders(robots: Sequence[str]) -> str:
    """Return the start of a sentence: 'lta1 is', 'lta1 and lta2 are'."""
    *others, last = robots
    return f'{", ".join(others)} and {last} are' if others else f'{last} is'
