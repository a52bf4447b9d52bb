"""Navigator node: convert the light estimate to heading, altitude and speed."""

from functools import partial
import math
import time
from typing import Unpack

from lta_config.errors import BadInput
from lta_config.settings import setting
from lta_control.actions.messages import (
    ACTION_TYPES,
    find_goal_obstacle,
    from_task_progress,
    from_task_result,
    to_task,
)
from lta_control.actions.tasks import FlightTask, TaskLimits
from lta_control.cascade import CascadeMeasurement, Setpoint
from lta_control.commanded_flight import check_commanded, CommandedFlight
from lta_control.flight_report import describe_leg, describe_mission, describe_tracking
from lta_control.flight_step import has_overturned, TILT_LIMIT
from lta_control.guidance import Guidance, GuidanceInputs
from lta_control.messages import (
    from_setpoint,
    to_air_motions,
    to_attitude,
    to_cascade_measurement,
    to_diodes,
    to_lamp,
    to_odom_motion,
    to_tracked,
    update_reserve_report,
)
from lta_control.mission import MissionSettings
from lta_control.odometry.airspeed import AirReckoning
from lta_control.odometry.tracked_motion import LocatedMotion, Locator, OdomMotion, TrackedMotion
from lta_control.reserve import (
    check_reserve,
    FlightPermission,
    ReserveReport,
    ReserveResponseSettings,
)
from lta_control.sighting import build_sight
from lta_control.strategies import check_route, find_navigation_strategy
from lta_control.strategies.protocol import LightMeasurement
from lta_graph.health import HealthLevel
from lta_graph.inbox import InboxStep
from lta_graph.ros.contained_node import NodeOptions
from lta_graph.ros.goal_server import GoalServer
from lta_graph.ros.node import GraphNode
from lta_graph.ros.parameters import NodeParameters
from lta_graph.ros.process import run_node
from lta_graph.ros.stamps import MessagePairing
from lta_model.scenario import load_course, load_room_size, load_route
from lta_model.vehicle import load_vehicle
from lta_msgs.msg import ActuatorDuty
from nav_msgs.msg import Odometry
from std_msgs.msg import Bool, Float64

SILENCE_LIMIT = 10.0  # wall seconds without a step after which a task ends


class NavigatorParameters(MissionSettings):
    """The mission and its strategy."""

    vehicle: str = setting('gtmab', fixed=True)
    """Vehicle name or file."""
    strategy: str = setting('homing', fixed=True)
    """Navigation strategy."""
    scenario: str = setting('', fixed=True)
    """Scenario name or file. If it has a course or a route, the drone flies it."""
    commanded: bool = setting(False, fixed=True)
    """
    Whether the drone waits on the ground for the actions take_off, go_to_lamp, go_to_pose,
    follow_path and land. Needs the strategy homing.
    """
    limits: TaskLimits = setting(TaskLimits())
    """Limits of the actions."""
    reserve: ReserveResponseSettings = setting(ReserveResponseSettings())
    """What to do when the charge falls to the energy reserve."""


