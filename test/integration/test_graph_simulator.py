"""The simulator's node alone: what it says of its sensors, and which commands it flies."""

from contextlib import ExitStack
from types import SimpleNamespace

from lta_graph.health import HealthLevel
from lta_graph.ros.message_validation import find_message_type
from lta_graph.ros.stamps import to_stamp
from lta_model.sensors.pressure import PressureSettings
from lta_model.sensors.range import RangeSettings
from lta_sim.nodes.simulator import Simulator
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
    with ExitStack() as after:
        after.callback(rclpy.try_shutdown)
        rclpy.init(args=[], domain_id=domain_id)
        node = Simulator()
        after.callback(node.destroy_node)
        yield node


@pytest.fixture
def paced(simulator, monkeypatch):
    """Return functions: a time passes [s]; a command with the stamp of now or of then."""
    now, period = [1000.0], simulator.table.control_ns * 1e-9
    clock = SimpleNamespace(monotonic=lambda: now[0])
    monkeypatch.setattr('lta_sim.nodes.simulator.time', clock)
    simulator._outputs = {name: Kept() for name in simulator._outputs}
    simulator._began = simulator._anchor = now[0]

    def passes(seconds):
        for _ in range(round(seconds / period)):
            now[0] += period
            simulator._tick()

    def command(duties, ahead=0.0, names=None):
        message = find_message_type(simulator.table['motors'])()
        message.header.stamp = to_stamp(simulator._world.stamp_ns + round(1e9 * ahead))
        message.name = names or simulator._world.vehicle.rotor_names
        message.duty = duties
        simulator._on_motors(SimpleNamespace(messages={'motors': [message]}))

    return passes, command


def test_sensors_are_described_as_the_world_has_them(simulator):
    world = simulator._world
    world.range_settings = RangeSettings(maximum=3.5)
    world.pressure_settings = PressureSettings(noise=2.5)
    simulator._outputs = {name: Kept() for name in simulator._outputs}
    simulator._publish_step()
    (ranged,) = simulator._outputs['range'].messages
    (pressed,) = simulator._outputs['pressure'].messages
    assert ranged.max_range == pytest.approx(3.5)
    assert pressed.variance == pytest.approx(6.25)


DUTIES = [0.1, 0.2, 0.3, 0.4]
STILL = [0.0] * 4


def test_a_command_is_flown_until_it_is_three_tenths_of_a_second_old(simulator, paced):
    passes, command = paced
    command(DUTIES)
    passes(0.3)  # the newest step began when it was 0.29 s old
    assert list(simulator._world.duties) == DUTIES
    passes(0.02)
    assert list(simulator._world.duties) == STILL
    command(DUTIES)
    passes(0.01)
    assert list(simulator._world.duties) == DUTIES


@pytest.mark.parametrize(
    'duties',
    [[0.1, 0.2, 0.3, -0.4], [0.1, 0.2, 0.3, 1.1], [0.1, 0.2, 0.3, float('nan')], [0.1] * 3],
    ids=['reversed', 'beyond', 'not a number', 'too few'],
)
def test_a_duty_that_cannot_be_meant_stops_the_motors_until_one_can(simulator, paced, duties):
    """GT-MAB's rotors do not reverse, so less than nothing is no duty of theirs."""
    passes, command = paced
    assert simulator._lowest == STILL
    command(DUTIES)
    passes(0.05)
    command(duties)
    passes(0.01)
    assert list(simulator._world.duties) == STILL
    told = {fact.task: fact for fact in simulator.health.facts}
    assert told['command'].level == HealthLevel.ERROR
    assert 'the motors are off' in told['command'].message
    command(DUTIES)
    passes(0.01)
    assert list(simulator._world.duties) == DUTIES
