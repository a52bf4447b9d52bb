"""
The Crazyflie bridge node: it takes the simulator's place with a real drone.

It is a lifecycle node: `configure` opens the link, `activate` accepts commands, `deactivate` lands
and disarms. Only the service `crazyflie_bridge/arm` arms. `lta_bridge.crazyflie.safety` decides
when motors may turn; this node converts and publishes.
"""

from functools import partial
import math
import os
import threading
import time
from typing import Unpack

from geometry_msgs.msg import Point, PoseStamped, TwistStamped
from lta_bridge.crazyflie import messages, readings
from lta_bridge.crazyflie.bridge_core import (
    BridgeCore,
    PositionEstimate,
    StampedReading,
    TICK_RATE,
)
from lta_bridge.crazyflie.connection_manager import ConnectionManager
from lta_bridge.crazyflie.drone_lock import DroneLock, is_port_closed
from lta_bridge.crazyflie.health_diagnostics import (
    describe_connection,
    describe_health,
)
from lta_bridge.crazyflie.link import LinkLost, MalformedPacket, Ping
from lta_bridge.crazyflie.links import create_link
from lta_bridge.crazyflie.log_table import check_log_table, LOG_BLOCKS
from lta_bridge.crazyflie.messages import CrazyfliePowerModel
from lta_bridge.crazyflie.safety import LEAVE, SafetyRequest, SafetyStage
from lta_bridge.parameters import CrazyflieBridgeSettings
from lta_config.errors import BadInput
from lta_config.schema.crazyflie_file import find_crazyflie, hash_airframe
from lta_graph.health import HealthLevel
from lta_graph.inbox import InboxStep
from lta_graph.reach import describe_reach
from lta_graph.ros.command_mux import CommandMux
from lta_graph.ros.contained_node import NodeOptions
from lta_graph.ros.device import DeviceNode
from lta_graph.ros.message_validation import find_fault
from lta_graph.ros.parameters import NodeParameters
from lta_graph.ros.process import run_node
from lta_graph.ros.publisher_conflict import CommanderWatch
from lta_graph.ros.stamps import from_stamp, to_stamp
from lta_graph.ros.startup import ReaderLinks
from lta_model.vehicle import load_vehicle
from nav_msgs.msg import Odometry
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.lifecycle import LifecycleState, TransitionCallbackReturn
from std_srvs.srv import SetBool, Trigger

HEARING = 5.0  # s to wait for all readers before arming; a user's own node may never match
DISARM_CONFIRM_TIME = 1.0  # s of LEAVE for the drone to confirm disarming
ALOFT = (SafetyStage.READY, SafetyStage.FLYING, SafetyStage.LANDING)
DEAD = 2.0  # s of silence before reconnecting: log blocks may be gone (firmware #428)


