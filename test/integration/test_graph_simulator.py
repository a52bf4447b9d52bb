"""What the simulator says of its sensors is what the world's sensors are."""

from lta_sim.nodes.simulator import Simulator
from lta_sim.sensors.pressure import PressureSettings
from lta_sim.sensors.range import RangeSettings
import pytest
import rclpy


class Kept:
    """Stands in for a publisher."""

    def __init__(self) -> None:
        self.messages = []

    def publish(self, message) -> None:
        self.messages.append(message)


@pytest.fixture
def simulator(domain_id):
    rclpy.init(args=[], domain_id=domain_id)
    node = Simulator()
    yield node
    node.destroy_node()
    rclpy.try_shutdown()


def test_sensors_are_described_as_the_world_has_them(simulator):
    world = simulator._world
    world.range_settings = RangeSettings(maximum=3.5)
    world.pressure_settings = PressureSettings(noise=2.5)
    simulator._outputs = {name: Kept() for name in simulator._outputs}
    simulator._publish()
    (ranged,) = simulator._outputs['range'].messages
    (pressed,) = simulator._outputs['pressure'].messages
    assert ranged.max_range == pytest.approx(3.5)
    assert pressed.variance == pytest.approx(6.25)
