"""Run one replay: start, supervise and stop its processes."""

from dataclasses import dataclass
from pathlib import Path
from typing import final, Protocol

from lta_bridge.bag.writer import prepare_empty_folder
from lta_config.errors import BadInput
from lta_data.bag.recorded_flight import RecordedFlight
from lta_flight.domain_lock import DomainLock
from lta_flight.flight import is_refusal, parse_final_status
from lta_flight.replay.replay_request import build_launch_plan, check_request, ReplayRequest
from lta_flight.stall_monitor import PLAYBACK, StallMonitor
from lta_graph.launcher import Launcher
from lta_graph.ros.listener import DiagnosticsListener

PATIENCE = 15.0  # wall seconds of a stall after which the replay is stopped
LOOK = 0.05  # wall seconds between polls of the processes and the diagnostics


class ReplayObserver(Protocol):
    """Shows a replay to the user."""

    def show_progress(self, time: float, pace: float) -> None:
        """Show bag time [s] and bag seconds per wall second."""
        ...

    def show_message(self, sentence: str) -> None:
        """Show a message."""
        ...


@final
@dataclass(frozen=True, slots=True)
class ReplayRun:
    """The result of a replay."""

    bag: Path  # outputs of the nodes
    standing: dict[str, str] | None  # the player's final status; None if the graph broke

    @property
    def is_complete(self) -> bool:
        """Whether the recording was played to its end."""
        return self.standing is not None and self.standing['outcome'] == 'played'


def run_replay(
    order: ReplayRequest, flight: RecordedFlight, folder: Path, watcher: ReplayObserver
) -> ReplayRun:
    """
    Run nodes again on a recording.

    `flight`: the recording. `folder`: results folder; created, and rejected if it is not empty.
    `watcher`: shows the progress. Raise `BadInput` if it cannot be replayed.
    """
    check_request(order, flight)
    prepare_empty_folder(folder)
    plan = build_launch_plan(order, flight, folder)
    robot = plan.namespaces[0]
    with (
        DomainLock(robot),
        DiagnosticsListener(robot) as listener,
        Launcher(plan, on_line=lambda _name, _line: None) as launcher,
    ):
        supervise_replay(launcher, listener, watcher)
    return collect_result(folder / 'bag', launcher, watcher)


def supervise_replay(
    launcher: Launcher, listener: DiagnosticsListener, watcher: ReplayObserver
) -> None:
    """Follow a replay until a process ends it, or it has stalled for too long."""
    lookout = StallMonitor(watcher.show_message, listener.publish_error)
    while launcher.outcome is None:
        facts = listener.poll(LOOK)
        launcher.poll()
        fact = facts.get(PLAYBACK)
        if fact is not None and (numbers := fact.parse_numbers('time_s', 'pace')):
            watcher.show_progress(*numbers)
        running = launcher.running_nodes
        lookout.report_stalled_nodes(
            facts, listener.find_silent_nodes(running), listener.find_pending_nodes(running)
        )
        lookout.report_health(facts.values())
        # Leaving the context stops all processes
        if lookout.stall_duration > PATIENCE:
            watcher.show_message(
                f'The ROS graph made no progress for {PATIENCE:.0f} s and is stopped.'
            )
            return


def collect_result(bag: Path, launcher: Launcher, watcher: ReplayObserver) -> ReplayRun:
    """Return the result from the exits of the processes; raise `BadInput` for a refusal."""
    end = launcher.outcome
    broken = end is None or not end.success
    for item in launcher.ended:
        # Processes stopped after a failure may not exit cleanly
        if not item.status or (broken and item.stopped):
            continue
        if is_refusal(item):
            raise BadInput(item.lines[-1])
        watcher.show_message('\n'.join((f'{item.sentence}.', *item.lines)))
    return ReplayRun(bag, None if broken else parse_final_status(launcher.ended, ('player',)))
