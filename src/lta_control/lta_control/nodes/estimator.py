"""The estimator node: from the drone's own sensors and commands to its motion."""

import math

from lta_config.settings import setting
from lta_control.control import elapsed
from lta_control.estimator import Body, Estimate, estimator_step, EstimatorSettings
from lta_control.messages import fits, from_estimate, is_felt, to_duties, to_inputs
from lta_control.rest import apart, MOST_RATE, tilted, turning
from lta_control.vehicle_side import body_of
from lta_graph.health import Level
from lta_graph.inbox import Step
from lta_graph.ros.node import GraphNode
from lta_graph.ros.parameters import Parameters
from lta_graph.ros.process import run
from lta_model.vehicle import load_vehicle


class EstimatorParameters(EstimatorSettings):
    """The filters, and the vehicle they are for."""

    vehicle: str = setting('gtmab', 'Vehicle name or file.', fixed=True)


class Estimator(GraphNode):
    """Answer each IMU sample with an estimate."""

    def __init__(self) -> None:
        super().__init__('estimator')
        self._odom = self.output('odom')
        self._settings = Parameters(self, EstimatorParameters)
        vehicle = load_vehicle(self._settings.value.vehicle)
        self._names = vehicle.rotor_names
        self._body = body_of(vehicle)
        self._estimate = Estimate()
        self._commanded = self._estimate.duties
        self._last_ns: int | None = None
        self._refused = 0
        self.listen(self.table.read_by('estimator'), trigger='imu', on_step=self._on_step)

    def _on_step(self, step: Step) -> None:
        learning = not self._estimate.ready
        motors = step.last('motors')
        self._commanded = to_duties(motors, self._names, self._commanded)
        if motors is not None and not fits(motors, self._names):
            self.soundness.unsound.add('motors: duties that are not those of this vehicle')
        inputs = to_inputs(step, self._commanded)
        if is_felt(inputs):
            dt = elapsed(self._last_ns, step.stamp_ns, self.table.control_ns)
            self._last_ns = step.stamp_ns
            settings = self._settings.value
            self._estimate = estimator_step(settings, self._body, self._estimate, inputs, dt)
        else:
            self._refused += 1
            text = 'an IMU sample that no IMU feels was left out'
            self.health.report('imu', Level.ERROR, text, refused=self._refused)
        self._odom.publish(from_estimate(step.last('imu').header.stamp, self._estimate))
        if learning:
            self.health.report('estimate', *learned(self._estimate, self._body))


def learned(estimate: Estimate, body: Body) -> tuple[Level, str]:
    """Return how well the biases are known, as level and sentence."""
    if not estimate.ready and turning(estimate.biases, body.rate_bias):
        off = math.degrees(apart(estimate.biases.rates, body.rate_bias))
        return Level.ERROR, (
            f'the biases are not learned: the drone turns by {off:.1f} deg/s, and no gyroscope is '
            f'off by more than {math.degrees(MOST_RATE):.0f}; keep it still, or where it stands '
            'still give its bias in the vehicle file (effects.gyro_bias)'
        )
    if not estimate.ready:
        return Level.WARN, 'learning the biases: keep the drone still and level'
    if not tilted(estimate.biases, body.force_bias):
        return Level.OK, 'biases are known'
    return Level.WARN, (
        'the biases are uncertain: the drone stood tilted while it learned them; start the '
        'estimator anew with it still and level'
    )


def main(args: list[str] | None = None) -> None:
    """Run the node until it is told to stop."""
    run(Estimator, args)
