# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What the tests of the import share: import a file, and read the bag by an independent reader."""

from dataclasses import dataclass, field
from pathlib import Path

from lta_data.importers.run import import_logs, ImportRequest
import pytest
from rosbags.highlevel import AnyReader

DATA = Path(__file__).resolve().parents[5] / 'shared' / 'data'


@dataclass
class Read:
    """A bag as rosbags reads it: messages and log times by topic, and the order of all."""

    imported: object
    messages: dict = field(default_factory=dict)
    times: dict = field(default_factory=dict)
    types: dict = field(default_factory=dict)
    order: list = field(default_factory=list)

    def stamps(self, topic):
        stamps = (message.header.stamp for message in self.messages[topic])
        return [stamp.sec * 1_000_000_000 + stamp.nanosec for stamp in stamps]

    @property
    def notes(self):
        return ' '.join(self.imported.notes)


def read(imported):
    """Read an imported bag."""
    found = Read(imported)
    with AnyReader([Path(imported.bag)]) as reader:
        for connection in reader.connections:
            found.types[connection.topic] = connection.msgtype
            found.messages.setdefault(connection.topic, [])
            found.times.setdefault(connection.topic, [])
        for connection, time, data in reader.messages():
            found.messages[connection.topic].append(reader.deserialize(data, connection.msgtype))
            found.times[connection.topic].append(time)
            found.order.append(connection.topic)
    return found


@pytest.fixture
def bring(tmp_path):
    """Return what imports one file by the text of a mapping, or a shipped one, and reads it."""

    def run(source, mapping=None, **told):
        if mapping is not None and '\n' in mapping:
            path = tmp_path / 'mapping.yaml'
            path.write_text(mapping)
            mapping = str(path)
        order = ImportRequest([Path(source)], mapping, **told)
        (done,) = import_logs(order, tmp_path / 'out')
        return read(done)

    return run


@pytest.fixture
def measured():
    """Return what gives a measured set by others, or skips where it is not there."""

    def find(name):
        path = DATA / name
        if not path.exists():
            pytest.skip(f'measured data by others: {path} is not there')
        return path

    return find