class Navigator(GraphNode):
    """Publish setpoints for each light estimate."""

    def __init__(self, **options: Unpack[NodeOptions]) -> None:
        super().__init__('navigator', **options)
        self._pose = self.create_output('setpoint/pose')
        self._velocity = self.create_output('setpoint/velocity')
        self._beacon = self.create_output('light/beacon')
        self._settings = NodeParameters(self, NavigatorParameters)
        settings = self._settings.value
        self._strategy = find_navigation_strategy(settings.strategy)
        self._course = load_course(settings.scenario)
        self._route = load_route(settings.scenario)
        check_route(self._strategy, len(self._route))
        check_reserve(settings.reserve, self._strategy)
        vehicle = load_vehicle(settings.vehicle)
        self._scale = vehicle.diodes.gain_scale if self._strategy.ranges else 1.0
        self._word: ReserveReport | None = None  # latest energy report; None: stay on the ground
        self._block_ns = self.table['photodiodes'].period_ns
        self._measured: CascadeMeasurement | None = None
        self._locator = Locator()
        self._located: LocatedMotion | None = None
        self._tracked: TrackedMotion | None = None  # since the last step
        self._overturned = False
        # Three blocks of estimates: the light of a block arrives after its end
        control_ns = self.table.control_ns
        self._reckoning = AirReckoning(control_ns, 3 * self._block_ns // control_ns)
        self._airspeeds = MessagePairing()
        self.subscribe_inputs(
            [
                'odom',
                'airspeed',
                'light/peaks',
                'light/estimate',
                'energy/status',
                'energy/reserve',
            ],
            trigger='light/estimate',
            on_step=self._on_step,
        )
        self._guidance: Guidance | CommandedFlight = Guidance(self._course, self._route)
        self._servers: list[GoalServer[FlightTask]] = []
        self._held = False  # whether a person has control
        self._stepped = time.monotonic()
        if settings.commanded:
            check_commanded(self._strategy, self._course is not None)
            room = load_room_size(settings.scenario)
            self._guidance = CommandedFlight(settings.limits, vehicle.hull_height_on_floor, room)
            self._serve_tasks(self._guidance)

    def _serve_tasks(self, flight: CommandedFlight) -> None:
        """Offer the actions of a commanded flight, and follow the person who may take over."""
        if not self.lockstep:
            self.subscribe_topic('teleop/held', self._on_takeover)
            self.subscribe_topic('motors', self._on_motors)
            self.subscribe_topic('tracker/odom', self._on_tracked)
        self._servers = [
            GoalServer(
                self,
                action,
                kind.value,
                partial(find_goal_obstacle, flight),
                lambda goal: flight.request(*to_task(goal)),
                flight.cancel,
                partial(from_task_result, flight),
                partial(from_task_progress, kind, flight),
            )
            for kind, action in ACTION_TYPES.items()
        ]

    def _on_step(self, step: InboxStep) -> None:
        stamped = self._airspeeds.pair_messages(step.valid['odom'], step.valid['airspeed'])
        self._reckoning.add_motions(to_air_motions(stamped))
        if stamped:
            _, odom, airspeed = stamped[-1]
            self._measured = to_cascade_measurement(odom, airspeed)
            self._locate(to_odom_motion(odom, airspeed))
            self._overturned = has_overturned(to_attitude(odom), math.cos(TILT_LIMIT))
        self._word = update_reserve_report(self._word, step)
        if not self._reckoning.history and not self.lockstep:
            return  # light may arrive before an estimate; in lockstep every node answers
        setpoint = self._choose_setpoint(step)
        stamp = step.messages['light/estimate'][-1].header.stamp
        pose, velocity = from_setpoint(stamp, setpoint)
        self._pose.publish(pose)
        self._velocity.publish(velocity)
        self._beacon.publish(Float64(data=self._guidance.beacon))
        self._update_tasks('the drone turned over' if self._overturned else '')

    def _on_tracked(self, message: Odometry) -> None:
        self._tracked = to_tracked(message)

    def _locate(self, motion: OdomMotion) -> None:
        """Locate the drone for the places that it holds, and report a tracker that is lost."""
        was_tracked = self._located is not None and self._located.tracked
        self._located = self._locator.locate(motion, self._tracked)
        self._tracked = None
        if self._located.tracked or was_tracked:
            self.health.set_fact(describe_tracking(self._located.tracked))

    def _choose_setpoint(self, step: InboxStep) -> Setpoint:
        """Return the setpoint, and report the mission's state."""
        settings, guidance = self._settings.value, self._guidance
        sight, measured = self._build_sight(step), self._measured
        inputs = GuidanceInputs(
            settings, settings.reserve, self._strategy, step.stamp_ns, sight, measured,
            self._word, self._located,
        )  # fmt: skip
        if isinstance(guidance, CommandedFlight):
            guidance.limits = settings.limits
        try:
            setpoint = guidance.choose_setpoint(inputs)
        except BadInput as error:  # of a strategy from a file
            # The bag holds why; the node ends, and without setpoints the drone lands
            self.health.report('mission', HealthLevel.ERROR, f'{error}')
            self.publish_health()
            raise
        flies = guidance.permission is FlightPermission.FLY
        if self._route and flies and isinstance(guidance, Guidance):
            self.health.set_fact(describe_leg(guidance.mission, self._route))
        else:
            mission = guidance.mission if self._course is None else None
            why = inputs.explain_restriction()
            self.health.set_fact(describe_mission(mission, guidance.permission, why))
        return setpoint

    def _build_sight(self, step: InboxStep) -> LightMeasurement:
        """Return the light with the drone's motion at the middle of its block."""
        # A block is stamped with its first sample; the bearing is that of its middle
        then = self._reckoning.find_nearest(step.stamp_ns + self._block_ns // 2)
        axes, amplitudes = to_diodes(step.last_valid('light/peaks'))
        lamp, interval = to_lamp(step.last_valid('light/estimate')), self._block_ns * 1e-9
        return build_sight(lamp, axes, amplitudes, then, interval, self._scale)

    def _update_tasks(self, fault: str = '') -> None:
        """Follow a step, or a fault, in the actions."""
        self._stepped = time.monotonic()
        if isinstance(self._guidance, CommandedFlight):
            if fault:
                self._guidance.fail(fault)
            elif self._held:
                self._guidance.yield_to_person()
        for server in self._servers:
            server.update()

    def _on_takeover(self, held: Bool) -> None:
        self._held = held.data
        if self._held:
            self._update_tasks()

    def _on_motors(self, motors: ActuatorDuty) -> None:
        if isinstance(self._guidance, CommandedFlight):
            self._guidance.motors_turn = any(motors.duty)

    def _monitor_inputs(self) -> None:
        """Report missing inputs, without which no task goes on."""
        super()._monitor_inputs()
        missing = [] if self.lockstep or not self._servers else self.list_missing_inputs()
        # The controller lands long before
        if missing and time.monotonic() - self._stepped > SILENCE_LIMIT:
            self._update_tasks(f'no messages on {", ".join(missing)}')


def main(args: list[str] | None = None) -> None:
    """Run the node until it is shut down."""
    run_node(Navigator, args)
