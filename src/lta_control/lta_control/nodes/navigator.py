"""Navigator node: convert the light estimate to heading, altitude and speed."""

from functools import partial
import math
import time
from typing import Any

from lta_config.errors import BadInput
from lta_config.settings import setting
from lta_control.cascade import CascadeMeasurement, Setpoint
from lta_control.commanded_flight import (
    check_commanded,
    CommandedFlight,
    FlightTask,
    TaskKind,
    TaskLimits,
)
from lta_control.flight_step import has_overturned, TILT_LIMIT
from lta_control.guidance import Guidance, GuidanceInputs
from lta_control.messages import (
    ACTION_TYPES,
    from_setpoint,
    from_task_progress,
    from_task_result,
    to_air_motions,
    to_attitude,
    to_cascade_measurement,
    to_diodes,
    to_lamp,
    to_task_value,
    update_reserve_report,
)
from lta_control.mission import MissionSettings
from lta_control.odometry.air_reckoning import AirReckoning
from lta_control.phases import Phase
from lta_control.reserve import (
    explain_restriction,
    FlightPermission,
    ReserveReport,
    ReserveResponseSettings,
)
from lta_control.reserve_policy import check_reserve
from lta_control.sighting import build_sight
from lta_control.strategies import check_route, find_navigation_strategy
from lta_control.strategies.protocol import LightMeasurement
from lta_graph.health import HealthLevel
from lta_graph.inbox import InboxStep
from lta_graph.ros.goal_server import GoalServer
from lta_graph.ros.message_pairing import MessagePairing
from lta_graph.ros.node import GraphNode
from lta_graph.ros.parameters import NodeParameters
from lta_graph.ros.process import run_node
from lta_model.scenario import load_course, load_route
from lta_model.vehicle import load_vehicle
from lta_msgs.msg import ActuatorDuty
from nav_msgs.msg import Odometry
from std_msgs.msg import Bool, Float64

SILENCE = 10.0  # wall seconds without a step after which a task ends


class NavigatorParameters(MissionSettings):
    """The mission and its strategy."""

    vehicle: str = setting('gtmab', 'Vehicle name or file.', fixed=True)
    strategy: str = setting('bag', 'Navigation strategy.', fixed=True)
    scenario: str = setting(
        '', 'Scenario name or file. If it has a course or a route, the drone flies it.', fixed=True
    )
    commanded: bool = setting(
        False,
        'Whether the drone waits on the ground for the actions take_off, go_to_lamp and land. '
        'Needs the strategy homing.',
        fixed=True,
    )
    limits: TaskLimits = setting(TaskLimits(), 'Time limits of the actions.')
    reserve: ReserveResponseSettings = setting(
        ReserveResponseSettings(), 'What to do when the charge falls to the energy reserve.'
    )


