# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Mount files: what they carry, and what becomes of a vehicle file."""

from lta_config.files import find_file, list_shipped_names, load_yaml
from lta_config.schema.mount_file import load_mount, mount_panels
import pytest

VEHICLE = load_yaml(find_file('vehicle', 'gtmab'))


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
