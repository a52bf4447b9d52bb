"""The files of the paper's rows are read strictly."""

import copy

from lta_config.errors import BadInput
from lta_config.files import find_file, list_shipped_names, load_yaml, validate_content
from lta_config.schema.paper_file import (
    load_paper_row,
    load_paper_rows,
    PaperRow,
)
import pytest

CELLS = load_yaml(find_file('row of the paper', 'cells'))


@pytest.mark.parametrize('name', list_shipped_names('paper'))
def test_every_row_is_read_and_is_called_what_its_file_is(name):
    assert load_paper_row(name).name == name


def test_rows_come_in_the_order_of_the_paper():
    numbers = [row.number for row in load_paper_rows()]
    assert numbers == sorted(set(numbers))


def changed(path, value):
    content = copy.deepcopy(CELLS)
    inner = content
    for key in path[:-1]:
        inner = inner[key]
    inner[path[-1]] = value
    return content


@pytest.mark.parametrize(
    ('path', 'value', 'word'),
    [
        (('claims', 'front', 'measure'), 'nobody', 'nobody'),
        (('claims', 'front', 'finding'), 'so {nobody} says', 'nobody'),
        (('claims', 'areal_mass', 'rule'), {'least': '1 m'}, 'measure is in %'),
        (('claims', 'areal_mass', 'rule'), {'is': 'quick'}, 'text'),
        (('claims', 'front', 'rule'), {'within': '1 %', 'is': 'x'}, 'needs exactly one rule'),
        (('claims', 'dracula_time', 'untested'), '', 'untested'),
        (('claims', 'areal_mass', 'rule'), {'within': '1 %'}, 'no "value"'),
        (('measures', 'sheet_seeed', 'unit'), 'furlong', 'furlong'),
    ],
)
def test_what_does_not_hold_together_is_one_sentence(path, value, word):
    with pytest.raises(BadInput, match=word):
        validate_content(PaperRow, changed(path, value), 'cells')
