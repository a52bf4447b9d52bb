"""Whatever a bag carries, it is read or refused in one sentence; it never brings Python down."""

from lta_config.errors import BadInput
from lta_data.bag.bag_folder import extract_provenance, find_bag_files, read_metadata
from lta_data.bag.packed_samples import decode_image, decode_point_cloud
from lta_data.scene import read_scene
import numpy as np
import pytest

from ..report_flight import block, make, peaks, write_flight  # noqa: TID252 - `test` is Python's own

DEEP = '[' * 200_000  # once a crash of the YAML reader's C stack
BOMB = 'a0: &a0 [x]\n' + ''.join(
    f'a{k}: &a{k} [{", ".join(10 * [f"*a{k - 1}"])}]\n' for k in range(1, 10)
)
TEXTS = {
    'deep': DEEP,
    'bomb': BOMB,
    'large': '# ' + 1_000_001 * 'x',
    'twice': 'schema: 1\nschema: 1\n',
    'tag': 'schema: !!int ""',
    'control': 'schema: \x01',
    'surrogate': 'schema: \ud800',
}


@pytest.mark.parametrize('key', ['scenario_file', 'vehicle_file'])
@pytest.mark.parametrize('text', TEXTS.values(), ids=TEXTS)
def test_files_in_the_provenance(key, text):
    with pytest.raises(BadInput, match=rf"^The bag's {key}[^\n]*\.$") as caught:
        read_scene({key: text})
    assert len(str(caught.value)) < 400


@pytest.mark.parametrize('text', TEXTS.values(), ids=TEXTS)
def test_metadata_that_cannot_be_used_leaves_the_recording(tmp_path, text):
    folder = write_flight(tmp_path / 'bag', until=0.0)
    (folder / 'metadata.yaml').write_bytes(text.encode(errors='surrogatepass'))
    assert read_metadata(folder) == {}
    assert extract_provenance(read_metadata(folder)) == {}
    assert find_bag_files(folder) == [folder / 'bag_0.mcap']


@pytest.mark.parametrize(
    'told',
    [
        '[1, 2]',
        '{rosbag2_bagfile_information: 5}',
        '{rosbag2_bagfile_information: {relative_file_paths: 7, custom_data: [1]}}',
        '{rosbag2_bagfile_information: {relative_file_paths: [[], {}, "../x.mcap", "\\0.mcap"]}}',
    ],
)
def test_metadata_of_the_wrong_types_leaves_the_recording(tmp_path, told):
    folder = write_flight(tmp_path / 'bag', until=0.0)
    (folder / 'metadata.yaml').write_text(told)
    assert extract_provenance(read_metadata(folder)) == {}
    assert find_bag_files(folder) == [folder / 'bag_0.mcap']


@pytest.mark.parametrize(
    ('given', 'sentence'),
    [
        ({'datatype': 99}, "^Unknown point field type '99'; known: 1, 2, 3, 4, 5, 6, 7, 8.$"),
        ({'datatype': 0}, "^Unknown point field type '0'"),
        ({'offset': 4_000_000_000}, 'do not match'),
        ({'offset': 21}, 'do not match'),
        ({'name': 'x'}, 'do not match'),  # as another one
        ({'point_step': 0}, 'do not match'),
        ({'point_step': 25}, 'do not match'),
        ({'row_step': 191}, 'do not match'),
        ({'row_step': 193}, 'do not match'),
        ({'height': 2}, 'do not match'),
        ({'height': 4_294_967_295}, 'do not match'),
        ({'width': 9}, 'do not match'),
        ({'data': np.zeros(191, np.uint8)}, 'do not match'),
    ],
)
def test_a_point_cloud_that_does_not_fit(given, sentence):
    cloud = peaks(5.0)
    for name, value in given.items():
        setattr(cloud.fields[-1] if hasattr(cloud.fields[-1], name) else cloud, name, value)
    with pytest.raises(BadInput, match=sentence):
        decode_point_cloud(cloud)


def test_a_point_cloud_without_points_or_fields_is_empty():
    cloud = peaks(5.0)
    cloud.width = cloud.height = cloud.row_step = 0
    cloud.data = np.zeros(0, np.uint8)
    assert {
        name: len(column) for name, column in decode_point_cloud(cloud).items()
    } == dict.fromkeys(['x', 'y', 'z', 'amplitude', 'snr', 'frequency'], 0)
    assert decode_point_cloud(make('sensor_msgs/msg/PointCloud2', height=3)) == {}


@pytest.mark.parametrize('given', [{'height': 1001}, {'step': 15}, {'step': 17}, {'width': 9}])
def test_an_image_that_does_not_fit(given):
    image = block(5.0)
    for name, value in given.items():
        setattr(image, name, value)
    with pytest.raises(BadInput, match='do not match'):
        decode_image(image)
