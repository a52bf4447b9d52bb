# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A recorded hover of the closed loop, of a vehicle that is not as heavy as its file says."""

from lta_bag.writer import BagWriter
from lta_config.files import find_file
from lta_config.parameter_override import parse_assignment
from lta_config.topics import load_topic_table
from lta_flight.flight_run import SIMULATED_ROBOT
from lta_flight.flight_spec import build_loop, load_spec
from lta_flight.messages import LoopRecorder

HOVER = 'mission.speed=0'


def write_hover(folder, *changes, seed=1, seconds=40.0, simulated=True):
    """Fly GT-MAB's file with something changed, record it as the graph would; return the bag."""
    made_of = load_spec('gtmab', 'lamp_room', 'bag', 'gtmab')
    made_of = made_of.with_values(dict(map(parse_assignment, (HOVER, *changes))))
    loop = build_loop(made_of, seed)
    origin = {'vehicle': 'gtmab', 'vehicle_file': find_file('vehicle', 'gtmab').read_text('utf-8')}
    if simulated:
        origin['scenario_file'] = find_file('scenario', 'lamp_room').read_text('utf-8')
    with BagWriter(folder, origin) as writer:
        recorder = LoopRecorder(writer, loop, load_topic_table(), SIMULATED_ROBOT)
        for _ in loop.iterate_steps():
            recorder.record_step()
            if loop.world.elapsed > seconds:
                break
    return folder
