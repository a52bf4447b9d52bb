"""Any graph from a launch file: started, watched, and ended with its first process that ends."""

from collections.abc import Callable
from contextlib import ExitStack

from lta_analysis.blame import Lookout
from lta_analysis.session import Session
from lta_graph.child import Ended
from lta_graph.launch_file import LaunchPlan
from lta_graph.launcher import Launcher
from lta_graph.ros.listener import DiagnosticsListener
from lta_graph.watch import OnLine

LOOK = 0.1  # wall seconds between looks at the processes and the diagnostics
SIMULATOR = ('lta_sim', 'simulator')


def run_graph(plan: LaunchPlan, on_line: OnLine, say: Callable[[str], None]) -> Ended:
    """
    Run a launch plan to its end and return how the process that ended it did.

    Parameters
    ----------
    plan : LaunchPlan
        What to start.
    on_line : callable
        Called with a node's name and each line that it writes.
    say : callable
        Called with a sentence for each process that ends or hangs.

    Raises
    ------
    BadInput
        If it cannot be started, or has a simulator and another flight is on the ROS domain.

    """
    with ExitStack() as stack:
        for process in plan.processes:
            if (process.package, process.executable) == SIMULATOR:
                stack.enter_context(Session(process.namespace.strip('/')))
        watches = [
            (stack.enter_context(DiagnosticsListener(robot.strip('/'))), Lookout(say), nodes)
            for robot, nodes in nodes_of(plan).items()
        ]
        launcher = stack.enter_context(Launcher(plan, on_line))
        while (outcome := launcher.outcome) is None:
            for listener, lookout, nodes in watches:
                facts = listener.poll(LOOK / len(watches))
                # Of a node that is not ours nothing is ever heard: that is no fault of it.
                ours = [name for name in launcher.running if name in nodes]
                heard = [name for name in ours if listener.hears([name])]
                lookout.look(facts, listener.silent(heard), len(heard) == len(ours))
            for end in launcher.poll():
                say(f'{end.sentence}.')
        return outcome


def nodes_of(plan: LaunchPlan) -> dict[str, set[str]]:
    """Return the names of a plan's nodes by namespace."""
    found: dict[str, set[str]] = {}
    for process in plan.processes:
        found.setdefault(process.namespace, set()).add(process.name)
    return found
