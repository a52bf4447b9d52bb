# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""SQLite bags of recorders that were killed: with a write-ahead log, without metadata, cut off."""

from pathlib import Path
import shutil
import sqlite3
import struct

from lta_config.errors import BadInput
import pytest

COUNT = 5000
START = 1_700_000_000_000_000_000  # ns


def fill(base: sqlite3.Connection, begin: int, end: int, topic: str) -> None:
    rows = (
        (1, START + k * 10_000_000, b'\0\1\0\0' + struct.pack('<d', float(k)))
        for k in range(begin, end)
    )
    base.executemany('INSERT INTO messages(topic_id, timestamp, data) VALUES(?, ?, ?)', rows)
    base.execute('UPDATE topics SET name = ?', (topic,))
    base.commit()


def write_database(path: Path, count: int = COUNT, topic: str = '/speed') -> sqlite3.Connection:
    base = sqlite3.connect(path)
    base.executescript(
        'CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, '
        'serialization_format TEXT, offered_qos_profiles TEXT);'
        'CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, '
        'data BLOB);'
        'CREATE INDEX timestamp_idx ON messages (timestamp ASC);'
        "INSERT INTO topics VALUES(1, '-', 'std_msgs/msg/Float64', 'cdr', '')"
    )
    fill(base, 0, count, topic)
    return base


def copy_logged(source: Path, target: Path) -> None:
    """Copy a database with its log, as a killed recorder leaves both."""
    for ending in ('', '-wal'):
        shutil.copy(f'{source}{ending}', f'{target}{ending}')


@pytest.mark.parametrize(('first', 'more'), [(60, 700), (1, 2500)])
def test_what_is_in_a_write_ahead_log_is_read(first, more, tmp_path, bring):
    base = write_database(tmp_path / 'open.db3', first)
    base.execute('PRAGMA journal_mode = WAL')
    base.execute('PRAGMA wal_autocheckpoint = 0')
    fill(base, first, first + more, '/speed')
    copy_logged(tmp_path / 'open.db3', tmp_path / 'killed_0.db3')
    got = bring(tmp_path / 'killed_0.db3')
    assert len(got.messages['/speed']) == first + more
    assert got.messages['/speed'][-1].data == first + more - 1
    assert 'killed_0.db3-wal was read' in got.notes
    assert (tmp_path / 'killed_0.db3-wal').stat().st_size > 0  # left as it was


@pytest.mark.parametrize('files', [1, 2])
def test_a_folder_without_metadata_is_read(files, tmp_path, bring):
    folder = tmp_path / 'bag'
    folder.mkdir()
    for k in range(files):
        write_database(folder / f'bag_{k}.db3', 30, '/speed').close()
    assert len(bring(folder).messages['/speed']) == 30 * files


@pytest.mark.parametrize('share', [0.3, 0.6, 0.95])
def test_the_intact_part_of_a_file_that_was_cut_off_is_read(share, tmp_path, bring):
    path = tmp_path / 'cut_0.db3'
    write_database(path).close()
    with path.open('r+b') as stream:
        stream.truncate(int(share * path.stat().st_size))
    got = bring(path)
    values = [one.data for one in got.messages['/speed']]
    assert values == list(range(len(values)))
    assert 0.5 * share * COUNT < len(values) < 1.3 * share * COUNT
    assert f'{len(values)} messages before the damage' in got.notes


@pytest.mark.parametrize(('name', 'head', 'words'), [
    ('run_0.mcap.zstd', b'\x28\xb5\x2f\xfd', 'decompress it with `zstd -d`'),
    ('run_0.db3.zstd', b'\x28\xb5\x2f\xfd', 'decompress it with `zstd -d`'),
])  # fmt: skip
@pytest.mark.parametrize('inside', [True, False])
def test_a_compressed_file_is_named(name, head, words, inside, tmp_path, bring):
    folder = tmp_path / 'run'
    folder.mkdir()
    (folder / name).write_bytes(head + bytes(40))
    (folder / 'metadata.yaml').write_text('rosbag2_bagfile_information: {version: 5}\n')
    with pytest.raises(BadInput, match=words):
        bring(folder if inside else folder / name)


def test_a_bag_of_ros_1_that_was_not_closed_gets_advice_that_helps(tmp_path, bring):
    path = tmp_path / 'run.bag.active'
    path.write_bytes(b'#ROSBAG V2.0\n' + bytes(4096))
    with pytest.raises(BadInput, match='run `rosbag reindex`') as told:
        bring(path)
    assert 'ros2 bag' not in str(told.value)
