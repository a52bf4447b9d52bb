# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Ranges of what is assumed: their form, their draws, and that no assumed number lacks one."""

from lta_config.files import find_file, list_shipped_names, load_yaml, validate_content
from lta_config.parameter_override import draw_content, draw_values, list_ranges
from lta_config.quantity import Quantity
from lta_config.schema.cell_file import CellFile
from lta_config.schema.vehicle_file import VehicleFile
from lta_model.vehicle import Vehicle
import numpy as np
from pydantic import ValidationError
import pytest

BELIEFS = ('sensors.diodes.response_deviation',)  # of the drone, not of the world
# The bare wafer is behind no claim
CELLS = [name for name in list_shipped_names('cells') if name != 'monocrystalline']
FILES = [('vehicle', 'gtmab'), *(('cell', name) for name in CELLS)]
CONTENT = {
    'a': {'value': 2.0, 'unit': 'm', 'source': 'x', 'range': [1.0, 3.0], 'range_source': 'one'},
    'b': {
        'c': {'value': [5.0, 0.0], 'unit': 'cm', 'source': 'x', 'range': [[4.0, 0.0], [8.0, 0.0]],
              'range_source': 'one'},
        'd': {'value': 2.0, 'unit': 'm', 'source': 'x', 'range': [3.0, 1.0],
              'range_source': 'two'},
    },
}  # fmt: skip


def list_assumed(content, path=''):
    """Yield the paths of all numbers whose source says that they are assumed."""
    for key, below in content.items() if isinstance(content, dict) else ():
        place = f'{path}.{key}' if path else key
        if isinstance(below, dict) and 'unit' in below:
            if 'assumed' in str(below.get('source')):
                yield place
        else:
            yield from list_assumed(below, place)


@pytest.mark.parametrize(('root', 'name'), FILES, ids=lambda each: each)
def test_every_assumed_number_has_a_range_that_holds_it(root, name):
    content = load_yaml(find_file(root, name))
    ranges = {found.path: found.quantity for found in list_ranges(content)}
    assert set(list_assumed(content)) - set(BELIEFS) <= ranges.keys()
    for path, held in ranges.items():
        low, high = np.sort(np.array(held['range'], dtype=float), axis=0)
        assert np.all(low <= held['value']), path
        assert np.all(held['value'] <= high), path
        assert np.any(low < high), path


def test_draws_are_even_between_the_ends_and_repeatable():
    found = np.array([draw_values(CONTENT, seed)['a']['value'] for seed in range(1, 401)])
    assert found.min() >= 1.0
    assert found.max() <= 3.0
    # Mean and deviation of an even distribution over 2 m, five standard errors
    assert found.mean() == pytest.approx(2.0, abs=5 * 2.0 / 12**0.5 / 20)
    assert found.std() == pytest.approx(2.0 / 12**0.5, rel=0.15)
    assert draw_values(CONTENT, 7) == draw_values(CONTENT, 7)


def test_equal_causes_move_together_and_others_do_not():
    drawn = [draw_values(CONTENT, seed) for seed in range(1, 101)]
    a = np.array([each['a']['value'] for each in drawn])
    c = np.array([each['b.c']['value'] for each in drawn])
    d = np.array([each['b.d']['value'] for each in drawn])
    assert c[:, 0] == pytest.approx(4.0 + (a - 1.0) / 2.0 * 4.0)
    assert np.all(c[:, 1] == 0.0)
    # Correlation of 100 independent pairs: 0.1 rms
    assert abs(np.corrcoef(a, d)[0, 1]) < 0.4


def test_a_drawn_number_is_exact_and_says_so():
    drawn = draw_content(CONTENT, 3, 'vehicle')
    assert 'range' not in drawn['b']['c']
    assert drawn['b']['c']['unit'] == 'cm'
    assert list_ranges(drawn) == []


@pytest.mark.parametrize(
    'change',
    [
        {'range_source': None},
        {'range': None},
        {'range': [1.0, [2.0]]},
        {'range': [1.0]},
    ],
)
def test_a_range_of_another_form_is_refused(change):
    content = {key: each for key, each in {**CONTENT['a'], **change}.items() if each is not None}
    with pytest.raises(ValidationError):
        Quantity.model_validate(content)


def test_every_draw_of_gtmab_and_its_cell_is_valid():
    vehicle, cell = (
        load_yaml(find_file(*each)) for each in (('vehicle', 'gtmab'), ('cell', 'anysolar'))
    )
    for seed in range(1, 21):
        file = validate_content(VehicleFile, draw_content(vehicle, seed, 'vehicle'), 'a draw')
        # The rotors lift it, and the layers are below the hull
        assert Vehicle(file).hover_duty > 0.0
        assert Vehicle(file).cg[2] < 0.0
        validate_content(CellFile, draw_content(cell, seed, 'cell'), 'a draw')
