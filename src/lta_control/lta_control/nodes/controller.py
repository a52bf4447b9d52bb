"""
Controller node: convert estimate and setpoint to duties.

`lta_control.flight_step` has the rules of a flight, with all that keeps the motors off. The node
converts messages to its inputs and its duties to a message. The drone lands while two nodes steer
it, and when the airspeed that it had is missing.
"""

import math

from geometry_msgs.msg import TwistWithCovarianceStamped
from lta_config.settings import setting, Settings
from lta_control.allocation import create_working_array
from lta_control.cascade import CascadeGains
from lta_control.flight_step import (
    control_motors,
    ControlInputs,
    FlightRules,
    FlightState,
    is_stopped,
    PilotMemory,
    TILT_LIMIT,
)
from lta_control.gains_file import load_gains
from lta_control.laws.onboard_law import load_onboard_law, vehicle_law_name
from lta_control.messages import from_duties, to_control_inputs
from lta_control.odometry.air_reckoning import step_duration
from lta_graph.health import HealthLevel
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
RESTING = {
    FlightState.OFF: 'off',
    FlightState.WAITING: 'armed; waits for a setpoint above the floor',
    FlightState.ON_GROUND: 'on the ground',
    FlightState.LANDED: 'on the ground, as it no longer sinks',
}
STOPPED = {
    FlightState.OVERTURNED: 'the drone turned over',
    FlightState.BLIND: 'the height is unknown, as its sensors repeat their readings or send none',
    FlightState.NOT_FINITE: 'the estimate or the setpoint contains NaN or infinity',
    FlightState.EMERGENCY_STOP: 'emergency stop',
}


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


class Controller(GraphNode):
    """Publish duties for each estimate."""

    def __init__(self) -> None:
        super().__init__('controller')
        self._motors = self.create_output('motors')
        self._settings = NodeParameters(self, ControllerSettings)
        vehicle = load_vehicle(self._settings.value.vehicle)
        self._vehicle, self._scratch = vehicle, create_working_array()
        self._course = load_course(self._settings.value.scenario)
        name = self._settings.value.law or vehicle_law_name(vehicle)
        self._law, self._constants = load_onboard_law(name, vehicle, self._settings.value.gains)
        self._memory = PilotMemory(law=self._law.start)
        self._armed = self._settings.value.armed
        self._contested = False  # whether two nodes have sent setpoints since arming
        self._airspeed_lost = False
        self._begun_ns: int | None = None
        self._last_ns: int | None = None
        self.create_service(SetBool, 'arm', self._on_arm)
        self.create_service(Trigger, 'emergency_stop', self._on_emergency_stop)
        self.subscribe_inputs(
            self.table.read_by('controller'), trigger='odom', on_step=self._on_step
        )
        self._helm = CommandMux(self)

    def _on_step(self, step: InboxStep) -> None:
        odom = step.messages['odom'][-1]
        inputs = to_control_inputs(
            odom,
            self._select_airspeed(step),
            self._helm.select_setpoint(
                step.latest['setpoint/pose'], step.latest['setpoint/velocity']
            ),
            self._armed,
            self._contested or self._airspeed_lost,
            step.stamp_ns,
            step_duration(self._last_ns, step.stamp_ns, self.table.control_ns),
        )
        self._last_ns = step.stamp_ns
        constants, settings = self._constants, self._settings.value
        if isinstance(constants.gains, CascadeGains):
            constants = constants._replace(gains=settings.gains)
        rules = FlightRules(
            math.cos(settings.tilt_limit),
            self._vehicle.hull_height_on_floor,
            settings.hold_after,
            settings.land_after,
        )
        self._memory = control_motors(
            self._law, constants, rules, self._memory, inputs, self._scratch
        )
        self._report_flight(inputs)
        duties = self._add_test_signals(self._memory.law.command.duties, step.stamp_ns)
        self._motors.publish(from_duties(odom.header.stamp, self._vehicle.rotor_names, duties))

    def _select_airspeed(self, step: InboxStep) -> TwistWithCovarianceStamped | None:
        """Return the airspeed if it belongs to this time, and report where it is missing."""
        latest = step.latest['airspeed']
        near = latest and abs(from_stamp(latest.header.stamp) - step.stamp_ns) <= AIRSPEED_AGE_NS
        # Recordings of earlier versions have none
        lost = latest is not None and not near
        if lost is not self._airspeed_lost:
            self._airspeed_lost = lost
            level = HealthLevel.ERROR if lost else HealthLevel.OK
            self.health.report('airspeed', level, 'missing: landing' if lost else 'received again')
        return latest if near else None

    def _add_test_signals(self, duties: tuple[float, ...], now_ns: int) -> tuple[float, ...]:
        """Return the duties with the test signals of the scenario."""
        if self._course is None:
            return duties
        self._begun_ns = now_ns if self._begun_ns is None else self._begun_ns
        time = (now_ns - self._begun_ns) * 1e-9
        return self._course.excite_duties(time, duties, self._vehicle.reversible)

    def _report_flight(self, inputs: ControlInputs) -> None:
        """Report what the motors do, and why."""
        state = FlightState(self._memory.watch.state)
        if is_stopped(state):
            level, text = HealthLevel.ERROR, describe_stop(state)
            self._armed = False
        elif state in RESTING:
            level, text = HealthLevel.OK, RESTING[state]
        elif state is FlightState.FLYING:
            steers = 'a person' if self._helm.held else 'the setpoint'
            level, text = HealthLevel.OK, f'flying by {steers}'
        else:
            level, text = HealthLevel.WARN, self._describe_descent(state, inputs.age)
        self.health.report('motors', level, text)

    def _describe_descent(self, state: FlightState, age: float) -> str:
        settings = self._settings.value
        doing = 'holding' if state is FlightState.HOLDING else 'landing'
        limit = settings.hold_after if state is FlightState.HOLDING else settings.land_after
        if age <= limit:
            return doing
        if math.isinf(age):
            return f'the time stamp of the setpoint is in the future: {doing}'
        return f'no setpoint for {limit} s: {doing}'

    def _on_arm(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        count, watch = self._helm.count_commanders(), self._memory.watch
        refusal = f'{count} nodes send setpoints: stop all but one' if count > 1 else ''
        if is_stopped(watch.state):
            refusal = describe_stop(watch.state)
        response.success = not (request.data and refusal)
        response.message = refusal or 'armed'
        if response.success:
            # Arming starts with empty integrals
            self._memory = PilotMemory(watch._replace(flies=False), self._law.start)
            self._armed, self._contested = request.data, False
            response.message = 'armed' if self._armed else 'disarmed'
        return response

    def _on_emergency_stop(
        self, _: Trigger.Request, response: Trigger.Response
    ) -> Trigger.Response:
        watch = self._memory.watch._replace(state=FlightState.EMERGENCY_STOP)
        self._memory, self._armed = PilotMemory(watch, self._law.start), False
        response.success, response.message = True, describe_stop(watch.state)
        self.health.report('motors', HealthLevel.ERROR, response.message)
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


def describe_stop(state: int) -> str:
    """Return why the motors have stopped for good, and what to do."""
    return (
        f'{STOPPED[FlightState(state)]}: the motors are off; restart the controller to fly again'
    )


def main(args: list[str] | None = None) -> None:
    """Run the node until it is shut down."""
    run_node(Controller, args)
