# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Exported files, read back by other programs' readers, hold what rosbags decodes."""

import json

import lta_analysis
from lta_bag import BagWriter
from lta_bag.reader import read_bag
from lta_cli.app import build_app
from lta_config.errors import BadInput
from lta_data.export import run
from lta_data.export.run import export_recording, ExportRequest
import numpy as np
import pandas
from pyarrow import parquet
import pytest
from rosbags.highlevel import AnyReader
from scipy.io import loadmat
from typer.testing import CliRunner

START = 1_000_000_000


class Blind:
    """Looks at nothing."""

    def show_topic(self, topic, done, total):
        pass


def header(types, time):
    stamp = types['builtin_interfaces/msg/Time'](time // 10**9, time % 10**9)
    return types['std_msgs/msg/Header'](stamp, 'base_link')


@pytest.fixture
def mixed_bag(record, types):
    """Return a bag with duties, blocks, peaks and a camera."""
    rng = np.random.default_rng(4)
    rows = []
    for k in range(5):
        head = header(types, START + k * 10**8)
        motors = types['lta_msgs/msg/ActuatorDuty'](
            head, ['up', 'left'], np.array([0.1 * k, -0.5])
        )
        samples = rng.integers(0, 4096, 40, dtype=np.uint16)
        block = types['lta_msgs/msg/LightBlock'](head, 1e4, 2, samples)
        image = types['sensor_msgs/msg/Image'](
            head, 20, 2, '16UC1', 0, 4, np.frombuffer(samples.tobytes(), np.uint8)
        )
        count = 1 + k % 2
        axes = [types['geometry_msgs/msg/Vector3'](x, 0.0, 0.0) for x in (float(k), k + 0.5)]
        ones = np.ones(count, np.float32)
        beacon = types['lta_msgs/msg/BeaconPeaks'](
            ones, np.array([2.5, 7.5], np.float32)[:count], ones
        )
        peaks = types['lta_msgs/msg/LampPeaks'](head, axes[:count], [beacon])
        rows += [
            ('/lta1/motors', 'lta_msgs/msg/ActuatorDuty', motors, START + k),
            ('/lta1/photodiodes', 'lta_msgs/msg/LightBlock', block, START + k),
            ('/lta1/camera', 'sensor_msgs/msg/Image', image, START + k),
            ('/lta1/light/peaks', 'lta_msgs/msg/LampPeaks', peaks, START + k),
        ]
    return record(rows, 'mixed')


def decoded(bag, topic):
    """Return the messages of a topic as rosbags has them."""
    with AnyReader([bag]) as reader:
        connections = [each for each in reader.connections if each.topic == topic]
        return [
            reader.deserialize(raw, connection.msgtype)
            for connection, _, raw in reader.messages(connections)
        ]


def files(bag, form, folder, **order):
    done = export_recording(lta_analysis.open(bag), ExportRequest(form, **order), folder, Blind())
    return {each.topic: each for each in done.files}, done


def test_parquet_holds_what_rosbags_decodes(flight_bag, tmp_path):
    written, done = files(flight_bag, 'parquet', tmp_path / 'out')
    assert set(written) == {'odom', 'energy/reserve', '/clock'}
    assert done.remarks == []
    table = parquet.read_table(written['odom'].file)
    messages = decoded(flight_bag, '/lta1/odom')
    for path, of in {
        'pose.pose.position.x': lambda m: m.pose.pose.position.x,
        'pose.covariance[35]': lambda m: m.pose.covariance[35],
        'twist.twist.linear.x': lambda m: m.twist.twist.linear.x,
        'header.stamp.nanosec': lambda m: m.header.stamp.nanosec,
        'header.frame_id': lambda m: m.header.frame_id,
    }.items():
        assert table[path].to_pylist() == [of(message) for message in messages], path
    stamps = [m.header.stamp.sec * 10**9 + m.header.stamp.nanosec for m in messages]
    assert table['stamp_ns'].to_pylist() == stamps
    assert table.schema.field('pose.pose.position.x').metadata == {b'unit': b'm'}
    assert table.schema.field('time').metadata == {b'unit': b's'}
    assert table.schema.metadata[b'type'] == b'nav_msgs/msg/Odometry'
    file = parquet.ParquetFile(written['odom'].file)
    assert (written['odom'].rows, written['odom'].columns) == (40, file.metadata.num_columns)
    assert parquet.read_table(written['energy/reserve'].file)['data'].to_pylist() == [
        False, False, True, True,
    ]  # fmt: skip


def test_csv_holds_it_to_the_last_bit_with_units_beside_it(flight_bag, tmp_path):
    written, _ = files(flight_bag, 'csv', tmp_path / 'out', topics=('odom',))
    frame = pandas.read_csv(written['odom'].file)
    odom = lta_analysis.open(flight_bag)['odom']
    for column in odom:
        np.testing.assert_array_equal(frame[column], odom[column], column)
    units = pandas.read_csv(tmp_path / 'out/units.csv', keep_default_na=False)
    assert set(units['file']) == {'odom.csv'}
    assert units['column'].tolist() == frame.columns.tolist()
    by_column = dict(zip(units['column'], units['unit'], strict=True))
    assert by_column['twist.twist.angular.z'] == 'rad/s'
    assert by_column['pose.pose.orientation.yaw'] == 'rad'
    assert by_column['child_frame_id'] == ''


def test_matlab_holds_structs_matrices_and_units(flight_bag, mixed_bag, tmp_path):
    written, _ = files(flight_bag, 'mat', tmp_path / 'out')
    found = loadmat(written['odom'].file, squeeze_me=True, struct_as_record=False)
    messages = decoded(flight_bag, '/lta1/odom')
    odom, units = found['odom'], found['units']
    np.testing.assert_array_equal(
        odom.pose.pose.position.y, [message.pose.pose.position.y for message in messages]
    )
    np.testing.assert_array_equal(
        odom.pose.covariance, [message.pose.covariance for message in messages]
    )
    assert odom.child_frame_id.tolist() == ['base_link'] * 40
    assert (units.pose.pose.position.y, units.pose.covariance, units.time) == ('m', 'm2', 's')
    assert odom.pose.pose.orientation.yaw.shape == (40,)
    written, _ = files(mixed_bag, 'mat', tmp_path / 'joints', topics=('motors',))
    motors = loadmat(written['motors'].file, squeeze_me=True, struct_as_record=False)['motors']
    np.testing.assert_array_equal(motors.effort.up, 0.1 * np.arange(5))
    topics = ('motors', 'light/peaks')
    written, _ = files(mixed_bag, 'mat', tmp_path / 'one', topics=topics, rate=10.0)
    found = loadmat(written['aligned'].file, squeeze_me=True, struct_as_record=False)
    np.testing.assert_array_equal(found['aligned'].motors.effort.up, 0.1 * np.arange(5))
    np.testing.assert_array_equal(found['aligned'].light.peaks.x[:, 0], np.arange(5))
    assert found['units'].motors.effort.up == '1'


@pytest.mark.parametrize('stretch', [2, 1000])
def test_samples_and_points_are_rows_with_times_of_their_own(
    mixed_bag, tmp_path, monkeypatch, stretch
):
    monkeypatch.setattr(run, 'BLOCK_ROWS', stretch)
    written, done = files(mixed_bag, 'parquet', tmp_path / 'out')
    assert done.remarks == ["Of the messages on 'camera', the data are not exported."]
    table = parquet.read_table(written['photodiodes'].file)
    blocks = [message.counts.reshape(20, 2) for message in decoded(mixed_bag, '/lta1/photodiodes')]
    expected = np.concatenate(blocks)
    for diode in range(2):
        np.testing.assert_array_equal(table[f'diode[{diode}]'], expected[:, diode])
    assert table.schema.field('diode[1]').metadata == {b'unit': b'ADC counts'}
    # 10 kS/s from the stamp of each block.
    stamps = START + np.repeat(np.arange(5) * 10**8, 20) + np.tile(np.arange(20) * 10**5, 5)
    np.testing.assert_array_equal(table['stamp_ns'], stamps)
    peaks = parquet.read_table(written['light/peaks'].file)
    assert peaks['point'].to_pylist() == [0, 0, 1, 0, 0, 1, 0]
    assert peaks['x'].to_pylist() == [0.0, 1.0, 1.5, 2.0, 3.0, 3.5, 4.0]
    assert peaks['snr'].to_pylist() == [2.5, 2.5, 7.5, 2.5, 2.5, 7.5, 2.5]
    assert parquet.read_table(written['camera'].file)['height'].to_pylist() == [20] * 5


def test_columns_that_some_messages_lack_are_there_in_every_row(record, types, tmp_path):
    kind, dimension = (
        types['std_msgs/msg/Int64MultiArray'],
        types['std_msgs/msg/MultiArrayDimension'],
    )
    layout = types['std_msgs/msg/MultiArrayLayout']
    rows = []
    for k, count in enumerate([1, 1, 2, 2, 0]):
        labels = [dimension(f'd{index}', 3, 4) for index in range(count)]
        message = kind(layout(labels, 0), np.arange(count) + k)
        rows.append(('/lta1/list', 'std_msgs/msg/Int64MultiArray', message, START + k))
    bag = record(rows)
    written, _ = files(bag, 'parquet', tmp_path / 'out')
    frame = parquet.read_table(written['list'].file).to_pandas()
    nan = np.nan
    np.testing.assert_array_equal(frame['data[0]'], [0, 1, 2, 3, nan])
    np.testing.assert_array_equal(frame['data[1]'], [nan, nan, 3, 4, nan])
    np.testing.assert_array_equal(frame['layout.dim[1].size'], [nan, nan, 3, 3, nan])
    assert frame['layout.dim[1].label'].tolist() == ['', '', 'd1', 'd1', '']


def test_one_table_on_one_clock(mixed_bag, tmp_path):
    written, done = files(mixed_bag, 'csv', tmp_path / 'out', rate=20.0, method='linear')
    assert list(written) == ['aligned']
    frame = pandas.read_csv(written['aligned'].file)
    np.testing.assert_allclose(frame['time'], 0.05 * np.arange(9))
    np.testing.assert_allclose(frame['motors/effort.up'], 0.05 * np.arange(9), atol=1e-12)
    assert [remark.split(' is left out')[0] for remark in done.remarks] == ["Topic 'photodiodes'"]


def test_what_cannot_be_exported_is_one_sentence(flight_bag, mixed_bag, tmp_path, monkeypatch):
    (tmp_path / 'busy').mkdir()
    (tmp_path / 'busy/file').touch()
    for order, folder, said in [
        (ExportRequest('xls'), 'a', "Unknown format 'xls'; known: csv, mat, parquet"),
        (ExportRequest('csv', ('imu',)), 'a', "Unknown topic 'imu'; known: energy/reserve, odom"),
        (ExportRequest('csv'), 'busy', 'is not empty; choose another folder'),
        (ExportRequest('csv', rate=-1.0), 'a', 'The rate is -1.0, but must be a number above 0'),
        (ExportRequest('csv', rate=1.0, method='x'), 'a', "Unknown method 'x'"),
    ]:
        with pytest.raises(BadInput, match=said):
            export_recording(lta_analysis.open(flight_bag), order, tmp_path / folder, Blind())
    assert not (tmp_path / 'a').exists()
    with pytest.raises(
        BadInput, match="'photodiodes' cannot be aligned: light blocks cannot be resampled"
    ):
        files(mixed_bag, 'csv', tmp_path / 'a', rate=1.0, topics=('photodiodes',))

    def full(source, path):
        path.touch()
        raise OSError(28, 'No space left on device')

    monkeypatch.setitem(run.EXPORT_FORMATS, 'csv', full)
    with pytest.raises(
        BadInput, match=r'cannot be written to .*\(No space left on device\); check'
    ):
        files(flight_bag, 'csv', tmp_path / 'full')
    assert list((tmp_path / 'full').iterdir()) == []


def test_a_topic_that_cannot_be_decoded_is_left_out_and_named(record, types, tmp_path):
    rows = [('/lta1/flag', 'std_msgs/msg/Bool', types['std_msgs/msg/Bool'](True), START)]
    bag = record(rows)
    with BagWriter(tmp_path / 'broken', {}) as writer:
        writer.add_topic('/lta1/flag', 'std_msgs/msg/Bool', [])
        writer.add_topic('/lta1/odom', 'nav_msgs/msg/Odometry', [])
        for _, time, data in read_bag(bag).iterate_messages():
            writer.write('/lta1/flag', data, time)
        writer.write('/lta1/odom', b'\0\1\0\0\1\2', START)
    written, done = files(tmp_path / 'broken', 'parquet', tmp_path / 'out')
    assert set(written) == {'flag'}
    assert done.remarks[0].startswith("Topic 'odom' is left out: A message does not match")
    with pytest.raises(BadInput, match='does not match the definition of its type'):
        files(tmp_path / 'broken', 'parquet', tmp_path / 'other', topics=('odom',))


def test_a_topic_larger_than_a_matlab_file_is_refused(flight_bag, tmp_path, monkeypatch):
    monkeypatch.setattr('lta_data.export.run.MAT_BYTES', 1000)
    with pytest.raises(BadInput, match=r"'odom' is larger than the 2 GB .*--format parquet"):
        files(flight_bag, 'mat', tmp_path / 'out', topics=('odom',))


def test_the_command_says_what_it_wrote(flight_bag, tmp_path):
    line = ['bag', 'export', str(flight_bag), '--topics', 'odom', '--json']
    result = CliRunner().invoke(build_app(), [*line, '--out', str(tmp_path / 'out')])
    assert result.exit_code == 0, result.output
    found = json.loads(result.stdout)
    assert found['files'] == [
        {
            'topic': 'odom',
            'file': str(tmp_path / 'out/odom.parquet'),
            'rows': 40,
            'columns': 2 + 87 + 2 + 3,
        }
    ]
    assert found['remarks'] == []
