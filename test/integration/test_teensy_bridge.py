# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Simulated light through an emulated board, its cable, the bridge and the demodulator."""

from itertools import cycle
import threading
import time

from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState
from lta_config.schema.vehicle_file import load_vehicle_file
from lta_emulation.step_thread import StepThread
from lta_emulation.teensy.emulated_board import Cable, EmulatedBoard
from lta_graph.health import HealthLevel
from lta_graph.ros.stamps import from_stamp
from lta_model.scenario import load_scenario
from lta_model.vehicle import load_vehicle
from lta_sim.world import World
from lta_vlc.diodes import build_diode_array
from lta_vlc.lamp import estimate_bearing
from lta_vlc.messages import to_block
from lta_vlc.receiver import BeaconReceiver
from lta_vlc.settings import DemodulationSettings
import pytest
from waiting import PATIENCE

from .peer import ended, Peer, start, TABLE

BRIDGE, DEMODULATOR = 'lta_bridge.nodes.teensy_bridge', 'lta_vlc.nodes.demodulator'
BLOCKS = 8
BLOCK_NS = TABLE['photodiodes'].period_ns
TASK = 'teensy_bridge: light board'


def simulated_light():
    """Return the blocks of a turning drone, as its simulator makes them."""
    scenario = load_scenario('lamp_room')
    world = World(load_vehicle('gtmab', scenario.air.density), scenario, TABLE, seed=1)
    found = []
    while len(found) < BLOCKS:
        readings = world.sense()
        if readings.block is not None:
            found.append(readings.block[1])
        world.advance((0.3, 0.3, 0.6, 0.0))
    return found


class Bench(Peer):
    """A board on a cable, and what the graph makes of it."""

    def __init__(self, domain_id, folder, **board):
        super().__init__(domain_id)
        self.cable = Cable(folder / 'ttyACM0')
        self.board = EmulatedBoard(time.time_ns(), **board)
        self.hold = threading.Lock()
        # A thread: an answer that waits for its turn of the graph's would tell a time long gone.
        self._answering = StepThread(self._answer, 'answers')
        self._answering.start()
        self.begun = 0  # ns; when the first light was sampled
        self.blocks, self.bearings = [], {}
        self.hear('photodiodes', self.blocks.append)
        self.hear('light/bearing', self._hear_bearing)
        self.hear_facts()

    def _hear_bearing(self, message):
        self.bearings[from_stamp(message.header.stamp)] = (message.vector.x, message.vector.y)

    def _answer(self):
        with self.hold:
            asked = self.cable.read(0.005)
            self.cable.write(self.board.answer_timesync(asked, time.time_ns()))
        time.sleep(0.001)  # whoever else wants the cable has it now

    def send(self, data):
        """Send whole frames."""
        with self.hold:
            self.cable.write(data)

    def light(self, samples):
        """Send the next light: the first is of now, however long the nodes took to start."""
        first = None if self.begun else time.time_ns()
        self.begun = self.begun or first
        self.send(self.board.encode_light(samples, first))

    def end(self):
        """Pull the cable for good."""
        self._answering.stop()
        self.cable.pull()

    def until_told(self, word):
        """Wait until the bridge says something; return the figures with it."""
        self.until(lambda: word in self.told(TASK))
        return self.facts[TASK].values

    def change(self, transition):
        """Ask for a transition, and return whether it was made."""
        wanted = Transition(id=transition)
        return self.ask(ChangeState, 'teensy_bridge/change_state', transition=wanted).success


@pytest.fixture
def bench(domain_id, tmp_path):
    with Bench(domain_id, tmp_path) as made:
        yield made
        made.end()


def pull_and_replug(bench):
    """Pull the cable and plug it in again, and check that the bridge reports both."""
    with bench.hold:
        bench.cable.pull()
    bench.until_told('plug the light board in')
    assert bench.facts[TASK].level == HealthLevel.ERROR
    with bench.hold:
        bench.cable.plug()
    assert bench.until_told('receiving light')['unplugged'] == '1'


def test_the_bearing_is_that_of_the_simulated_light_and_a_pulled_cable_is_shown(bench, tmp_path):
    light = simulated_light()
    nodes = [start(BRIDGE, '-p', f'port:={tmp_path}/ttyACM0'), start(DEMODULATOR)]
    bench.until_told('receiving light')
    bench.until(lambda: 'demodulator: state' in bench.facts)
    deadline = time.monotonic() + PATIENCE
    for samples in cycle(light):  # what comes before the two have found each other is lost
        heard, until = len(bench.bearings), time.monotonic() + 1.0
        bench.light(samples)
        bench.until(lambda: len(bench.bearings) > heard or time.monotonic() > until)  # noqa: B023
        if len(bench.bearings) >= BLOCKS:
            break
        assert time.monotonic() < deadline, f'{heard} bearings came of {bench.board.sent} frames'
    figures = bench.until_told('receiving light')
    assert figures['rows_lost'] == '0'
    pull_and_replug(bench)
    for process in nodes:
        ended(process)

    listener = BeaconReceiver(
        DemodulationSettings(), TABLE.light.sample_rate.si, TABLE.light.samples
    )
    ring = build_diode_array(load_vehicle_file('gtmab').sensors.diodes).ring
    blocks = {from_stamp(block.header.stamp): to_block(block) for block in bench.blocks}
    known = 5_000_000 + 1e6 * float(figures['round_trip_ms'])
    for stamp, found in sorted(bench.bearings.items()):
        k = round((stamp - bench.begun) / BLOCK_NS)
        samples = light[k % BLOCKS]
        assert stamp == pytest.approx(bench.begun + k * BLOCK_NS, abs=known)
        assert (blocks.get(stamp, samples) == samples).all()
        towards = estimate_bearing(
            listener.demodulate_next_block(samples).peaks[0],
            ring,
            DemodulationSettings().threshold,
        )
        assert found == ((towards.x, towards.y) if towards else (0.0, 0.0))
    assert any(x or y for x, y in bench.bearings.values())
    assert blocks


def test_only_an_active_bridge_publishes_and_each_transition_reports(bench, tmp_path):
    process = start(BRIDGE, '-p', f'port:={tmp_path}/ttyACM0', '-p', 'autostart:=false')
    light = simulated_light()[0]
    bench.until_told('not configured')
    assert bench.change(Transition.TRANSITION_CONFIGURE)
    bench.until_told('receiving light, not publishing')
    for _ in range(2):
        bench.light(light)
    bench.until(lambda: bench.facts[TASK].values.get('blocks') == '1')
    assert bench.blocks == []
    assert bench.change(Transition.TRANSITION_ACTIVATE)
    bench.until(lambda: bench.node.count_publishers('/lta1/photodiodes'))
    bench.light(light[:900])  # ends one block and no more
    bench.until(lambda: len(bench.blocks) == 1)
    assert bench.change(Transition.TRANSITION_DEACTIVATE)
    bench.until_told('not publishing')
    assert bench.change(Transition.TRANSITION_CLEANUP)
    bench.until_told('not configured')
    assert len(bench.blocks) == 1
    ended(process)
