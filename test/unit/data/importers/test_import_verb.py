# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The command: several logs at once, all or nothing, and what it prints."""

import json
from pathlib import Path
import re
from typing import get_args

from lta_bag.reader import read_bag
from lta_cli import app
from lta_config.files import list_shipped_names, parse_yaml, validate_content
from lta_config.schema.import_file import FIELD_AXES, Format, ImportMapping, load_mapping
from lta_data.importers.entry_plan import EXTRA, MESSAGE_SHAPES, plan_entry
from lta_data.importers.formats import LOG_FORMATS
import pytest

TRACE = '1.5 1 2 3 0 0 0 1\n2.5 1 2 4 0 0 0 1\n'


@pytest.fixture
def lta(monkeypatch, capsys):
    """Return what runs a command line: status, stdout and stderr."""

    def run(*words):
        monkeypatch.setattr('sys.argv', ['lta', *map(str, words)])
        status = app.run_command_line()
        told = capsys.readouterr()
        return status, told.out, told.err

    return run


def test_several_logs_become_a_bag_each(lta, tmp_path):
    for folder in ('a', 'b'):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / 'trace.txt').write_text(TRACE)
    (tmp_path / 'other.txt').write_text(TRACE)
    sources = [tmp_path / 'a/trace.txt', tmp_path / 'b/trace.txt', tmp_path / 'other.txt']
    out = tmp_path / 'lab' / 'out'
    status, text, _ = lta('import', *sources, '--mapping', 'tum', '--out', out, '--json')
    assert status == 0
    found = json.loads(text)
    assert [Path(one['bag']) for one in found] == [
        out / 'trace/bag',
        out / 'trace-2/bag',
        out / 'other/bag',
    ]
    assert [one['topics'] for one in found] == [{'/lta1/ground_truth/odom': 2}] * 3
    assert all(read_bag(one['bag']).is_complete for one in found)
    assert sorted(path.name for path in out.parent.iterdir()) == ['out']


def test_one_that_fails_leaves_nothing_of_the_others(lta, tmp_path):
    (tmp_path / 'good.txt').write_text(TRACE)
    (tmp_path / 'bad.txt').write_text(TRACE + '3.5 1 2 x 0 0 0 1\n')
    out = tmp_path / 'out'
    out.mkdir()
    words = ['import', tmp_path / 'good.txt', tmp_path / 'bad.txt', '--mapping', 'tum']
    status, text, error = lta(*words, '--out', out)
    assert (status, text) == (2, '')
    assert "'x' in column 'tz', row 3, is not a number" in error
    assert list(out.iterdir()) == []
    assert {path.name for path in tmp_path.iterdir()} == {'good.txt', 'bad.txt', 'out'}


def test_what_is_printed_for_people_names_topics_bag_and_what_is_odd(lta, tmp_path):
    (tmp_path / 'trace.txt').write_text(TRACE + TRACE)
    words = ['import', tmp_path / 'trace.txt', '--mapping', 'tum', '--robot', 'hawk']
    status, text, _ = lta(*words, '--out', tmp_path / 'out')
    assert status == 0
    told = ' '.join(text.split())
    assert '/hawk/ground_truth/odom: 4 messages' in told
    assert 'The time goes back once, first in row 3; these rows are kept.' in told
    assert 'bag info' in told
    # Degrees read as radians are found there
    assert 'bag check' in told


CASES = {
    'nothing there': ('nowhere.csv', None, (), 'does not exist'),
    'empty': ('a.csv', b'', (), 'is empty; give a log with data'),
    'unknown': ('a.bin', b'\x00\x01\x02', (), 'is not in a known format (csv: '),
    'no mapping': ('a.csv', b't,x\n1,2\n', (), 'No shipped mapping fits the columns of'),
    'wrong mapping': ('a.csv', b't,x\n1,2\n', ('--mapping', 'px4'), 'is for the format ulog, but'),
    'unknown mapping': (
        'a.csv',
        b't,x\n1,2\n',
        ('--mapping', 'mine'),
        'known: ardupilot, crazyflie_usd, euroc',
    ),
    'unknown format': ('a.csv', b't,x\n1,2\n', ('--format', 'xls'), "Unknown format 'xls'"),
    'other format': ('a.csv', b't,x\n1,2\n', ('--format', 'usd'), 'is not a Crazyflie log'),
    'robot': (
        'a.csv',
        b't,x\n1,2\n',
        ('--robot', 'a b'),
        "--robot 'a b' is not a valid ROS namespace",
    ),
    'vehicle': ('a.txt', TRACE.encode(), ('--mapping', 'tum', '--vehicle', 'x'), 'known: beavis'),
    'spreadsheet': ('a.xlsx', b'PK\3\4\0', (), 'a zip archive or a spreadsheet; unpack it, or'),
    'not a gzip': ('a.csv.gz', b'\x1f\x8bnothing', (), 'cannot be read'),
}


