# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The navigator over real DDS obeys the energy monitor, and comes down when that falls silent."""

from geometry_msgs.msg import PoseWithCovarianceStamped
from lta_config.topics import load_topic_table
from lta_graph.ros.message_validation import find_message_type
from lta_graph.ros.stamps import from_stamp, to_stamp
from nav_msgs.msg import Odometry
import pytest
from std_msgs.msg import Bool

from .peer import ended, Peer, start

PERIOD = load_topic_table()['light/estimate'].period_ns
RESTING, ALOFT, LANDING = 0.0, 0.5, 0.3  # m; what the navigator asks for
OK, WARN, ERROR = b'\x00', b'\x01', b'\x02'


class Drone(Peer):
    """Estimator, demodulator and energy monitor at once, which hears what the navigator asks."""

    def __init__(self, domain_id):
        super().__init__(domain_id)
        self.asked, self.turns = {}, 0
        self.hear('setpoint/pose', self._hear_setpoint)
        self.hear_facts()

    def _hear_setpoint(self, message):
        self.asked[from_stamp(message.header.stamp)] = message.pose.position.z

    @property
    def mission(self):
        return self.told('navigator: mission')

    def energy(self, reserve, level=OK, sentence='90% left'):
        """Say what the energy monitor says."""
        message = find_message_type(load_topic_table()['energy/status'])()
        message.level, message.message = level[0], sentence
        self.publisher('energy/status').publish(message)
        self.publisher('energy/reserve').publish(Bool(data=reserve))

    def meet(self):
        """Send blocks until one is answered: before all have met, a word or its answer is lost."""
        self.until(lambda: self.send() and self.asked)

    def turn(self):
        """Send one light block in which no lamp is seen; return the altitude asked for."""
        stamp = self.send()
        self.until(lambda: stamp in self.asked)
        return self.asked[stamp]

    def send(self):
        """Send one light block in which no lamp is seen; return its stamp."""
        now = 1_000_000_000 + self.turns * PERIOD
        stamp = to_stamp(now)
        self.turns += 1
        odom = Odometry()
        odom.header.stamp = stamp
        odom.pose.pose.position.z, odom.pose.pose.orientation.w = ALOFT, 1.0
        self.publisher('odom').publish(odom)
        light = PoseWithCovarianceStamped()
        light.header.stamp = stamp
        light.pose.covariance[0] = -1.0
        self.publisher('light/estimate').publish(light)
        return now

    def until_asked(self, altitude, **energy):
        """Go on until an altitude is asked for: words of the energy and light may overtake."""
        for _ in range(50):
            self.energy(**energy)
            if self.turn() == altitude:
                return
        asked = list(self.asked.values())
        raise AssertionError(f'{altitude} m is not asked for, but {asked}; {self.facts}')

    def until_told(self, mission, **energy):
        """Send energy and light until the navigator reports this mission."""

        def told():
            self.energy(**energy)
            self.turn()
            return self.mission == mission

        self.until(told)


@pytest.fixture
def drone(domain_id):
    process = start('lta_control.nodes.navigator')
    with Drone(domain_id) as made:
        for name in ('odom', 'light/estimate', 'energy/status', 'energy/reserve'):
            made.until(lambda name=name: made.publisher(name).get_subscription_count())
        made.meet()
        yield made
        ended(process)


def test_it_waits_for_good_energy_flies_and_obeys_the_reserve(drone):
    assert drone.turn() == RESTING  # nothing has been heard of the energy
    drone.until(lambda: 'no take-off: no report from the energy monitor' in drone.mission)
    low = {'reserve': True, 'level': WARN, 'sentence': 'reserve reached: 20% +- 2% left'}
    drone.energy(**low)
    for _ in range(10):
        assert drone.turn() == RESTING
    drone.until(lambda: 'no take-off: reserve reached: 20% +- 2% left' in drone.mission)
    drone.until_asked(ALOFT, reserve=False)
    drone.until_asked(LANDING, **low)
    drone.until_told('land: reserve reached: 20% +- 2% left', **low)
    drone.energy(reserve=False)
    assert drone.turn() == LANDING  # for good


def test_it_comes_down_when_the_energy_falls_silent(drone):
    drone.until_asked(ALOFT, reserve=False)
    asked = [drone.turn() for _ in range(14)]  # 1.4 s; what is older than 1 s is not believed
    assert asked[:9] == [ALOFT] * 9
    assert asked[-1] == LANDING
    drone.until(lambda: 'no report from the energy monitor for' in drone.mission)


def test_it_does_not_take_off_on_old_words(drone):
    drone.energy(reserve=False)
    drone.energy(reserve=True, level=ERROR, sentence='frozen')
    for _ in range(15):
        assert drone.turn() == RESTING
    drone.until(lambda: 'no take-off: no report from the energy monitor for' in drone.mission)
