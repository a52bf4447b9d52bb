# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
A small recording of our own against what demodulator and navigator make of it today.

`python test/replay/test_recording.py --write` stores it anew; look at what changed first.

The drone starts 3.2 m from the lamp, learns its biases, climbs and turns to the light. The bag
holds what the two nodes read and what they answered. It tells no platform and no commit, so that
it counts as made elsewhere: the same within 1e-9, and every decision.
"""

import math
from pathlib import Path
import shutil
import sys
import tempfile

from lta_bag.metadata import build_offered_qos
from lta_bag.provenance import collect_provenance
from lta_bag.reader import read_bag
from lta_bag.schemas import encode_message
from lta_bag.writer import BagWriter
from lta_config.schema.vehicle_file import load_vehicle_file
from lta_config.topics import load_topic_table
from lta_control.guidance import ReserveResponseSettings
from lta_control.laws import load_gains
from lta_control.messages import (
    from_setpoint,
    to_air_motions,
    to_cascade_measurement,
)
from lta_control.mission import FlightPermission, Mission, mission_step, MissionSettings
from lta_control.motion import AirReckoning
from lta_control.sighting import build_sight
from lta_control.strategies import find_navigation_strategy
from lta_data.bag.recorded_flight import open_flight
from lta_flight.closed_loop import ClosedLoop, round_axes, to_lamp_position
from lta_flight.flight_stack import FlightStack
from lta_flight.messages import LoopRecorder
from lta_flight.replay.verdict import compare_with_recording
from lta_graph.ros.message_validation import find_message_type
from lta_graph.ros.stamps import from_stamp, to_stamp
from lta_model.scenario import load_scenario, offset_start
from lta_model.vehicle import load_vehicle
from lta_sim.world import World
from lta_vlc.diodes import build_diode_array
from lta_vlc.lamp import LampFinder, LampPrior
from lta_vlc.messages import from_bearing, from_lamp, from_peaks, to_block
from lta_vlc.receiver import BeaconReceiver
from lta_vlc.settings import ANY_BEACON, DemodulationSettings
import numpy as np
import pytest
from rclpy.serialization import deserialize_message
from std_msgs.msg import Float64

STORED = Path(__file__).with_name('lamp.mcap')
TABLE = load_topic_table()
ENTRY = load_vehicle_file('gtmab').sensors.diodes
DIODES = build_diode_array(ENTRY)
NODES = ('demodulator', 'navigator')
ANSWERS = [name for node in NODES for name in TABLE.published_by(node)]
KEPT = ['photodiodes', 'odom', 'energy/reserve', 'energy/status', *ANSWERS]
START = 4.0, 1.0  # m beside the scenario's start
STEPS, SEED = 801, 4  # 8 s
LARGEST = 750_000  # bytes; noise does not compress
QOS = [build_offered_qos('reliable', 'transient_local', 200)]


def fly(folder):
    """Fly, and write what the two nodes read and answer as a bag; return its file."""
    scenario = offset_start(load_scenario('lamp_room'), *START)
    vehicle = load_vehicle('gtmab', scenario.air.density)
    world = World(vehicle, scenario, TABLE, SEED)
    loop = ClosedLoop(
        world, TABLE, FlightStack(find_navigation_strategy('bag'), gains=load_gains('gtmab'))
    )
    with BagWriter(folder / 'whole', {}) as writer:
        recorder = LoopRecorder(writer, loop, TABLE, 'lta1')
        for _ in loop.iterate_until(lambda: world.steps == STEPS):
            recorder.record_step()
    told = collect_provenance('gtmab', 'lamp_room', 'gtmab', strategy='bag', seed=str(SEED))
    for name in ('commit', 'platform', 'created', 'config_sha256'):
        del told[name]
    bag = read_bag(folder / 'whole')
    with BagWriter(folder / 'lamp', told) as writer:
        for name in KEPT:
            writer.add_topic(f'/lta1/{name}', TABLE[name].type, QOS)
        for name, log_time, data in bag.iterate_messages([f'/lta1/{name}' for name in KEPT]):
            writer.write(name, data, log_time)
    (file,) = (folder / 'lamp').glob('*.mcap')
    return file


def recorded(name):
    """Return time of publication and message of a topic of the stored bag [ns]."""
    kind = find_message_type(TABLE[name])
    bag = read_bag(STORED)
    return [
        (t, deserialize_message(d, kind)) for _, t, d in bag.iterate_messages([f'/lta1/{name}'])
    ]


def answered(folder, demodulation=None, mission=None):
    """Return the bag that the cores of both nodes make of the stored one, without a graph."""
    settings, mission = demodulation or DemodulationSettings(), mission or MissionSettings()
    light, prior = TABLE.light, LampPrior()
    listener = BeaconReceiver(settings, light.sample_rate.si, light.samples, ENTRY.largest_reading)
    odometry, reserves = recorded('odom'), recorded('energy/reserve')
    # The stored bag is of version 1.0: odom has the airspeed
    reckoning = AirReckoning(TABLE.control_ns, len(odometry))
    reckoning.add_motions(
        to_air_motions((from_stamp(m.header.stamp), m, None) for _, m in odometry)
    )
    motions = dict(reckoning.history)
    land = ReserveResponseSettings().rule
    state, plan, finder = Mission(), find_navigation_strategy('bag'), LampFinder(DIODES)
    with BagWriter(folder, {}) as writer:
        for name in ANSWERS:
            writer.add_topic(f'/lta1/{name}', TABLE[name].type, QOS)
        for now, message in recorded('photodiodes'):
            block = to_block(message)
            hearing = listener.demodulate_next_block(block)
            peaks = hearing.peaks[0]
            towards, _, lamp = finder.find_lamp(peaks, settings.threshold, prior)
            begun = from_stamp(message.header.stamp)
            measured = to_cascade_measurement(
                max((m for m in odometry if m[0] <= now), key=lambda m: m[0])[1]
            )
            known = [m.data for t, m in reserves if t <= now - TABLE.control_ns]
            sight = build_sight(
                None if lamp is None else to_lamp_position(lamp),
                round_axes(DIODES.ring),
                tuple(peaks.amplitude.astype(np.float32).tolist()),
                motions[begun + TABLE['photodiodes'].period_ns // 2],
                TABLE['photodiodes'].period_ns * 1e-9,
            )
            altitude = math.nan if measured is None or not known else measured.altitude
            order = FlightPermission.RESERVE if known and known[-1] else FlightPermission.FLY
            asked, state = mission_step(mission, plan, state, sight, altitude, order, 1, land)
            pose, velocity = from_setpoint(to_stamp(begun), asked)
            for name, answer in (
                ('light/peaks', from_peaks(message.header, hearing.peaks, DIODES.axes)),
                ('light/bearing', from_bearing(message.header, towards)),
                ('light/estimate', from_lamp(message.header, lamp)),
                ('setpoint/pose', pose),
                ('setpoint/velocity', velocity),
                ('light/beacon', Float64(data=ANY_BEACON)),
            ):
                writer.write(f'/lta1/{name}', encode_message(answer, TABLE[name].type), now)
    return folder


def verdict(folder):
    return compare_with_recording(open_flight(STORED), open_flight(folder), ANSWERS)


def test_the_recording_is_small_and_has_something_to_decide():
    assert STORED.stat().st_size < LARGEST
    seen = [m.pose.covariance[0] >= 0.0 for _, m in recorded('light/estimate')]
    speeds = [m.twist.linear.x for _, m in recorded('setpoint/velocity')]
    assert len(seen) == 80
    assert sum(seen) > 40
    assert max(speeds) > 0.1 > min(speeds)


def test_the_recorded_decisions_are_those_of_today(tmp_path):
    found = verdict(answered(tmp_path / 'bag'))
    assert {'platform', 'commit'} <= set(found.elsewhere)
    assert found.word in ('identical', 'same'), found.to_dict()
    assert [topic.count for topic in found.topics] == [80] * len(ANSWERS)
    assert {each.name: each.change_count for each in found.decisions} == {
        'lamp seen': 0, 'heading': 0, 'altitude': 0, 'speed': 0,
    }  # fmt: skip


def test_another_window_moves_the_ratios_and_not_the_decisions(tmp_path):
    """Wider windows take bins out of the noise: the SNR changes, the amplitude does not."""
    found = verdict(answered(tmp_path / 'bag', DemodulationSettings(window=4)))
    assert found.word == 'different'
    differ = {each.path for topic in found.topics for each in topic.channels}
    assert {f'snr[{k}]' for k in range(8)} <= differ
    assert not {f'amplitude[{k}]' for k in range(8)} & differ


def test_a_threshold_that_no_diode_passes_loses_the_lamp(tmp_path):
    found = verdict(answered(tmp_path / 'bag', DemodulationSettings(threshold=1000.0)))
    seen = next(each for each in found.decisions if each.name == 'lamp seen')
    assert seen.change_count == seen.recorded.sum() > 0
    assert found.relative_time(int(seen.keys[seen.first_change])) == pytest.approx(0.0, abs=8.0)


def test_a_change_of_a_millionth_is_not_the_same(tmp_path):
    settings = MissionSettings()
    nudged = settings.model_copy(update={'altitude': settings.altitude * (1.0 + 1e-6)})
    found = verdict(answered(tmp_path / 'bag', mission=nudged))
    assert found.word == 'different'
    assert next(each for each in found.decisions if each.name == 'altitude').largest_change < 1e-6


if __name__ == '__main__':
    if sys.argv[1:] != ['--write']:
        sys.exit('Give --write to store the recording anew.')
    with tempfile.TemporaryDirectory() as place:
        shutil.copyfile(fly(Path(place)), STORED)
