# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
`lta bag upgrade`, against what rosbags decodes of a bag that version 1 recorded.

version_1.mcap has the first messages after 9 s of a flight in one process: three each of imu, odom
and motors, two each of photodiodes, light/peaks and energy/status.
"""

from pathlib import Path

from lta_bag import BagWriter
from lta_bag.reader import read_bag
from lta_bag.schemas import load_jazzy_types
from lta_bridge.playback.recording import open_recording
from lta_config.errors import BadInput
from lta_config.files import find_file
from lta_config.topics import load_topic_table
from lta_data.bag import open_flight, summarize_bag
from lta_data.importers.readers.rosbags_bag import list_raw_topics, open_mcap_log
from lta_data.importers.upgrade import upgrade_bag
import numpy as np
import pytest
from rosbags.highlevel import AnyReader
import yaml

from ...report_flight import header, make  # noqa: TID252 - `test` is Python's own

OLD = Path(__file__).with_name('version_1.mcap')
CONVERTED = ('energy/status', 'light/peaks', 'motors', 'photodiodes')
ARRAY = 'diagnostic_msgs/msg/DiagnosticArray'
CLOUD = 'sensor_msgs/msg/PointCloud2'
IMAGE = 'sensor_msgs/msg/Image'
JOINTS = 'sensor_msgs/msg/JointState'


@pytest.fixture(scope='module')
def upgraded(tmp_path_factory):
    folder = tmp_path_factory.mktemp('upgraded') / 'bag'
    upgrade_bag(OLD, folder)
    return folder


def decode_topic(bag, name):
    """Return time and message of a topic, as rosbags has them."""
    with AnyReader([bag]) as reader:
        connections = [each for each in reader.connections if each.topic == f'/lta1/{name}']
        return [
            (time, reader.deserialize(raw, connection.msgtype))
            for connection, time, raw in reader.messages(connections)
        ]


def pair_topic(upgraded, name):
    """Yield each message of a topic before and after."""
    before, after = decode_topic(OLD, name), decode_topic(upgraded, name)
    assert [time for time, _ in before] == [time for time, _ in after]
    assert before
    for (_, old), (_, new) in zip(before, after, strict=True):
        stamps = [(m.header.stamp.sec, m.header.stamp.nanosec) for m in (old, new)]
        assert stamps[0] == stamps[1]
        assert old.header.frame_id == new.header.frame_id
        yield old, new


def test_only_four_topics_change(upgraded):
    before, after = read_bag(OLD), read_bag(upgraded)
    assert [*before.topics] == [*after.topics]
    for name, topic in after.topics.items():
        relative = name.removeprefix('/lta1/')
        assert topic.type_name == load_topic_table()[relative].type
        same = list(before.iterate_messages([name])) == list(after.iterate_messages([name]))
        assert same == (relative not in CONVERTED), name
        offered, kept = (list_raw_topics(bag)[name].qos for bag in (before, after))
        assert offered == kept
    assert after.provenance.items() > before.provenance.items()
    assert open_flight(upgraded).topics


def test_blocks_have_the_samples_of_the_images(upgraded):
    for image, block in pair_topic(upgraded, 'photodiodes'):
        assert (block.diodes, block.sample_rate) == (8, 10e3)
        assert block.counts.tobytes() == image.data.tobytes()
    assert open_flight(upgraded).read_blocks('photodiodes').samples.shape == (2, 1000, 8)


def test_peaks_have_the_points_of_the_clouds(upgraded):
    for cloud, peaks in pair_topic(upgraded, 'light/peaks'):
        points = cloud.data.view('<f4').reshape(1, 8, 6)
        assert [[axis.x, axis.y, axis.z] for axis in peaks.axis] == points[0, :, :3].tolist()
        (beacon,) = peaks.beacon
        for index, name in enumerate(('amplitude', 'snr', 'frequency'), start=3):
            np.testing.assert_array_equal(getattr(beacon, name), points[0, :, index])
        assert max(beacon.amplitude) > 1.0


def test_duties_have_the_efforts_of_the_joints(upgraded):
    for joints, motors in pair_topic(upgraded, 'motors'):
        assert motors.name == joints.name == [
            'up_left', 'up_right', 'forward_left', 'forward_right',
        ]  # fmt: skip
        assert motors.duty.tolist() == joints.effort.tolist()
        assert max(motors.duty) > 0.0


def test_the_energy_status_has_the_texts_as_numbers(upgraded):
    for array, status in pair_topic(upgraded, 'energy/status'):
        battery, meters = array.status
        assert (status.level, status.message) == (battery.level, battery.message)
        assert (status.meters_level, status.meters_message) == (meters.level, meters.message)
        texts = {item.key: float(item.value) for item in battery.values}
        assert len(texts) == 21
        for key, value in texts.items():
            np.testing.assert_equal(getattr(status, key.rpartition('_')[0]), value)
        assert status.consumed == texts['consumed_J'] > 0.0


def test_the_command_says_what_it_converted_and_then_has_nothing_to_do(call, tmp_path):
    new = tmp_path / 'new'
    status, said = call('bag', 'upgrade', OLD, '--out', new, columns=400)
    assert (status, said.err) == (0, '')
    assert said.out == (
        'The messages of /lta1/energy/status (2), /lta1/light/peaks (2), /lta1/motors (3), '
        f'/lta1/photodiodes (2) were converted, and 6 others copied, to {new}.\n'
    )
    status, said = call('bag', 'upgrade', new)
    assert status == 2
    assert said.err == (
        f"'{new}' needs no upgrade: it has no messages of version 1; use it as it is.\n"
    )


def test_every_other_reader_names_the_command(call, tmp_path):
    advice = (
        f"'{OLD}' has messages of version 1 on energy/status, light/peaks, photodiodes; convert "
        f'it with: lta bag upgrade {OLD}'
    )
    for words in (('bag', 'plot', OLD), ('compare', OLD, OLD), ('report', OLD)):
        status, said = call(*words)
        assert (status, said.err) == (2, f'{advice}\n'), words
    for opened in (lambda: open_flight(OLD), lambda: open_recording(OLD, '', load_topic_table())):
        with pytest.raises(BadInput) as caught:
            opened()
        assert str(caught.value) == advice
    assert summarize_bag(OLD).remarks == [advice]


def write(folder, topic, kind, message, **provenance):
    with BagWriter(folder, provenance) as bag:
        bag.add_topic(f'/lta1/{topic}', kind, [])
        bag.write(f'/lta1/{topic}', bytes(load_jazzy_types().serialize_cdr(message, kind)), 1)
    return folder


def build_image(**changed):
    image = {'height': 3, 'width': 2, 'encoding': '16UC1', 'step': 4}
    return make(IMAGE, header=header(0.0), **{**image, 'data': np.zeros(12, np.uint8), **changed})


def build_cloud(names='x y z amplitude snr', **changed):
    fields = [
        make('sensor_msgs/msg/PointField', name=name, offset=4 * k, datatype=7, count=1)
        for k, name in enumerate(names.split())
    ]
    step = 4 * len(fields)
    cloud = {'height': 2, 'width': 3, 'fields': fields, 'point_step': step, 'row_step': 3 * step}
    data = np.arange(6 * len(fields), dtype='<f4').view(np.uint8)
    return make(CLOUD, header=header(0.0), **{**cloud, 'data': data, **changed})


def build_array(*names):
    statuses = [make('diagnostic_msgs/msg/DiagnosticStatus', name=name) for name in names]
    return make(ARRAY, header=header(0.0), status=statuses)


@pytest.mark.parametrize(
    ('topic', 'kind', 'message', 'why'),
    [
        ('photodiodes', IMAGE, build_image(encoding='rgb8'), "it has the encoding 'rgb8'"),
        ('photodiodes', IMAGE, build_image(is_bigendian=1), "it has the encoding '16UC1'"),
        ('photodiodes', IMAGE, build_image(height=4), '4 x 2 samples do not fit 12 bytes'),
        ('photodiodes', IMAGE, build_image(height=2**32 - 1), 'do not fit 12 bytes'),
        ('light/peaks', CLOUD, build_cloud('x y z amplitude'), 'its points have no snr'),
        ('light/peaks', CLOUD, build_cloud(''), 'its points have no amplitude'),
        ('light/peaks', CLOUD, build_cloud(height=3), 'the layout of its points'),
        ('light/peaks', CLOUD, build_cloud(width=2**32 - 1), 'the layout of its points'),
        ('light/peaks', CLOUD, build_cloud(point_step=0), 'the layout of its points'),
        ('light/peaks', CLOUD, build_cloud(point_step=18), 'the layout of its points'),
        ('light/peaks', CLOUD, build_cloud(is_bigendian=True), 'the layout of its points'),
        (
            'light/peaks',
            CLOUD,
            build_cloud(height=2**32 - 1, width=0, row_step=0, data=np.zeros(0, np.uint8)),
            'the layout of its points',
        ),
        ('motors', JOINTS, make(JOINTS, name=['a'], position=np.ones(1)), 'it has positions'),
        ('energy/status', ARRAY, build_array('engine'), 'its statuses are not energy'),
        ('energy/status', ARRAY, build_array(), 'its statuses are not energy'),
    ],
)
def test_what_version_1_never_wrote_is_refused_and_leaves_nothing(
    tmp_path, topic, kind, message, why
):
    bag = write(tmp_path / 'old', topic, kind, message)
    with pytest.raises(BadInput, match=rf"'/lta1/{topic}' has a message that is not.*{why}"):
        upgrade_bag(bag, tmp_path / 'new')
    assert not (tmp_path / 'new').exists()


def test_clouds_without_a_frequency_have_two_beacons_of_three_diodes(tmp_path):
    upgrade_bag(write(tmp_path / 'old', 'light/peaks', CLOUD, build_cloud()), tmp_path / 'new')
    ((_, peaks),) = decode_topic(tmp_path / 'new', 'light/peaks')
    # Points of five numbers, counted from 0
    assert [axis.y for axis in peaks.axis] == [1.0, 6.0, 11.0]
    assert [beacon.snr.tolist() for beacon in peaks.beacon] == [[4, 9, 14], [19, 24, 29]]
    assert all(np.isnan(beacon.frequency).all() for beacon in peaks.beacon)


@pytest.mark.parametrize('key', ['vehicle_file', 'lta1/vehicle_file'])
def test_the_vehicle_gets_one_resistor(tmp_path, key):
    """Version 1 listed three, which a vehicle file of today refuses."""
    today = find_file('vehicle', 'gtmab').read_text()
    old = today.replace('feedback: {value: 100,', 'feedback: {value: [100, 10, 2],')
    assert old != today
    joints = make(JOINTS, header=header(0.0), name=['left'], effort=np.array([0.05]))
    bag = write(tmp_path / 'old', 'motors', JOINTS, joints, **{key: old})
    upgrade_bag(bag, tmp_path / 'new')
    text = read_bag(tmp_path / 'new').provenance[key]
    assert yaml.safe_load(text) == yaml.safe_load(today)


def test_an_import_keeps_commands_and_topics_of_others(tmp_path):
    bag = write(tmp_path / 'a', 'energy/status', ARRAY, build_array('engine'), importer='lta')
    assert open_flight(bag)['energy/status']['status[0].name'].tolist() == ['engine']
    joints = make(JOINTS, header=header(0.0), name=['left'], effort=np.array([0.05]))
    bag = write(tmp_path / 'b', 'motors', JOINTS, joints, importer='lta')
    assert open_flight(bag)['motors']['effort.left'].tolist() == [0.05]
    with pytest.raises(BadInput, match='needs no upgrade'):
        upgrade_bag(bag, tmp_path / 'new')


def test_a_copy_of_a_bag_of_version_1_is_refused_with_the_advice_to_upgrade():
    with pytest.raises(BadInput, match='convert it with: lta bag upgrade'):
        open_mcap_log(OLD, None)
