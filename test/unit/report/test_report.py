# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Tests of reports: what a page and a terminal show of one declaration."""

from html.parser import HTMLParser
import io

from lta_report.formatting import format_number, MISSING, Tile
from lta_report.report import (
    Grid,
    Picture,
    Report,
    ReportSection,
    TextSection,
    TextTable,
    transpose_table,
)
from lta_report.report_page import is_numeric, render_report, write_report
from lta_report.report_terminal import merge_groups, print_report, print_table
from plotly.graph_objects import Figure
import pytest
from rich.console import Console

TABLE = TextTable(
    'Limits', ('platform', 'wind [m/s]', 'reason'),
    (('gtmab', '1.09', 'it <rises> early'), ('skye', MISSING, 'no limit known')), 'Static.',
    groups=(('', 1), ('uniform wind', 2)),
)  # fmt: skip


def make_report(*blocks, **changes):
    content = {
        'command': 'energy budget', 'subject': 'a & b', 'headline': '3 of 50 flights failed.',
        'introduction': 'Both hover.', 'tiles': [Tile('power', '0.58', 'W', 'mean')],
        'blocks': blocks, 'data': {'power': 0.58}, 'facts': {'commit': 'abc'},
        'closing': ['Done.'],
    }  # fmt: skip
    return Report(**(content | changes))


class TableReader(HTMLParser):
    """Reads the rows of all tables: tag, class and text of each cell."""

    def __init__(self, page):
        super().__init__()
        self.rows, self._cell = [], None
        self.feed(page)

    def handle_starttag(self, tag, attributes):
        if tag == 'tr':
            self.rows.append([])
        elif tag in ('td', 'th'):
            self._cell = [tag, dict(attributes).get('class', ''), '']

    def handle_data(self, text):
        if self._cell is not None:
            self._cell[2] += text

    def handle_endtag(self, tag):
        if tag in ('td', 'th'):
            self.rows[-1].append(tuple(self._cell))
            self._cell = None


def show(report, width, terminal):
    console = Console(
        file=io.StringIO(), width=width, force_terminal=terminal, color_system=None, markup=False
    )
    if isinstance(report, Report):
        print_report(report, console)
    else:
        print_table(report, console)
    return console.file.getvalue()


def test_a_page_shows_every_part_and_escapes_it():
    page = render_report(make_report(TABLE, TextSection('Method', ('a < b',))))
    for text in ('energy budget · a &amp; b', '3 of 50 flights failed.', 'Both hover.', '0.58',
                 'it &lt;rises&gt; early', 'a &lt; b', 'Static.', 'abc'):  # fmt: skip
        assert text in page
    assert '<rises>' not in page


def test_columns_of_words_are_left_aligned_and_numbers_are_not():
    groups, heads, first, second = TableReader(render_report(make_report(TABLE))).rows
    assert [cell[2] for cell in groups] == ['', 'uniform wind']
    assert [cell[1] for cell in heads] == ['text', '', 'text']
    assert first == [
        ('th', '', 'gtmab'), ('td', '', '1.09'), ('td', 'text', 'it <rises> early')
    ]  # fmt: skip
    assert [cell[2] for cell in second] == ['skye', MISSING, 'no limit known']


@pytest.mark.parametrize(
    'cell',
    [
        '1.0',
        format_number(-0.2),
        '+3',
        '<1',
        '0.5 (0.1 to 0.9)',
        'never (2 to never)',
        '∞',
        MISSING,
        '',
    ],
)
def test_cells_that_are_numbers(cell):
    assert is_numeric([cell])
    assert not is_numeric([cell, 'escaped'])
    assert not is_numeric([cell, '2. Forces, drag and masses'])
    assert not is_numeric([cell, './lta sweep heaviness'])


def test_plotly_is_included_only_with_a_picture():
    figure = Picture('speed', 'Speed', 'By time.', Figure(), height=333)
    without, beside = (
        render_report(make_report(TABLE)),
        render_report(make_report(Grid((figure,)))),
    )
    assert 'height: 333px' in beside
    assert 'id="panel-speed"' in beside
    # The library has megabytes; a page of tables has kilobytes
    assert len(without) < 40_000 < 1_000_000 < len(beside)


def test_the_terminal_prints_tables_then_the_headline():
    lines = show(make_report(TABLE, TextSection('Method', ('Hidden.',))), 80, False).splitlines()
    assert lines[0].strip() == 'Limits'
    assert lines[-2:] == ['3 of 50 flights failed.', 'Done.']
    assert 'Static.' in lines
    assert not any('Hidden.' in line for line in lines)


def test_a_wide_table_is_transposed_in_a_narrow_terminal_and_whole_in_a_file():
    heads = ('platform', *(f'number{k} [m/s]' for k in range(12)))
    table = TextTable('Wide', heads, [('gtmab', *('12.34' for _ in range(12)))])
    terminal, file = show(table, 60, True), show(table, 60, False)
    assert len(terminal.strip().splitlines()) == 2 + 12
    assert max(map(len, terminal.splitlines())) <= 60
    assert '…' not in terminal + file
    assert file.count('12.34') == 12
    assert len(file.strip().splitlines()) == 4


