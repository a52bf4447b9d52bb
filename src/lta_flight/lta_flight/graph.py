# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Run any launch file: start it, supervise it, and stop it when its first process ends."""

from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path

from lta_flight.flight import DomainLock, is_refusal, remove_unflown_bags
from lta_flight.stall_watchdog import StallMonitor
from lta_flight.viewers import find_viewers, report_live_views, require_free_live_ports
from lta_graph.child_process import ProcessExit
from lta_graph.launch_plan import LaunchPlan
from lta_graph.launcher import Launcher, OnLine
from lta_graph.ros.listener import DiagnosticsListener

GRAPH_POLL_PERIOD = 0.1  # wall seconds between polls of the processes and the diagnostics
RECORDER_PROGRAM = ('lta_bridge', 'recorder')
TELLERS = (('lta_sim', 'simulator'), ('lta_bridge', 'player'))  # executables with a /clock


def run_graph(plan: LaunchPlan, on_line: OnLine, say: Callable[[str], None]) -> ProcessExit:
    """
    Run a launch plan to its end and return the exit that ended it.

    A bag without a message of a robot does not outlive Ctrl-C or a node that rejects its input.

    `plan`: what to start. `on_line`: called with the label of a process and each line of its
    output. `say`: called with a sentence for each process that ends or stalls. Raise `BadInput` if
    it cannot be started, or would publish /clock and another flight is on the ROS domain.
    """
    # A folder that exists already may hold somebody's bag, which the recorder will not overwrite
    own_bags = [bag for bag in list_bags(plan) if not bag.exists()]
    try:
        outcome = supervise_graph(plan, on_line, say)
    except KeyboardInterrupt:
        remove_unflown_bags(own_bags)
        raise
    if is_refusal(outcome):
        remove_unflown_bags(own_bags)
    return outcome


def supervise_graph(plan: LaunchPlan, on_line: OnLine, say: Callable[[str], None]) -> ProcessExit:
    """Start the processes of a plan, follow them to the end, and stop those that remain."""
    with ExitStack() as stack:
        if robots := list_simulated_robots(plan):
            # Only simulated time is exclusive; real drones may share a domain
            stack.enter_context(DomainLock(*robots))
        listener = stack.enter_context(DiagnosticsListener(*plan.namespaces))
        lookout = StallMonitor(say, listener.publish_error)
        spare = find_viewers(plan)
        require_free_live_ports(plan)
        report_live_views(plan, say)
        launcher = stack.enter_context(Launcher(plan, on_line))
        while (outcome := launcher.outcome) is None:
            facts = listener.poll(GRAPH_POLL_PERIOD)
            # Other packages' nodes do not report on /diagnostics, which is not a fault
            running = [name for name in launcher.running_nodes if name not in spare]
            silent = listener.find_silent_nodes(running, required=False)
            lookout.report_stalled_nodes(facts, silent, listener.find_pending_nodes(running))
            for end in launcher.poll():
                going_on = '; the run continues' if launcher.outcome is None else ''
                # The caller shows the sentence of a node that rejects its input
                if end is not launcher.outcome or not is_refusal(end):
                    say(f'{end.sentence}{going_on}.')
                if not end.success and end.name not in spare:
                    listener.publish_error(f'{end.sentence}.')
        listener.wait_until_received()
        return outcome


def list_bags(plan: LaunchPlan) -> list[Path]:
    """Return the folders to which the recorders of a plan write."""
    values = [
        process.parameters
        for process in plan.processes
        if (process.package, process.executable) == RECORDER_PROGRAM
    ]
    return [Path(str(each['bag'])) for each in values if 'bag' in each]


def list_simulated_robots(plan: LaunchPlan) -> list[str]:
    """Return the robots that a plan simulates or replays."""
    return [
        robot
        for process in plan.processes
        if (process.package, process.executable) in TELLERS
        for robot in str(process.parameters.get('robots', '')).split()
        or [process.namespace.strip('/')]
    ]
