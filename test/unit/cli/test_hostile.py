# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Whatever a bag carries, it is read or refused in one sentence; it never brings Python down."""

from lta_bag.bag_folder import extract_provenance, find_bag_files, read_metadata
from lta_config.errors import BadInput
from lta_data.scene import read_scene
import pytest

from ..report_flight import write_flight  # noqa: TID252 - `test` is Python's own

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
