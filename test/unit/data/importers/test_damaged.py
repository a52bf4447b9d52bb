# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Logs cut anywhere and with bytes changed anywhere: a bag or one sentence, and nothing else."""

from pathlib import Path
import random

from lta_config.errors import BadInput
from lta_data.importers.run import import_logs, ImportRequest
import pytest
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import get_typestore, Stores

TRIES = 25  # of each format; hundreds of each were tried by hand
NAME = 'geometry_msgs/msg/PointStamped'
MAPPING = (
    'schema: 1\nname: m\nabout: a\nformat: csv\ntime: {column: t}\n'
    'topics:\n  - {topic: ground_truth/odom, position: {columns: [x, y, z], unit: m}}\n'
)


def text(folder):
    rows = ''.join(f'{k}.5,1,2,3\n' for k in range(5, 60))
    (folder / 'm.yaml').write_text(MAPPING)
    (folder / 'a.csv').write_text('t,x,y,z\n' + rows)
    return folder / 'a.csv'


def bag(folder, store, open_writer, serialised):
    types = get_typestore(store)
    kind = types.types
    time = kind['builtin_interfaces/msg/Time'](5, 6)
    told = (7, time, 'map') if store == Stores.ROS1_NOETIC else (time, 'map')
    message = kind[NAME](
        kind['std_msgs/msg/Header'](*told), kind['geometry_msgs/msg/Point'](1.0, 2.0, 3.0)
    )
    with open_writer as writer:
        connection = writer.add_connection('/point', NAME, typestore=types)
        for k in range(20):
            writer.write(connection, 10**9 + k, getattr(types, serialised)(message, NAME))


def ros1(folder):
    bag(folder, Stores.ROS1_NOETIC, Writer1(folder / 'a.bag'), 'serialize_ros1')
    return folder / 'a.bag'


def sqlite(folder):
    writer = Writer2(folder / 'b', version=9, storage_plugin=StoragePlugin.SQLITE3)
    bag(folder, Stores.ROS2_JAZZY, writer, 'serialize_cdr')
    return next((folder / 'b').glob('*.db3'))


LOGS = {'csv': text, 'ros1': ros1, 'sqlite': sqlite}


def damaged(data, chance):
    """Return data with its end cut off, or with some bytes changed, but for the first eight."""
    if chance.random() < 0.4:
        return data[: chance.randrange(8, len(data))]
    changed = bytearray(data)
    for _ in range(chance.choice([1, 3, 20])):
        changed[chance.randrange(8, len(data))] = chance.randrange(256)
    return bytes(changed)


@pytest.mark.parametrize('log', LOGS.values(), ids=LOGS)
def test_a_damaged_log_is_a_bag_or_a_sentence(tmp_path, log, monkeypatch):
    monkeypatch.setattr('lta_data.importers.log_provenance.read_commit', lambda: 'none')
    whole = log(tmp_path)
    data, chance = whole.read_bytes(), random.Random(1)
    outcomes = set()
    for count in range(TRIES):
        source = tmp_path / f'{count}{whole.suffix}'
        source.write_bytes(damaged(data, chance))
        mapping = str(tmp_path / 'm.yaml') if log is text else None
        out = tmp_path / f'out-{count}'
        try:
            import_logs(ImportRequest([Path(source)], mapping), out)
        except BadInput as told:
            outcomes.add('refused' if '\n' not in str(told) and not out.exists() else str(told))
        else:
            outcomes.add('imported')
    assert outcomes == {'refused', 'imported'}
    assert not list(tmp_path.glob('.out*'))
