# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Setting numbers of a vehicle file: value, source, and refusals that change nothing."""

from lta_config.errors import BadInput
from lta_model.vehicle import load_vehicle
from lta_vehicle.new_vehicle import write_new_vehicle
from lta_vehicle.number_edit import edit_vehicle_file
import pytest


@pytest.fixture
def file(tmp_path):
    path = tmp_path / 'mine.yaml'
    write_new_vehicle('mine', 'gtmab', path)
    return path


def test_a_number_gets_its_value_and_its_source_and_the_rest_stays(file):
    before = file.read_text().splitlines()
    (edit,) = edit_vehicle_file(file, ['trim.heaviness=3 g'], 'kitchen scale')
    assert (edit.before, edit.after) == ('2 g', '3 g')
    assert (edit.source, edit.is_stale) == ('kitchen scale', False)
    heaviness = load_vehicle(str(file)).file.trim.heaviness
    assert (heaviness.si, heaviness.source) == (pytest.approx(0.003), 'kitchen scale')
    after = file.read_text().splitlines()
    assert [k for k, (a, b) in enumerate(zip(before, after, strict=True)) if a != b] == [
        next(k for k, line in enumerate(before) if line.lstrip().startswith('heaviness:'))
    ]


def test_a_changed_number_with_its_old_source_is_stale(file):
    (edit,) = edit_vehicle_file(file, ['trim.heaviness=3 g'], None)
    assert edit.is_stale
    assert edit.source.startswith('seed paper')
    (edit,) = edit_vehicle_file(file, ['vehicle.trim.heaviness=3 g'], None)
    assert not edit.is_stale


@pytest.mark.parametrize(
    ('change', 'said'),
    [
        ('trim.heavines=3 g', 'heavines'),
        ('trim.heaviness=3 m', 'trim.heaviness'),
        ('trim.heaviness', 'is not an assignment'),
        ('trim.heaviness=9 kg', 'must be from -0.1 to 1 kg'),
    ],
)
def test_what_cannot_be_leaves_the_file_as_it_was(file, change, said):
    before = file.read_text()
    with pytest.raises(BadInput, match=said):
        edit_vehicle_file(file, ['trim.ballast_position=[0, 0, -38] cm', change], 'me')
    assert file.read_text() == before
