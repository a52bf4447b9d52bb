"""
Controller node: convert estimate and setpoint to duties.

The node fails safe. The duties are zero until it is armed and the estimate is known. When
setpoints go stale it holds level and then descends. After an emergency stop, or when the vehicle
has overturned, the duties stay zero.
"""

import math
from typing import NamedTuple

from geometry_msgs.msg import PoseStamped, TwistStamped, TwistWithCovarianceStamped
from lta_config.settings import setting, Settings
from lta_control.allocation import create_working_array
from lta_control.altitude import is_stuck, SensorWatch, watch_sensor
from lta_control.cascade import CascadeGains, CascadeMeasurement, Setpoint
from lta_control.control import (
    control_step,
    ControlMemory,
    has_landed,
    has_overturned,
    is_control_input_finite,
    LandingWatch,
    STANDSTILL,
    step_duration,
    TILT_LIMIT,
    watch_landing,
)
from lta_control.gains_file import load_gains
from lta_control.laws.onboard_law import CASCADE, OnboardLaw, vehicle_law_name
from lta_control.messages import (
    from_duties,
    is_height_lost,
    to_attitude,
    to_cascade_measurement,
    to_motion,
    to_setpoint,
)
from lta_control.vehicle_parameters import build_rotors, surge_drag_coefficients
from lta_graph.health import HealthLevel, stamp_age
from lta_graph.inbox import InboxStep
from lta_graph.ros.command_mux import CommandMux
from lta_graph.ros.node import GraphNode
from lta_graph.ros.parameters import NodeParameters
from lta_graph.ros.process import run_node
from lta_graph.ros.stamps import from_stamp
from lta_model.scenario import load_course
from lta_model.vehicle import load_vehicle
from std_srvs.srv import SetBool, Trigger

AIRSPEED_AGE_NS = 250_000_000  # ns; an airspeed further from the odometry is not used
DESCENT = 0.2  # m below the current altitude: the setpoint of a slow automatic descent


class ControllerSettings(Settings):
    """The vehicle, the gains and the time limits of stale setpoints."""

    vehicle: str = setting('gtmab', 'Vehicle name or file.', fixed=True)
    law: str = setting(
        '', 'Name of the control law. Empty: the law named in the vehicle file.', fixed=True
    )
    scenario: str = setting(
        '',
        'Scenario name or file. Test signals in its course are added to the motor commands.',
        fixed=True,
    )
    armed: bool = setting(False, 'Whether the motors are armed when the node starts.', fixed=True)
    hold_after: float = setting(
        0.5,
        'If the latest setpoint is older than this, the drone holds altitude and heading '
        'at zero speed.',
        unit='s',
        low=0.05,
        high=60.0,
    )
    land_after: float = setting(
        3.0,
        'If the latest setpoint is older than this, the drone descends and lands.',
        unit='s',
        low=0.05,
        high=600.0,
    )
    tilt_limit: float = setting(
        TILT_LIMIT,
        'If the drone tilts more than this, the motors stop.',
        unit='rad',
        low=0.1,
        high=3.2,
    )
    gains: CascadeGains = setting(
        load_gains('gtmab'), 'Gains of the cascade law; other laws load their own gains.'
    )


class TimedSetpoint(NamedTuple):
    """The messages of a setpoint, the setpoint, and the stamps of the messages. [ns]"""

    pose: PoseStamped
    velocity: TwistStamped
    setpoint: Setpoint
    pose_ns: int
    velocity_ns: int


