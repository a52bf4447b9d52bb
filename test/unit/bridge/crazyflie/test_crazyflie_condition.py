"""What the bridge says of its link and of its motors."""

from types import SimpleNamespace

from lta_bridge.crazyflie import readings
from lta_bridge.crazyflie.bridge import Bridge
from lta_bridge.crazyflie.condition import condition, kept
from lta_bridge.crazyflie.safety import Seen, Stage, State
from lta_config.schema.crazyflie_file import load_crazyflie
from lta_graph.health import Level
from lta_model.vehicle import load_vehicle

ARMED = Seen(True, True, 2, 0.0, 0.0, 4.0, 1.0, 1.0)


def test_without_a_keeper_nothing_is_configured():
    assert kept(None) == ('not configured', 0)
    assert kept(SimpleNamespace(why='gone', attempts=3)) == ('gone', 3)


def fact(task, bridge, why='', attempts=1, **changed):
    """Return a diagnostic of a bridge in normal operation, with these fields changed."""
    told = condition(bridge, why, attempts, 12, ARMED._replace(**changed))
    return {one.task: one for one in told}[task]


def test_what_is_said_of_the_link():
    """Half a second without a packet is silence; without a link the message gives the reason."""
    bridge = Bridge(None, load_crazyflie('gtmab'), load_vehicle('gtmab').rotor_names)
    for silence, said in (
        (0.499, (Level.OK, 'connected')),
        (0.5, (Level.ERROR, 'silent for 0.5 s')),
    ):
        told = fact('link', bridge, silence=silence)
        assert (told.level, told.message) == said
    gone = fact('link', bridge, 'nobody answers', 7, linked=False)
    assert (gone.level, gone.message) == (Level.ERROR, 'nobody answers')
    bridge.pinged(0.004)
    values = fact('link', bridge, attempts=7, silence=0.25).values
    assert values == {
        'protocol': '12', 'silence_s': '0.250', 'latency_s': '0.0040', 'one_way_s': '0.0020',
        'drift_ppm': '-0.0', 'clock_restarts': '0', 'packets': '0', 'attempts': '7',
    }  # fmt: skip


def test_what_is_said_of_the_motors():
    bridge = Bridge(None, load_crazyflie('gtmab'), load_vehicle('gtmab').rotor_names)
    told = fact('safety', bridge)
    assert (told.level, told.message) == (Level.OK, 'disarmed: not armed yet')
    assert told.values == {'word': '2', 'command': 'motors', 'voltage': '4.00', 'motors': ''}
    bridge.motors = readings.Motors((0.5, 0.25, 0.0, 1.0), 2)
    bridge.state = State(Stage.FLYING, why='')
    told = fact('safety', bridge)
    assert (told.level, told.message) == (Level.OK, 'flying')
    assert told.values['motors'] == '0.50 0.25 0.00 1.00'
    bridge.state = State(Stage.STOPPED, why='emergency stop')
    told = fact('safety', bridge)
    assert (told.level, told.message) == (Level.ERROR, 'stopped: emergency stop')
