# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Run one replay: start, supervise and stop its processes."""

from dataclasses import dataclass
from pathlib import Path
from typing import final

from lta_bag.bag_folder import find_bag
from lta_bag.writer import prepare_empty_folder
from lta_bridge.parameters import FOREVER
from lta_config.errors import BadInput
from lta_data.bag.recorded_flight import open_flight, RecordedFlight
from lta_flight.flight import DomainLock, is_refusal, parse_final_status
from lta_flight.replay.node_settings import parse_settings
from lta_flight.replay.replay_request import (
    build_launch_plan,
    check_request,
    parse_nodes,
    ReplayRequest,
)
from lta_flight.stall_watchdog import PLAYBACK, StallMonitor
from lta_graph.launcher import Launcher
from lta_graph.ros.listener import DiagnosticsListener
from lta_report.progress_bar import ProgressBar
from lta_report.report import Report
from lta_report.request import argument, option, ReportRequest, ROBOT, StudyRun
from rich.progress import BarColumn, TextColumn

REPLAY_PATIENCE = 15.0  # wall seconds of a stall after which the replay is stopped
REPLAY_POLL_PERIOD = 0.05  # wall seconds between polls of the processes and the diagnostics


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


@final
class NodeReplayRequest(ReportRequest, command='replay'):
    """
    Rerun nodes on a recording and check whether they decide as before.

    The player publishes the recorded inputs, including those of nodes that are not rerun; the
    nodes respond as fast as they can, and no message is lost. Vehicle, gains and strategy come
    from the bag unless given.

    Exit status 0: done; with --against, bit-identical, or within 1e-9 with the same decisions if
    the bag comes from other versions or another machine. 1: different, or a node did not respond.
    2: bad input. 130: Ctrl-C.

    Example: lta replay runs/flight --nodes demodulator,navigator --against --set
    demodulator.window=4
    """

    bag: Path = argument('Bag folder, results folder or .mcap file.')
    nodes: str = option('Nodes to rerun, separated by commas.', default='demodulator,navigator')
    against: bool = option(
        'Compare all outputs of the rerun nodes with the recorded ones.', default=False
    )
    settings: tuple[str, ...] = option(
        'Set a parameter of a rerun node: NODE.PARAMETER=VALUE; repeatable.', default=(),
        name='set',
    )  # fmt: skip
    strategy: str | None = option(
        'Navigation strategy to use instead of the recorded one.', default=None
    )
    vehicle: str | None = option(
        'Vehicle to use instead of the recorded one, name or file.', default=None,
        complete='vehicle',
    )  # fmt: skip
    gains: str | None = option(
        'Controller gains to use instead of the recorded ones, name or file.', default=None
    )
    robot: str | None = ROBOT
    rate: float | None = option(
        'Playback speed relative to real time; by default as fast as the nodes respond.',
        default=None, low=1e-3, high=1e6,
    )  # fmt: skip
    start: float = option('Start time in seconds after the first message.', default=0.0, low=0.0)
    end: float | None = option(
        'End time in seconds after the first message.', default=None, low=0.0
    )

    def run(self, run: StudyRun) -> Report:
        """Return the report of the replay."""
        from lta_flight.replay.report import build_report
        from lta_flight.replay.verdict import compare_with_recording

        names = parse_nodes(self.nodes)
        order = ReplayRequest(
            find_bag(self.bag).absolute(), names, parse_settings(self.settings, names),
            self.vehicle, self.gains, self.strategy, self.rate, self.start,
            FOREVER if self.end is None else self.end,
        )  # fmt: skip
        flight = open_flight(order.bag, self.robot)
        # ns to s; a damaged bag may have no times
        span = ((flight.bag.end or 0) - (flight.bag.start or 0)) * 1e-9
        length = max(0.0, min(span, order.end) - self.start)
        detail = TextColumn('{task.fields[detail]}')
        columns = TextColumn('{task.description}'), BarColumn(), detail
        with ProgressBar(
            run.console, *columns, begin='starting the nodes', total=length, detail=''
        ) as progress:
            played = run_replay(order, flight, run.folder, progress)
        verdict = (
            compare_with_recording(flight, open_flight(played.bag), order.node_selection.answers)
            if self.against
            else None
        )
        return build_report(played, verdict, order, flight.provenance)


def run_replay(
    order: ReplayRequest, flight: RecordedFlight, folder: Path, watcher: ProgressBar
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
    launcher: Launcher, listener: DiagnosticsListener, watcher: ProgressBar
) -> None:
    """Follow a replay until a process ends it, or it has stalled for too long."""
    lookout = StallMonitor(watcher.show_message, listener.publish_error)
    while launcher.outcome is None:
        facts = listener.poll(REPLAY_POLL_PERIOD)
        launcher.poll()
        fact = facts.get(PLAYBACK)
        if fact is not None and (numbers := fact.parse_numbers('time_s', 'pace')):
            time, pace = numbers
            detail = f'{time:.1f} s, {pace:.1f} x real time'
            watcher.update_bar(description='replaying', completed=time, detail=detail)
        running = launcher.running_nodes
        lookout.report_stalled_nodes(
            facts, listener.find_silent_nodes(running), listener.find_pending_nodes(running)
        )
        lookout.report_health(facts.values())
        # Leaving the context stops all processes
        if lookout.stall_duration > REPLAY_PATIENCE:
            watcher.show_message(
                f'The ROS graph made no progress for {REPLAY_PATIENCE:.0f} s and is stopped.'
            )
            return


def collect_result(bag: Path, launcher: Launcher, watcher: ProgressBar) -> ReplayRun:
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