class Controller(GraphNode):
    """Publish duties for each estimate."""

    def __init__(self) -> None:
        super().__init__('controller')
        self._motors = self.create_output('motors')
        self._settings = NodeParameters(self, ControllerSettings)
        vehicle = load_vehicle(self._settings.value.vehicle)
        self._drag = surge_drag_coefficients(vehicle)
        self._rotors = build_rotors(vehicle)
        self._names, self._reversible = vehicle.rotor_names, vehicle.reversible
        self._course = load_course(self._settings.value.scenario)
        self._begun_ns: int | None = None
        self._standing = vehicle.hull_height_on_floor
        name = self._settings.value.law or vehicle_law_name(vehicle)
        self._law = None if name == CASCADE else OnboardLaw(name, vehicle)
        self._memory = ControlMemory()
        self._landing, self._height = LandingWatch(), SensorWatch()
        self._turning = False  # whether a motor was commanded to turn
        self._scratch = create_working_array()
        self._airspeed_lost = False
        self._setpoint: TimedSetpoint | None = None
        self._last_ns: int | None = None
        self._armed = self._settings.value.armed
        self._flies = False  # whether a setpoint above the floor was followed since arming
        self._contested = False  # whether two nodes have sent setpoints since arming
        self._stopped = ''
        self.create_service(SetBool, 'arm', self._on_arm)
        self.create_service(Trigger, 'emergency_stop', self._on_emergency_stop)
        self.subscribe_inputs(
            self.table.read_by('controller'), trigger='odom', on_step=self._on_step
        )
        self._helm = CommandMux(self)

    def _on_arm(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        count = self._helm.count_commanders()
        rivals = f'{count} nodes send setpoints: stop all but one' if count > 1 else ''
        refusal = (self._stopped or rivals) if request.data else ''
        response.success, response.message = not refusal, refusal
        if not refusal:
            # Arming starts with empty integrals
            self._memory, self._flies, self._contested = ControlMemory(), False, False
            self._armed = request.data
            response.message = 'armed' if self._armed else 'disarmed'
        return response

    def publish_health(self) -> None:
        """Land a drone that two nodes steer, and report."""
        # Until it is armed anew: a motor must not start because one of them ends
        self._contested = self._armed and (self._contested or self._helm.count_commanders() > 1)
        if self._contested:
            self.health.report(
                'commanders',
                HealthLevel.ERROR,
                'several nodes sent setpoints: landing; stop all but one, and arm again',
            )
        elif 'commanders' in self.health:
            self.health.report('commanders', HealthLevel.OK, 'one node sends setpoints')
        super().publish_health()

    def _on_emergency_stop(
        self, _: Trigger.Request, response: Trigger.Response
    ) -> Trigger.Response:
        self._stop_motors(
            'emergency stop: the motors are off; restart the controller to fly again'
        )
        response.success, response.message = True, self._stopped
        return response

    def _stop_motors(self, reason: str) -> None:
        self._armed, self._stopped = False, reason
        self.health.report('motors', HealthLevel.ERROR, reason)

    def _on_step(self, step: InboxStep) -> None:
        odom = step.messages['odom'][-1]
        latest = step.latest['airspeed']
        # Not used if it belongs to another time
        near = latest and abs(from_stamp(latest.header.stamp) - step.stamp_ns) <= AIRSPEED_AGE_NS
        airspeed = latest if near else None
        measured = to_cascade_measurement(odom, airspeed)
        dt = step_duration(self._last_ns, step.stamp_ns, self.table.control_ns)
        upright = math.cos(self._settings.value.tilt_limit)
        is_controlled = self._armed and measured is not None
        if is_controlled and has_overturned(to_attitude(odom), upright):
            self._stop_motors(
                'the drone turned over: the motors are off; restart the controller to fly again'
            )
        self._height = watch_sensor(self._height, odom.pose.pose.position.z, self._turning, dt)
        # Before the first estimate no motor turns
        is_lost = self._turning and measured is None and is_height_lost(odom)
        if self._armed and (is_lost or is_stuck(self._height)):
            self._stop_motors(
                'the height is unknown, as its sensors repeat their readings or send none: the '
                'motors are off; restart the controller to fly again'
            )
        duties = self._compute_duties(step, airspeed, measured, dt)
        self._turning = any(duties)
        if self._course is not None:
            self._begun_ns = step.stamp_ns if self._begun_ns is None else self._begun_ns
            time = (step.stamp_ns - self._begun_ns) * 1e-9
            # The test signals of the scenario
            duties = self._course.excite_duties(time, duties, self._reversible)
        self._last_ns = step.stamp_ns
        self._motors.publish(from_duties(odom.header.stamp, self._names, duties))

    def _compute_duties(
        self,
        step: InboxStep,
        airspeed: TwistWithCovarianceStamped | None,
        measured: CascadeMeasurement | None,
        dt: float,
    ) -> tuple[float, ...]:
        pose, velocity = self._helm.select_setpoint(
            step.latest['setpoint/pose'], step.latest['setpoint/velocity']
        )
        if not self._armed or measured is None or pose is None or velocity is None:
            return self._reset_to_zero('' if self._stopped else 'off')
        setpoint, descends = self._current_setpoint(step.stamp_ns, measured, pose, velocity)
        # Recordings of earlier versions have none
        lost = airspeed is None and step.latest['airspeed'] is not None
        if lost is not self._airspeed_lost:
            self._airspeed_lost = lost
            level = HealthLevel.ERROR if lost else HealthLevel.OK
            self.health.report('airspeed', level, 'missing: landing' if lost else 'received again')
        if lost:
            descends = True
            setpoint = Setpoint(measured.altitude - DESCENT, setpoint.heading, 0.0)
        if not is_control_input_finite(measured, setpoint):
            self._stop_motors(
                f'the estimate {measured} or the setpoint {setpoint} contains NaN or infinity: '
                'the motors are off; restart the controller to fly again'
            )
            return self._reset_to_zero()
        if self._contested:
            descends = True
            setpoint = Setpoint(measured.altitude - DESCENT, measured.heading, 0.0)
        descends = descends or setpoint.altitude <= self._standing
        # Arming must not start the motors in the hands of a person, at rest or without a setpoint
        self._flies = self._flies or not descends
        if not self._flies:
            return self._reset_to_zero('armed; waits for a setpoint above the floor')
        self._landing = watch_landing(self._landing, measured.altitude, descends, dt)
        if has_landed(measured, setpoint, self._standing):
            return self._reset_to_zero('on the ground')
        if self._landing.still > STANDSTILL:
            return self._reset_to_zero('on the ground, as it no longer sinks')
        if self._law is not None:
            motion = to_motion(step.messages['odom'][-1], airspeed)
            return self._law.step(motion, setpoint, dt).duties
        duties, self._memory = control_step(
            self._settings.value.gains,
            self._rotors,
            self._drag,
            self._memory,
            measured,
            setpoint,
            dt,
            self._scratch,
        )
        return duties

    def _reset_to_zero(self, text: str = '') -> tuple[float, ...]:
        """Return zero duties, and reset the integrals."""
        self._memory = ControlMemory()
        if self._law is not None:
            self._law.reset()
        if text:
            self.health.report('motors', HealthLevel.OK, text)
        return (0.0,) * len(self._names)

    def _current_setpoint(
        self, now_ns: int, measured: CascadeMeasurement, pose: PoseStamped, velocity: TwistStamped
    ) -> tuple[Setpoint, bool]:
        """Return the setpoint, and whether it was replaced by a descent as it is too old."""
        request, settings = self._setpoint, self._settings.value
        # Most setpoints hold for several steps
        if request is None or request.pose is not pose or request.velocity is not velocity:
            stamps = from_stamp(pose.header.stamp), from_stamp(velocity.header.stamp)
            request = TimedSetpoint(pose, velocity, to_setpoint(pose, velocity), *stamps)
            self._setpoint = request
        setpoint = request.setpoint
        # The older of the two messages counts; a stamp far in the future is infinitely old
        oldest = max(stamp_age(request.pose_ns, now_ns), stamp_age(request.velocity_ns, now_ns))
        if oldest <= settings.hold_after:
            steers = 'a person' if self._helm.held else 'the setpoint'
            self.health.report('motors', HealthLevel.OK, f'flying by {steers}')
            return setpoint, False
        landing = oldest > settings.land_after
        limit = settings.land_after if landing else settings.hold_after
        future = math.isinf(oldest)
        text = (
            'the time stamp of the setpoint is in the future: '
            if future
            else f'no setpoint for {limit} s: '
        )
        self.health.report(
            'motors', HealthLevel.WARN, text + ('landing' if landing else 'holding')
        )
        # Below the current altitude, so the descent goes on until the floor
        altitude = measured.altitude - DESCENT if landing else setpoint.altitude
        return Setpoint(altitude, setpoint.heading, 0.0), landing


def main(args: list[str] | None = None) -> None:
    """Run the node until it is shut down."""
    run_node(Controller, args)
