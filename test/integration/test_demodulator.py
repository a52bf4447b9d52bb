# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The demodulator over real DDS: how soon it answers, and what it says of wrong blocks."""

import math
import time

from lta_config.files import share_folder
from lta_config.topics import load_topic_table
from lta_graph.health import HealthFact, HealthLevel
from lta_graph.ros.stamps import from_stamp, to_stamp
from lta_graph.ros.vehicle_messages import build_light_block_message
import numpy as np
import pytest
from sensor_msgs.msg import Image
from std_msgs.msg import Float64

from .peer import ended, Peer, start

NODE = 'lta_vlc.nodes.demodulator'
PERIOD = load_topic_table()['photodiodes'].period_ns
BLOCKS = 60


class Listening(Peer):
    """A vehicle that sends blocks and hears what the demodulator makes of them."""

    def __init__(self, domain_id, diodes=8):
        super().__init__(domain_id)
        self.bearings = {}
        self.first = 0  # block, of those that the tests count
        chance = np.random.default_rng(1)
        facing = np.cos(np.arange(diodes) * math.tau / diodes).clip(0.0) ** 1.2 + 0.03
        light = np.outer(np.arange(1000) * 0.015 % 1.0 < 0.5, 200.0 * facing)
        self.block = (800.0 + light + chance.normal(0.0, 3.0, light.shape)).astype(np.uint16)
        self.hear('light/bearing', self._hear_bearing)
        self.hear_facts()

    def _hear_bearing(self, message):
        self.bearings[from_stamp(message.header.stamp)] = message.vector

    def meet(self):
        """Send blocks until one is answered."""

        def send():
            self.send(0)
            self.first += 1

        self._until_heard(send, self.bearings)

    def _until_heard(self, send, heard):
        """Send until something is heard: DDS finds the way back in its own time."""
        again = 0.0

        def answered():
            nonlocal again
            if time.monotonic() > again:
                again = time.monotonic() + 0.5
                send()
            return heard

        self.until(answered)

    def stamp(self, k):
        """Return when block k begins [ns]."""
        return 1_000_000_000 + (self.first + k) * PERIOD

    def send(self, k, message=None):
        """Send block k; return its stamp."""
        stamp = self.stamp(k)
        message = message or build_light_block_message(to_stamp(stamp), self.block)
        message.header.stamp = to_stamp(stamp)
        self.publisher('photodiodes').publish(message)
        return stamp

    def light(self):
        """Return what is said of the light, or nothing yet."""
        return self.facts.get('demodulator: light', HealthFact('light', HealthLevel.OK, ''))


@pytest.fixture
def vehicle(domain_id):
    with Listening(domain_id) as made:
        yield made


def vehicle_of(folder, diodes):
    """Return a vehicle file with that many diodes."""
    text = (share_folder() / 'vehicles' / 'gtmab.yaml').read_text(encoding='utf-8')
    assert text.count('    count: 8\n') == 1
    path = folder / 'many.yaml'
    text = text.replace('    count: 8\n', f'    count: {diodes}\n')
    path.write_text(text, encoding='utf-8')
    return path


@pytest.mark.parametrize('diodes', [8, 16])
def test_every_block_is_answered_with_its_own_stamp(domain_id, tmp_path, diodes):
    with Listening(domain_id, diodes) as peer:
        process = start(NODE, '-p', f'vehicle:={vehicle_of(tmp_path, diodes)}')
        peer.meet()
        for k in range(BLOCKS):
            stamp = peer.send(k)
            peer.until(lambda stamp=stamp: stamp in peer.bearings)
            assert peer.bearings[stamp].x > 0.4
        ended(process)


def test_the_light_is_told_with_its_faults(vehicle):
    process = start(NODE)
    vehicle.meet()
    for k in range(3):
        stamp = vehicle.send(k)
        vehicle.until(lambda stamp=stamp: stamp in vehicle.bearings)
    vehicle.until(lambda: vehicle.light().message == 'beacon found')
    values = vehicle.light().values
    assert float(values['best_snr']) > 100.0
    assert abs(float(values['frequency_error_Hz'])) < 0.1
    assert (values['saturated_diodes'], values['flat_diodes']) == ('0', '0')

    vehicle.block[:, 3] = 4095  # saturated throughout, and flat with it
    vehicle.block[::2, 4] = 4095
    vehicle.block[:, 5] = 7
    stamp = vehicle.send(7)  # four blocks later than it should be
    vehicle.until(lambda: vehicle.light().values.get('blocks_missing') == '4')
    values = vehicle.light().values
    assert (values['saturated_diodes'], values['flat_diodes']) == ('2', '2')
    assert vehicle.bearings[stamp].x > 0.4  # and none of them pulls

    short = build_light_block_message(to_stamp(0), vehicle.block[:999])
    torn = build_light_block_message(to_stamp(0), vehicle.block)
    name = 'data' if isinstance(torn, Image) else 'counts'
    setattr(torn, name, getattr(torn, name)[:-2])
    few = build_light_block_message(to_stamp(0), np.ascontiguousarray(vehicle.block[:, :7]))
    for k, message, sentence in (
        (8, short, 'the demodulator expects 1000 samples of each diode'),
        (9, torn, 'has 15998 bytes of data, but' if name == 'data' else 'has 7998 counts, which'),
        (10, few, '8'),
        (10, None, f'follows one with {vehicle.stamp(10) * 1e-9:.3f} s'),
    ):
        vehicle.send(k, message)
        vehicle.until(lambda sentence=sentence: sentence in vehicle.light().message)
    assert vehicle.light().values['blocks_refused'] == '4'
    ended(process)


def test_the_wanted_beacon_is_the_one_that_is_estimated(vehicle):
    process = start(NODE)
    behind = np.cos(np.arange(8) * math.tau / 8.0 + math.pi).clip(0.0)
    light = np.outer(np.arange(1000) * 0.025 % 1.0 < 0.5, 300.0 * behind)
    vehicle.block += light.astype(np.uint16)
    vehicle.meet()
    stamp = vehicle.send(0)
    vehicle.until(lambda: stamp in vehicle.bearings)
    assert vehicle.bearings[stamp].x > 0.4
    vehicle.publisher('light/beacon').publish(Float64(data=250.0))

    def turned():
        newest = vehicle.send(1 + len(vehicle.bearings))
        vehicle.until(lambda: newest in vehicle.bearings)
        return vehicle.bearings[newest].x < -0.4

    vehicle.until(turned)
    vehicle.until(lambda: 'demodulator: beacon at 150 Hz' in vehicle.facts)
    ended(process)
