"""
Add the action `supervise` to `ros2 launch`, as `lta launch` has it (`lta_graph.launch_actions`).

ROS 2 finds this module by the entry point `launch.frontend.launch_extension`. Without it, a
launched system whose nodes have died exits with status 0, every node reports a wrong argument on
its own, and a file for each parameter stays in the temporary folder.
"""

import atexit
from importlib.metadata import entry_points
from pathlib import Path
import shutil
import signal
import sys
import tempfile
from typing import Any

from launch.action import Action
from launch.actions import RegisterEventHandler, Shutdown
from launch.event_handlers import OnProcessExit
from launch.events.process import ProcessExited
from launch.frontend import Entity, expose_action, Parser
from launch.utilities import perform_substitutions
from lta_config.errors import BadInput
from lta_graph.child_process import signal_name
from lta_graph.launch_file import list_arguments, load_plan, ONE

from launch import LaunchContext

CHECKS = 'lta.launch_checks'  # entry points: functions that take a LaunchPlan and raise BadInput
PLANNED = 'lta_planned'  # name of the shared set in the launch context


@expose_action('supervise')
class SuperviseAction(Action):
    """
    Check the arguments before anything starts, and fail the run if a node dies.

    `planned`: names of the nodes, separated by spaces, whose end with status 0 is planned.
    `processes`: `one` is refused: `ros2 launch` cannot run nodes of Python in one process.
    """

    def __init__(self, *, planned: list[Any], processes: list[Any], **more: Any) -> None:  # noqa: ANN401 - of launch
        super().__init__(**more)
        self._planned, self._processes = planned, processes

    @classmethod
    def parse(cls, entity: Entity, parser: Parser) -> tuple[type['SuperviseAction'], dict]:
        """Return the class and its arguments, read from a launch file."""
        _, keywords = super().parse(entity, parser)
        keywords['planned'] = parser.parse_substitution(entity.get_attr('planned'))
        processes = entity.get_attr('processes', optional=True) or ''
        keywords['processes'] = parser.parse_substitution(processes)
        # Only our launcher has use for it
        entity.get_attr('apart', optional=True)
        return cls, keywords

    def execute(self, context: LaunchContext) -> list[Action] | None:
        """Check the launch and watch its processes; an included file only adds its names."""
        if perform_substitutions(context, self._processes) == ONE:
            raise BadInput(
                'ros2 launch starts every node in a process of its own; for processes:=one use '
                '"ros2 run lta_cli lta launch" or "ros2 run lta_graph one_process".'
            )
        names = perform_substitutions(context, self._planned).split()
        collected = context.get_locals_as_dict().get(PLANNED)
        if collected is not None:
            collected.update(names)
            return None
        check_launch(context)
        planned = set(names)
        context.extend_globals({PLANNED: planned})

        def fail(event: ProcessExited, context: LaunchContext) -> None:
            fail_run(event, context, planned)

        # launch_ros writes a file for each parameter into the temporary folder, and removes none
        tempfile.tempdir = tempfile.mkdtemp(prefix='lta_launch_')
        atexit.register(shutil.rmtree, tempfile.tempdir, ignore_errors=True)
        # Without a handler of Python, that of launch is never called: SIGTERM kills the launch
        if signal.getsignal(signal.SIGTERM) == signal.SIG_DFL:
            signal.signal(signal.SIGTERM, lambda *_: None)
        return [RegisterEventHandler(OnProcessExit(on_exit=fail))]


def check_launch(context: LaunchContext) -> None:
    """
    Check the present launch file with its arguments as `lta launch` does.

    Raise `BadInput` if it does; `ros2 launch` prints the sentence and exits with status 1.
    """
    path = Path(context.locals.current_launch_file_path)
    declared = [item.name for item in list_arguments(path)]
    values = context.launch_configurations
    arguments = {name: values[name] for name in declared if name in values}
    # ROS ignores an undeclared argument; of a launch file that includes this one it may be
    if any(Path(word).name == path.name for word in sys.argv):
        arguments |= dict(word.split(':=', 1) for word in context.argv if ':=' in word)
    plan = load_plan(path, arguments)
    for check in entry_points(group=CHECKS):
        check.load()(plan)


def fail_run(event: ProcessExited, context: LaunchContext, planned: set[str]) -> None:
    """Raise if the exit of a process ends the run unplanned, which makes the status 1."""
    ends_run = any(isinstance(item, Shutdown) for item in event.action.get_sub_entities())
    if context.is_shutdown or not ends_run:
        return
    # A launch file that includes ours may start programs that are no nodes
    node, status = getattr(event.action, 'node_name', None), event.returncode
    if status == 0 and (node is None or node.rpartition('/')[2] in planned):
        return
    how = f'ended with status {status}' if status >= 0 else f'was killed by {signal_name(-status)}'
    raise BadInput(f'{node or event.process_name} {how}, which ends the run.')
