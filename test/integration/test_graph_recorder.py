"""The recorder outlives nonsense: a message cut short, and a stamp from another age."""

import os
from pathlib import Path
import signal
import subprocess
import sys
import time

from lta_analysis.bag.reader import read_bag
from lta_config.topics import topic_table
from lta_graph.ros.node import message_type, to_stamp
from lta_graph.ros.qos import profile
import rclpy
from rclpy.context import Context
from rclpy.serialization import serialize_message

ROOT = Path(__file__).resolve().parents[2]
TABLE = topic_table()
PATIENCE = 20.0  # s of wall time
CODE = (
    'from lta_bridge import provenance; provenance.version = lambda name: "0"; '
    'from lta_bridge.nodes.recorder import main; main()'
)


def test_nonsense_is_recorded_counted_and_dates_nothing(domain_id, tmp_path):
    paths = [str(path.parent) for path in ROOT.glob('src/*/package.xml')] + [str(ROOT / 'config')]
    words = ['-r', '__ns:=/lta1', '-p', f'bag:={tmp_path / "bag"}']
    process = subprocess.Popen(
        [sys.executable, '-c', CODE, '--ros-args', *words],
        env={**os.environ, 'PYTHONPATH': os.pathsep.join([*paths, *sys.path])},
        stderr=subprocess.PIPE,
        text=True,
    )
    context = Context()
    rclpy.init(args=[], context=context, domain_id=domain_id)
    node = rclpy.create_node('peer', namespace='/lta1', context=context)
    row = TABLE['odom']
    publisher = node.create_publisher(message_type(row), 'odom', profile(row, lockstep=False))
    deadline = time.monotonic() + PATIENCE
    while not publisher.get_subscription_count():
        assert time.monotonic() < deadline
        time.sleep(0.02)

    def odom(stamp_ns):
        message = message_type(row)()
        message.header.stamp = to_stamp(stamp_ns)
        return message

    first, second = TABLE.start_ns, TABLE.start_ns + row.period_ns
    publisher.publish(odom(first))
    publisher.publish(odom(2_000_000_000 * 10**9))
    publisher.publish(serialize_message(odom(first))[:8])
    publisher.publish(odom(second))
    time.sleep(0.5)
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=PATIENCE)
    node.destroy_node()
    context.try_shutdown()
    assert (process.returncode, errors) == (0, '')
    bag = read_bag(tmp_path / 'bag')
    times = [when for _, when, _ in bag.messages(['/lta1/odom'])]
    assert times == [first, first, first, second]
    told = [
        {item.key: item.value for item in status.values}
        for topic, _, data in bag.messages(['/diagnostics'])
        for status in bag.decode(topic, data).status
        if status.name == 'recorder: recording'
    ]
    assert told[-1]['odom with a wild stamp'] == told[-1]['odom cut short'] == '1'
