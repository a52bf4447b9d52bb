# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What a bag holds, by somebody else's reader: to compare flights by values; its one clock."""

from collections import defaultdict
from pathlib import Path

from lta_data.bag.recorded_flight import open_flight
from rosbags.highlevel import AnyReader

AROUND_NS = 60 * 10**9  # before and after a flight, in which its nodes load and end


def contents(bag: Path, prefix: str = '') -> dict[str, list[tuple[int, bytes]]]:
    """
    Return log times and values by topic, as the genuine rosbags library reads them.

    The values are encoded again, since the middleware leaves old memory between them. `prefix` is
    removed from the frames of the headers.
    """
    found = defaultdict(list)
    with AnyReader([bag]) as reader:
        for connection, log_time, data in reader.messages():
            message = reader.deserialize(data, connection.msgtype)
            if hasattr(message, 'header'):
                message.header.frame_id = message.header.frame_id.removeprefix(prefix)
            if hasattr(message, 'child_frame_id'):
                message.child_frame_id = message.child_frame_id.removeprefix(prefix)
            values = reader.typestore.serialize_cdr(message, connection.msgtype)
            found[connection.topic].append((log_time, bytes(values)))
    return found


def check_one_clock(call, bag, robot='lta1'):
    """Hold the reports of all nodes to the flight's clock, and export the bag on an even one."""
    bag = Path(bag)
    flight = open_flight(bag, robot)
    reports = flight['/diagnostics'] if '/diagnostics' in flight.bag.topics else ()
    if len(reports):
        # Nodes also report while they load and end
        early, late = flight.bag.start - AROUND_NS, flight.bag.end + AROUND_NS
        first, last = reports['stamp_ns'].min(), reports['stamp_ns'].max()
        assert early <= first <= last <= late, (early, first, last, late)
    words = ('--rate', '100', '--robot', robot, '--out', bag.parent / f'{bag.name}-{robot}-even')
    status, said = call('bag', 'export', bag, *words)
    assert status == 0, said.err