def test_long_names_wrap_in_a_narrow_terminal_before_anything_is_cut():
    name = 'loss of lift that the largest vertical command can carry'
    row = (name, '12.3 (11.0 to 14.0)', '1.5 (1 to 2)')
    table = TextTable('Long', ('', 'old', 'new'), [row] * 3)
    text = show(table, 60, True)
    assert max(map(len, text.splitlines())) <= 60
    assert '…' not in text
    assert '12.3 (11.0 to 14.0)' in text
    assert 'can carry' in text


def test_a_table_that_is_too_wide_either_way_is_printed_in_parts_with_every_number():
    heads = ('mount', *(f'number{k} [m/s]' for k in range(12)))
    rows = [(f'mount{n}', *(f'{10 * n + k}.25' for k in range(12))) for n in range(1, 13)]
    lines = show(TextTable('Wide', heads, rows), 60, True).splitlines()
    assert max(map(len, lines)) <= 60
    for name, *numbers in rows:
        found = [line.split() for line in lines if line.split()[:1] == [name]]
        assert [number for _, *part in found for number in part] == numbers
        assert len(found) > 1


def test_a_table_keeps_the_names_of_its_groups_in_the_terminal():
    assert merge_groups(TABLE).heads == [
        'platform', 'uniform wind wind [m/s]', 'uniform wind reason'
    ]  # fmt: skip


def test_long_names_fold_and_numbers_stay_whole_in_a_narrow_terminal():
    name = 'ground_truth/odom/twist.twist.angular.y'
    rows = [(name, '12.3 ADC counts', '-1.5 m/s2', 'always'), (name, MISSING, '9 m/s2', 'late')]
    lines = show(TextTable('', ('channel', 'bias', 'RMS', 'when'), rows), 60, True).splitlines()
    assert lines[1].split(maxsplit=1)[1] == '12.3 ADC counts -1.5 m/s2 always'
    assert lines[3].endswith(f'{MISSING}    9 m/s2 late  ')
    for first, rest in (lines[1:3], lines[3:5]):
        assert first.split()[0] + rest.strip() == name


def test_transposing_twice_gives_the_same_table():
    plain = TextTable('T', ('a', 'b', 'c'), (['x', '1', '2'], ['y', '3', '4']))
    turned = transpose_table(plain)
    assert turned.rows == [['b', '1', '3'], ['c', '2', '4']]
    again = transpose_table(turned)
    assert (list(again.heads), list(again.rows)) == (list(plain.heads), list(plain.rows))


def test_files_of_a_report(tmp_path):
    page = write_report(make_report(TABLE), tmp_path)
    assert page == tmp_path / 'report.html'
    assert (tmp_path / 'budget.json').read_text() == '{\n "power": 0.58\n}\n'
    page.unlink()
    assert write_report(make_report(TABLE), tmp_path, page=False) is None
    assert [each.name for each in tmp_path.iterdir()] == ['budget.json']


CLAIMS = TextTable(
    '', ('claim', 'verdict'), [('thrust', 'agrees'), ('mass', 'differs')], printed=False,
    colors={'agrees': 'good', 'differs': 'bad'},
)  # fmt: skip
FINDINGS = TextSection(
    '', ('*Mass <m>.* It is `271 g`. **A row is missing.**',), True, marked=True
)
SECTION = ReportSection('1. Forces', [CLAIMS, FINDINGS, ReportSection('All 3', [TABLE], True)])


def test_a_section_is_one_panel_and_its_folded_part_opens_on_a_click():
    page = render_report(make_report(SECTION, TextTable('Wrong', ('case',), [])))
    panel = '<section class="panel group" id="section-1-forces" aria-label="1. Forces">'
    assert f'{panel}<h2>1. Forces</h2>' in page
    assert '<details class="group"><summary>All 3</summary>' in page
    assert '<span class="bad">differs</span>' in page
    assert '<i>Mass &lt;m&gt;.</i> It is <code>271 g</code>. <b>A row is missing.</b>' in page
    assert '<h2>Wrong</h2><p class="note">None.</p>' in page
    # The part of a section that the terminal shows
    shown = show(make_report(ReportSection('1', [TABLE, CLAIMS])), 80, False)
    assert 'gtmab' in shown
    assert 'thrust' not in shown
    assert 'gtmab' not in show(make_report(SECTION), 80, False)


def test_a_page_of_many_sections_has_a_list_that_leads_to_each():
    sections = [ReportSection(f'{k}. Drag & lift', [TABLE]) for k in range(1, 6)]
    page = render_report(make_report(*sections))
    for k in range(1, 6):
        assert f'<a href="#section-{k}-drag-lift">{k}. Drag &amp; lift</a>' in page
        assert page.count(f'id="section-{k}-drag-lift"') == 1
    assert 'Contents' not in render_report(make_report(*sections[1:]))