class Navigator(GraphNode):
    """Publish setpoints for each light estimate."""

    def __init__(self) -> None:
        super().__init__('navigator')
        self._pose = self.create_output('setpoint/pose')
        self._velocity = self.create_output('setpoint/velocity')
        self._beacon = self.create_output('light/beacon')
        self._settings = NodeParameters(self, NavigatorParameters)
        self._strategy = find_navigation_strategy(self._settings.value.strategy)
        self._course = load_course(self._settings.value.scenario)
        self._route = load_route(self._settings.value.scenario)
        check_route(self._strategy, len(self._route))
        self._scale = 1.0
        if self._strategy.ranges:
            self._scale = load_vehicle(self._settings.value.vehicle).diodes.gain_scale
        self._guidance: Guidance | CommandedFlight = Guidance(self._course, self._route)
        check_reserve(self._settings.value.reserve, self._strategy)
        self._word: ReserveReport | None = None  # latest energy report; None: stay on the ground
        light = self.table['photodiodes']
        self._block_ns = light.period_ns
        self._measured: CascadeMeasurement | None = None
        self._odom: Odometry | None = None
        # Three blocks of estimates: the light of a block arrives after its end
        control_ns = self.table.control_ns
        self._reckoning = AirReckoning(control_ns, 3 * self._block_ns // control_ns)
        self._airspeeds = MessagePairing()
        inputs = self.table.read_by('navigator')
        self.subscribe_inputs(inputs, trigger='light/estimate', on_step=self._on_step)
        self._commands: FlightCommands | None = None
        if self._settings.value.commanded:
            self._commands = FlightCommands(self, self._build_commanded_flight())
            self._guidance = self._commands.flight

    def _build_commanded_flight(self) -> CommandedFlight:
        settings = self._settings.value
        check_commanded(self._strategy, self._course is not None)
        return CommandedFlight(
            settings.limits, load_vehicle(settings.vehicle).hull_height_on_floor
        )

    def _on_step(self, step: InboxStep) -> None:
        stamped = self._airspeeds.pair_messages(step.valid['odom'], step.valid['airspeed'])
        self._reckoning.add_motions(to_air_motions(stamped))
        if stamped:
            _, self._odom, airspeed = stamped[-1]
            self._measured = to_cascade_measurement(self._odom, airspeed)
        self._word = update_reserve_report(self._word, step)
        if not self._reckoning.history and not self.lockstep:
            return  # light may arrive before an estimate; in lockstep every node answers
        estimate = step.messages['light/estimate'][-1]
        setpoint = self._compute_setpoint(step, self._measured)
        pose, velocity = from_setpoint(estimate.header.stamp, setpoint)
        self._pose.publish(pose)
        self._velocity.publish(velocity)
        self._beacon.publish(Float64(data=self._guidance.beacon))
        if self._commands is not None:
            overturned = self._odom is not None and has_overturned(
                to_attitude(self._odom), math.cos(TILT_LIMIT)
            )
            self._commands.update('the drone turned over' if overturned else '')

    def _compute_setpoint(self, step: InboxStep, measured: CascadeMeasurement | None) -> Setpoint:
        """Return the setpoint, and report the mission's state."""
        settings = self._settings.value
        inputs = GuidanceInputs(
            settings, settings.reserve, self._strategy, step.stamp_ns,
            self._build_sight(step), measured, self._word,
        )  # fmt: skip
        try:
            setpoint = self._guidance.choose_setpoint(inputs)
        except BadInput as error:  # of a strategy from a file
            # The bag holds why; the node ends, and without setpoints the drone lands
            self.health.report('mission', HealthLevel.ERROR, f'{error}')
            self.publish_health()
            raise
        order = self._guidance.permission
        if self._commands is not None:
            self._commands.flight.limits = settings.limits
        doing = str(self._guidance.mission.phase) if self._course is None else 'course'
        if self._route and order is FlightPermission.FLY and self._commands is None:
            self._report_lamp(doing)
        else:
            self._report_mission(doing, order, step.stamp_ns)
        return setpoint

    def _report_mission(self, doing: str, order: FlightPermission, now_ns: int) -> None:
        """Report what the drone is doing, and why the energy restricts it."""
        if order is FlightPermission.FLY:
            self.health.report('mission', HealthLevel.OK, doing)
            return
        why = explain_restriction(self._settings.value.reserve, self._word, now_ns)
        resting = self._guidance.mission.phase is Phase.REST and self._course is None
        text = f'no take-off: {why}' if resting else f'{doing}: {why}'
        level = HealthLevel.ERROR if order is FlightPermission.DOWN else HealthLevel.WARN
        self.health.report('mission', level, text)

    def _report_lamp(self, doing: str) -> None:
        """Report what the drone is doing, and at which lamp of its route."""
        mission = self._guidance.mission
        (here, _), (next_lamp, frequency) = self._route[mission.leg], self._route[mission.target]
        level, text = HealthLevel.OK, f'{doing}: {here}'
        if mission.refused:
            following, beat = self._route[mission.leg + 1]
            level = HealthLevel.WARN
            text = f'cannot receive {following} at {beat:g} Hz; staying at {here}'
        self.health.report(
            'mission', level, text, lamp=here, listening_for=f'{next_lamp} at {frequency:g} Hz'
        )

    def _build_sight(self, step: InboxStep) -> LightMeasurement:
        """Return the light with the drone's motion at the middle of its block."""
        # A block is stamped with its first sample; the bearing is that of its middle
        then = self._reckoning.find_nearest(step.stamp_ns + self._block_ns // 2)
        axes, amplitudes = to_diodes(step.last_valid('light/peaks'))
        return build_sight(
            to_lamp(step.last_valid('light/estimate')),
            axes,
            amplitudes,
            then,
            self._block_ns * 1e-9,
            self._scale,
        )

    def _monitor_inputs(self) -> None:
        """Report missing inputs, without which no task goes on."""
        super()._monitor_inputs()
        missing = [] if self.lockstep else self.list_missing_inputs()
        if self._commands is not None and missing:
            self._commands.check_silence(missing)


class FlightCommands:
    """
    The actions of a commanded flight, and the person who may take over.

    `node`: the navigator. `flight`: its decisions.
    """

    def __init__(self, node: GraphNode, flight: CommandedFlight) -> None:
        self.flight = flight
        self._held = False
        self._stepped = time.monotonic()
        if not node.lockstep:
            node.subscribe_topic('teleop/held', self._on_takeover)
            node.subscribe_topic('motors', self._on_motors)
        self._servers = [
            GoalServer(
                node,
                action,
                kind.value,
                partial(self._begin, kind),
                flight.cancel,
                partial(from_task_result, flight),
                partial(from_task_progress, kind, flight),
            )
            for kind, action in ACTION_TYPES.items()
        ]

    def check_silence(self, missing: list[str]) -> None:
        """End the task if there has been no step for long; the controller lands long before."""
        if time.monotonic() - self._stepped > SILENCE:
            self.update(f'no messages on {", ".join(missing)}')

    def update(self, fault: str = '') -> None:
        """Follow a step, or a fault, in the actions."""
        self._stepped = time.monotonic()
        if fault:
            self.flight.fail(fault)
        elif self._held:
            self.flight.yield_to_person()
        for server in self._servers:
            server.update()

    def _begin(self, kind: TaskKind, goal: Any) -> FlightTask:  # noqa: ANN401 - a message
        return self.flight.request(kind, to_task_value(kind, goal))

    def _on_motors(self, motors: ActuatorDuty) -> None:
        self.flight.motors_turn = any(motors.duty)

    def _on_takeover(self, held: Bool) -> None:
        self._held = held.data
        if self._held:
            self.update()


def main(args: list[str] | None = None) -> None:
    """Run the node until it is shut down."""
    run_node(Navigator, args)
