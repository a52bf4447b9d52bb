# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A row of results is formatted in its units and stored in SI units."""

import math
from typing import NamedTuple

from lta_flight.sweep.statistics import MeanInterval
from lta_report.charts import ChartAxis, Curve, draw_curves, Level
from lta_report.formatting import MISSING
from lta_report.result_table import build_table, Column, format_value, Spread, to_record
import pytest


class Craft(NamedTuple):
    name: str
    power: float
    lean: float | None = None


COLUMNS = (
    Column('', 'craft', of=lambda row: row.name),
    Column('power', 'power', 'mW', 0),
    Column('lean', 'lean', '°', 1),
    Column('twice', of=lambda row: 2.0 * row.power),
)
ROWS = (Craft('gtmab', 0.7264, math.pi / 6.0), Craft('skye', math.nan))


def test_the_table_has_units_and_the_record_is_in_si():
    table = build_table('Power', COLUMNS, ROWS)
    assert table.heads == ['craft', 'power [mW]', 'lean [°]']
    assert table.rows == [['gtmab', '726', '30.0'], ['skye', MISSING, MISSING]]
    assert to_record(COLUMNS, ROWS[0]) == pytest.approx(
        {'power': 0.7264, 'lean': math.pi / 6.0, 'twice': 1.4528}
    )
    assert to_record(COLUMNS, ROWS[1]) == {'power': None, 'lean': None, 'twice': None}


def test_the_papers_values_stand_beside_those_of_their_column_and_meanings_in_the_note():
    stated = {'gtmab': (1.2, 1.4)}
    power = Column(
        'power', 'power', 'mW', 0, meaning='of all rotors',
        paper=lambda row: stated.get(row.name, ()),
    )  # fmt: skip
    table = build_table('Power', (COLUMNS[0], power), ROWS, 'At rest.')
    assert table.heads == ['craft', 'power [mW]', 'paper [mW]', 'ours / paper']
    assert table.rows[0] == ['gtmab', '726', '1200\N{EN DASH}1400', '0.56']
    assert table.rows[1] == ['skye', MISSING, MISSING, MISSING]
    assert table.note == 'power: of all rotors. At rest.'
    assert to_record([power], ROWS[0]) == {'power': 0.7264, 'paper_power': [1.2, 1.4]}


@pytest.mark.parametrize(
    ('value', 'cell'),
    [
        (MeanInterval(1.0, 0.5, 1.5), '1.0 (0.5 to 1.5)'),
        (MeanInterval(1.0, math.nan, math.nan), '1.0'),
        (Spread(2.0, 0.3), '2.0\N{PLUS-MINUS SIGN}0.3'),
        (Spread(2.0, 0.01), '2.0'),
        (-0.01, '0.0'),
        (-1.0, '\N{MINUS SIGN}1.0'),
        (True, 'yes'),
        ((1.0, 2.0), '1.0, 2.0'),
        (math.inf, MISSING),
    ],
)
def test_a_cell_is_formatted_by_what_it_is(value, cell):
    assert format_value(value, 1) == cell


def test_words_at_a_level_are_at_its_logarithm_on_a_logarithmic_axis():
    curve = Curve('light', [1.0, 2.0], [10.0, 1000.0], '#000000')
    axes = ChartAxis('distance [m]'), ChartAxis('light [lx]', log=True)
    figure = draw_curves([curve], *axes, levels=[Level(100.0, 'needed')])
    (words,) = figure.layout.annotations
    (line,) = figure.layout.shapes
    assert (words.y, line.y0) == (2.0, 100.0)