class CrazyflieBridge(DeviceNode):
    """Publish the sensor data of a Crazyflie, and send it the graph's commands."""

    def __init__(self, **options: Unpack[NodeOptions]) -> None:
        super().__init__('crazyflie_bridge', 'Crazyflie', **options)
        self.health.set_fact(describe_reach(os.environ))
        check_log_table(LOG_BLOCKS)
        self._outputs = {
            'imu': self.create_output('imu'),
            'range': self.create_output('range'),
            'pressure': self.create_output('pressure'),
            'battery': self.create_output('battery'),
        }
        settings = self._settings = NodeParameters(self, CrazyflieBridgeSettings).value
        vehicle = self._vehicle = load_vehicle(settings.vehicle)
        self._names = vehicle.rotor_names
        self._consumption = CrazyfliePowerModel.from_energy(vehicle.file.energy)
        link = self._link = create_link(settings.uri, LOG_BLOCKS, self.graph_time_ns)
        file = self._file = find_crazyflie(settings.vehicle, vehicle.file.name, settings.crazyflie)
        command = settings.command or file.command
        self._bridge = BridgeCore(
            link,
            file,
            vehicle,
            command,
            watchdog=settings.watchdog in (command, 'always'),
            blind=settings.blind,
        )
        self._keeper: ConnectionManager | None = None
        self._former: ConnectionManager | None = None  # its connection may still be closing
        self.autostart = settings.autostart
        self._request = SafetyRequest()
        self._was_up, self._connected = False, 0.0
        self._pose: PoseStamped | None = None
        self._velocity: TwistStamped | None = None
        self._odom: Odometry | None = None
        self._tracked_start: Point | None = None
        self._controller = self.create_client(SetBool, 'arm')
        # The controller arms separately from the drone
        self._armed_controller = False  # whether the controller was armed
        self.create_service(SetBool, '~/arm', self._on_arm)
        self._stop = self.create_service(Trigger, '~/emergency_stop', self._on_emergency_stop)
        self._subscribe_inputs()
        # Ticks follow the wall clock, even if graph time stops.
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        self.create_timer(1.0 / TICK_RATE, self._tick, clock=steady)
        # Own thread: sensor data continue while a service callback blocks the executor
        threading.Thread(target=self._publish_events, name='crazyflie_pump', daemon=True).start()

    def _subscribe_inputs(self) -> None:
        self.subscribe_inputs(
            ['motors', 'energy/reserve'], trigger='motors', on_step=self._on_motors
        )
        for name, callback in (
            ('odom', self._on_odom),
            ('ground_truth/odom', self._on_tracked_odom),
            ('setpoint/pose', self._on_pose),
            ('setpoint/velocity', self._on_velocity),
        ):
            self.subscribe_topic(name, callback)
        self._helm = CommandMux(self, self._accept_setpoint)
        self._links = ReaderLinks(self, self.table)
        self._commanders = CommanderWatch(self, self.table)

    @property
    def _is_linked(self) -> bool:
        return self._keeper is not None and self._keeper.up

    # Transitions.

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Open the link, and keep it open."""
        try:
            if self._former is not None and not self._former.close(0.0):
                raise BadInput(
                    'The previous connection to the Crazyflie is still closing; try again in a '
                    'few seconds.'
                )
            # Two programs that command one drone would fight each other
            claim = DroneLock(self._settings.uri)
        except BadInput as error:
            self.refusal = str(error)
            self.get_logger().error(self.refusal)
            return TransitionCallbackReturn.FAILURE
        # The manager releases the lock, because its connection may outlive this node's interest.
        self._keeper = ConnectionManager(
            self._link,
            self._file.expected,
            claim.close,
            self._vehicle.battery_compensated,
            partial(is_port_closed, self._settings.uri),
            self._settings.patience,
            hash_airframe(self._vehicle.file, self._file),
        )
        return super().on_configure(state)

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Land if it flies, and disarm."""
        self.active = False
        self._wait_until_stopped()
        return super().on_deactivate(state)

    def _wait_until_stopped(self) -> None:
        """Tick until no motor turns; the state machine lands the drone."""
        until = time.monotonic() + LEAVE
        flew = self._bridge.is_busy
        while self._bridge.is_busy and time.monotonic() < until:
            self._tick_and_wait()
        # A request to disarm may be lost: go on until the supervisor confirms it.
        until = min(until, time.monotonic() + DISARM_CONFIRM_TIME)
        while flew and self._is_linked and self._bridge.is_armed and time.monotonic() < until:
            self._tick_and_wait()
        if flew:  # let a recorder receive the reason before this node shuts down
            self.update_health()
            self.publish_health()

    def _tick_and_wait(self) -> None:
        """Run a tick within a callback, serving only the emergency stop meanwhile."""
        with self._stop.handle:
            request, header = self._stop.handle.service_take_request(Trigger.Request)
        if header is not None:
            answer = self._on_emergency_stop(request, Trigger.Response())
            self._stop.send_response(answer, header)
        self._tick()
        time.sleep(1.0 / TICK_RATE)

    def release_device(self) -> None:
        """Land, disarm, and close the link, in this order."""
        self.active = False
        self._wait_until_stopped()
        if self._keeper is not None:
            if self._keeper.up:
                self._link.request_arming(False)
            self._keeper.close()
            self._former, self._keeper = self._keeper, None

    # Services.

    def _on_arm(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        """Arm or disarm, and answer with the confirmed state."""
        self._find_rivals()
        why = self._bridge.find_arming_refusal(self.graph_time_ns(), self._is_linked, self.active)
        if not self._is_linked and self._keeper is not None and self._keeper.why:
            why = self._keeper.why
        if not (request.data and why):
            if request.data and self._bridge.state.stage is SafetyStage.DISARMED:
                self._wait_for_links()
            self._request = self._request._replace(arm=request.data)
            self._tick()
            while self._bridge.state.stage is SafetyStage.ARMING:
                self._tick_and_wait()
            why = self._bridge.state.why
        stage = self._bridge.state.stage
        armed = stage in (SafetyStage.READY, SafetyStage.FLYING)
        response.success = armed == request.data
        response.message = stage.value if armed or not why else f'{stage.value}: {why}'
        return response

    def _find_rivals(self) -> None:
        """Look for unknown nodes that publish commands, and report them."""
        strangers = self._commanders.find_strangers()
        permits = self._settings.allow_other_commanders
        self._bridge.rivals = '' if permits else strangers
        if strangers:
            level = HealthLevel.WARN if permits else HealthLevel.ERROR
            self.health.report('commanders', level, strangers)
        elif 'commanders' in self.health:
            text = 'only the nodes of the flight command the drone'
            self.health.report('commanders', HealthLevel.OK, text)

    def _wait_for_links(self) -> None:
        """Wait until all topics have their readers, so that no message of a flight is lost."""
        until = time.monotonic() + HEARING
        while (
            short := self._links.find_unmatched_topics(self.count_readers())
        ) and time.monotonic() < until:
            self._tick_and_wait()
        words = (
            f'armed before all subscribers of {", ".join(short)} were found; the first messages '
            'may be lost'
        )
        if short:
            self.health.report('start', HealthLevel.WARN, words)

    def _on_emergency_stop(
        self, _: Trigger.Request, response: Trigger.Response
    ) -> Trigger.Response:
        self._request = self._request._replace(stop=True)
        self._tick()
        response.success, response.message = True, self._bridge.state.why
        return response

    # Commands of the graph.

    def _on_motors(self, step: InboxStep) -> None:
        if self._bridge.sends_duties:
            newest = step.messages['motors'][-1]
            stamp = from_stamp(newest.header.stamp)
            self._bridge.accept_command(messages.to_duties_command(newest, self._names, stamp))

    def _on_odom(self, odom: Odometry) -> None:
        # Invalid: the previous estimate stays, and ages
        where = None if find_fault(odom) else messages.to_position(odom)
        if where is not None:
            self._odom = odom
            self._bridge.update_position(where)

    def _on_tracked_odom(self, odom: Odometry) -> None:
        # Of a tracker, for the limits of height and distance only; nothing is controlled by it
        if find_fault(odom):
            return
        here = odom.pose.pose.position
        if self._tracked_start is None:
            self._tracked_start = here
        start = self._tracked_start
        distance = math.hypot(here.x - start.x, here.y - start.y)
        stamp = from_stamp(odom.header.stamp)
        self._bridge.update_tracked_position(PositionEstimate(here.z, distance, stamp))

    def _on_pose(self, pose: PoseStamped) -> None:
        self._pose = pose

    def _on_velocity(self, velocity: TwistStamped) -> None:
        self._velocity = velocity
        self._accept_setpoint()

    def _accept_setpoint(self) -> None:
        """Send a setpoint to the core; the navigator's age counts from the end of its block."""
        pose, velocity = self._helm.select_setpoint(self._pose, self._velocity)
        # A hover command needs height and heading of the setpoint, and the estimated heading
        if self._bridge.command != 'setpoint' or not (pose and velocity and self._odom):
            return
        # The older half determines the age of the command
        oldest = min(from_stamp(pose.header.stamp), from_stamp(velocity.header.stamp))
        late = 0 if self._helm.held else self.table['setpoint/velocity'].latency_ns
        self._bridge.accept_command(
            messages.to_hover_command(pose, velocity, self._odom, oldest + late)
        )

    # Periodic work.

    def _tick(self) -> None:
        up, now_ns = self._is_linked, self.graph_time_ns()
        pose, _ = self._helm.select_setpoint(self._pose, self._velocity)
        self._bridge.wanted_height = math.inf if pose is None else pose.pose.position.z
        # A new connection: nothing known from the last one is valid
        if up and not self._was_up:
            self._bridge.clear_connection_data()
            self._connected = time.monotonic()
        self._was_up = up
        # Each request counts for one tick only
        request, self._request = self._request, SafetyRequest()
        before = self._bridge.state.stage
        self._bridge.tick(time.monotonic(), now_ns, up, self.active, request)
        if self._bridge.state.stage is not before:
            self.update_health()  # a landing may be over before the next look
        self._arm_controller()
        # A fresh connection needs time for its first log packets
        if up and time.monotonic() - self._connected > DEAD:
            silence = self._bridge.collect_safety_inputs(now_ns, up, self.active).silence
            if silence > DEAD and self._keeper is not None:
                self._keeper.reconnect(f'no packets from the Crazyflie for {silence:.1f} s')

    def _arm_controller(self) -> None:
        """Arm the controller with the drone, so that its integrators do not wind up before."""
        stage = self._bridge.state.stage
        arm = stage in ALOFT and self._bridge.sends_duties
        if arm != self._armed_controller and self._controller.service_is_ready():
            self._controller.call_async(SetBool.Request(data=arm))
            self._armed_controller = arm

    def _publish_events(self) -> None:
        """Handle the events of the link as they arrive."""
        while True:
            event = self._link.events.get()
            if isinstance(event, LinkLost):
                if self._keeper is not None:
                    self._keeper.reconnect(event.why)
            elif isinstance(event, Ping):
                self._bridge.add_round_trip(event.round_trip)
            elif isinstance(event, MalformedPacket):
                self._bridge.malformed.add(event.why)
            else:
                self._publish_reading(self._bridge.receive_packet(event))

    def _publish_reading(self, stamped: StampedReading) -> None:
        stamp, out = to_stamp(stamped.stamp_ns), self._outputs
        match stamped.reading:
            case readings.ImuReading() as motion:
                out['imu'].publish(messages.to_imu(stamp, motion, self._bridge.attitude))
            case readings.AirReading() as felt:
                distance, pressure = messages.to_range_pressure(stamp, felt)
                out['range'].publish(distance)
                out['pressure'].publish(pressure)
            case readings.PowerReading() as power:
                # The Crazyflie has no current sensor: estimate the current from the duties
                if self._bridge.motors is not None and power.voltage > 0.0:
                    current = self._consumption.cell_current(
                        self._bridge.motors.duties, power.voltage
                    )
                    out['battery'].publish(messages.to_battery(stamp, power.voltage, current))

    def update_health(self) -> None:
        """Report the health of the link and the drone."""
        why, attempts = describe_connection(self._keeper)
        inputs = self._bridge.collect_safety_inputs(
            self.graph_time_ns(), self._is_linked, self.active
        )
        for fact in describe_health(self._bridge, why, attempts, self._link.protocol, inputs):
            self.health.set_fact(fact)

    def publish_health(self) -> None:
        """Look for rivals, and report."""
        self._find_rivals()
        super().publish_health()


def main(args: list[str] | None = None) -> None:
    """Run the node until it is stopped."""
    run_node(CrazyflieBridge, args)