@pytest.mark.parametrize(('name', 'data', 'words', 'sentence'), CASES.values(), ids=CASES)
def test_what_cannot_be_imported_is_one_sentence(lta, tmp_path, name, data, words, sentence):
    if data is not None:
        (tmp_path / name).write_bytes(data)
    status, text, error = lta('import', tmp_path / name, '--out', tmp_path / 'out', *words)
    assert (status, text) == (2, '')
    assert sentence in error
    assert error.count('\n') == 1
    assert not (tmp_path / 'out').exists()


def test_results_of_others_are_not_touched(lta, tmp_path):
    (tmp_path / 'trace.txt').write_text(TRACE)
    (tmp_path / 'out').mkdir()
    (tmp_path / 'out' / 'mine').write_text('precious')
    words = ['import', tmp_path / 'trace.txt', '--mapping', 'tum', '--out', tmp_path / 'out']
    status, _, error = lta(*words)
    assert status == 2
    assert 'is not empty; choose another folder' in error
    assert (tmp_path / 'out' / 'mine').read_text() == 'precious'


def test_an_empty_folder_that_cannot_be_replaced_is_filled(lta, tmp_path):
    """Behind a link here; a disk that is mounted there is no more to be renamed."""
    (tmp_path / 'trace.txt').write_text(TRACE)
    (tmp_path / 'disk').mkdir()
    (tmp_path / 'out').symlink_to(tmp_path / 'disk')
    words = ['import', tmp_path / 'trace.txt', '--mapping', 'tum', '--out', tmp_path / 'out']
    assert lta(*words)[0] == 0
    assert [path.name for path in (tmp_path / 'disk').iterdir()] == ['bag']


@pytest.mark.parametrize('name', list_shipped_names('imports'))
def test_shipped_mappings_are_named_as_their_files(name):
    mapping, text = load_mapping(name)
    assert isinstance(mapping, ImportMapping)
    assert mapping.name == name
    assert text.startswith('# ')


def test_the_formats_of_mappings_are_those_that_are_read():
    assert list(LOG_FORMATS) == list(get_args(Format))
    assert {load_mapping(name)[0].format for name in list_shipped_names('imports')} <= set(
        LOG_FORMATS
    )


def test_a_flights_results_folder_is_its_bag(lta, tmp_path):
    (tmp_path / 'trace.txt').write_text(TRACE)
    once, again = tmp_path / 'once', tmp_path / 'again'
    assert lta('import', tmp_path / 'trace.txt', '--mapping', 'tum', '--out', once)[0] == 0
    assert lta('import', once, '--out', again)[0] == 0
    bags = [read_bag(folder / 'bag') for folder in (once, again)]
    assert len(set(map(str, (list(bag.iterate_messages()) for bag in bags)))) == 1
    assert bags[1].provenance['original_source'] == 'trace.txt'
    # The vehicle that the command names, beside that of the bag
    assert lta('import', once, '--out', tmp_path / 'own', '--vehicle', 'beavis')[0] == 0
    own = read_bag(tmp_path / 'own' / 'bag').provenance
    assert own['vehicle'] == 'beavis'
    assert lta('import', tmp_path / 'own', '--vehicle', 'gtmab', '--out', tmp_path / 'two')[0] == 0
    both = read_bag(tmp_path / 'two' / 'bag').provenance
    assert (both['vehicle'], both['original_vehicle']) == ('gtmab', 'beavis')


def test_ctrl_c_leaves_nothing(lta, tmp_path, monkeypatch):
    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr('lta_data.importers.converter.TopicConverter.convert', interrupted)
    (tmp_path / 'trace.txt').write_text(TRACE)
    words = ['import', tmp_path / 'trace.txt', '--mapping', 'tum', '--out', tmp_path / 'out']
    assert lta(*words)[0] == app.STOPPED
    assert [path.name for path in tmp_path.iterdir()] == ['trace.txt']


PAGE = (Path(__file__).resolve().parents[4] / 'docs' / 'import.md').read_text(encoding='utf-8')


@pytest.mark.parametrize('block', re.findall(r'```yaml\n(.*?)```', PAGE, re.DOTALL))
def test_mappings_on_the_page_for_people_are_mappings(block):
    mapping = validate_content(ImportMapping, parse_yaml(block, 'the page'), 'the page')
    for entry in mapping.topics:
        plan_entry(entry, mapping, 'lta1')


def test_the_page_for_people_names_all_that_there_is():
    parts = {name for shape in MESSAGE_SHAPES.values() for name in shape}
    for name in (*list_shipped_names('imports'), *LOG_FORMATS, *FIELD_AXES, *parts, *EXTRA):
        assert re.search(rf'\b{name}\b', PAGE), name
