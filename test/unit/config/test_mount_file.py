"""Mount files: what is read, what is refused, and what becomes of a vehicle file."""

from lta_config.errors import BadInput
from lta_config.files import find_file, list_shipped_names, load_yaml
from lta_config.schema.mount_file import load_mount, mount_panels
import pytest
import yaml

VEHICLE = load_yaml(find_file('vehicle', 'gtmab'))


@pytest.mark.parametrize('name', list_shipped_names('mounts'))
def test_shipped_mounts_are_what_their_files_are_called(name):
    assert load_mount(name).name == name


@pytest.mark.parametrize('name', list_shipped_names('mounts'))
def test_every_mount_carries_the_papers_panels(name):
    mount = load_mount(name)
    panels = [mount.parts[panel] for panel in mount.panels]
    assert sum(part.mass.si for part in panels) == pytest.approx(48.8e-3, rel=1e-12)
    faces = [sorted(part.size.vector)[1:] for part in panels]
    assert sum(a * b for a, b in faces) == pytest.approx(138.84e-4, rel=1e-12)


def test_the_papers_frame_weighs_45_5_grams_and_reaches_40_cm():
    mount = load_mount('bottom')
    arms = [part for name, part in mount.parts.items() if name not in mount.panels]
    assert sum(part.mass.si for part in arms) == pytest.approx(45.5e-3, rel=1e-12)
    assert {part.size.vector[1] for part in arms} == {0.4}


def test_a_mount_takes_the_place_of_a_layer_and_of_nothing_else():
    made = mount_panels(VEHICLE, 'side')
    assert list(made['layers']) == list(VEHICLE['layers'])
    assert set(made['layers']['top']) == {'panel_left', 'panel_right'}
    changed = {key for key in made if made[key] != VEHICLE[key]}
    assert changed == {'name', 'layers', 'energy'}
    assert made['energy']['array']['part'] == 'panel_left'
    assert made['energy']['array']['normal']['value'] == [0.0, 1.0, 0.0]


def test_misplaced_panels_sit_ahead_and_their_frame_does_not():
    made = mount_panels(VEHICLE, 'bottom', ahead=0.03)['layers']['top']
    straight = mount_panels(VEHICLE, 'bottom')['layers']['top']
    assert made['panel_left']['position']['value'] == pytest.approx([0.03, 0.56, -0.36])
    assert made['arm_left'] == straight['arm_left']


def written(tmp_path, change):
    content = load_yaml(find_file('mount', 'top'))
    change(content)
    path = tmp_path / 'mine.yaml'
    path.write_text(yaml.safe_dump(content), encoding='utf-8')
    return str(path)


def test_a_panel_that_is_no_part_is_refused_with_the_parts(tmp_path):
    name = written(tmp_path, lambda content: content['parts'].pop('panel_rear'))
    with pytest.raises(
        BadInput, match=r'panel panel_rear, but no part of that name; parts: panel_front'
    ):
        load_mount(name)


def test_a_normal_that_is_no_direction_is_refused(tmp_path):
    def lengthen(content):
        content['panels']['panel_rear']['normal']['value'] = [0, 0.6, 0.2]

    with pytest.raises(BadInput, match=r'normal of length 0\.632, but needs a unit vector'):
        load_mount(written(tmp_path, lengthen))


def test_a_vehicle_without_the_layer_is_refused_with_its_layers():
    with pytest.raises(BadInput, match=r'top.*hull, sensors'):
        mount_panels({**VEHICLE, 'layers': {'hull': {}, 'sensors': {}}}, 'side')
