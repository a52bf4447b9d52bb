# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Every campaign starts, parses its arguments and makes its table; what is quick runs whole."""

import shlex

from campaigns import chaos, harness
from campaigns.harness import build_parser, Campaign, Case, list_campaigns, load_campaign
import pytest

CAMPAIGNS = list(list_campaigns())
QUICK = [name for name in CAMPAIGNS if load_campaign(name).smoke is not None]


@pytest.mark.parametrize('name', CAMPAIGNS)
def test_a_campaign_has_arguments_kinds_and_a_table_without_rows(name):
    campaign, options = load_campaign(name), build_parser(name).parse_args([])
    kinds = [*campaign.list_kinds(options), *campaign.hidden]
    assert len(kinds) == len(set(kinds)) > 0
    page = harness.ROOT / 'docs' / campaign.page
    if campaign.page:
        mark = f'<!-- written by make campaign {name} -->'
        assert page.read_text(encoding='utf-8').count(mark) == 2
    broken = {Case(kinds[0], 0): {'wrong': 'it hung'}}
    assert all(isinstance(line, str) for line in campaign.list_table(broken, options))


@pytest.mark.parametrize('name', CAMPAIGNS)
def test_help_says_what_it_is_and_changes_nothing(name, capsys):
    with pytest.raises(SystemExit) as end:
        harness.run_campaign(name, ['--help'])
    assert end.value.code == 0
    assert list_campaigns()[name] in capsys.readouterr().out


@pytest.mark.parametrize('name', QUICK)
def test_what_is_quick_runs(name, tmp_path, capsys, monkeypatch, request):
    if name == 'sphere':  # programs stand in for OpenFOAM
        request.getfixturevalue('fake')
        monkeypatch.setenv('XDG_CACHE_HOME', str(tmp_path / 'cache'))
    words = [*shlex.split(load_campaign(name).smoke), '--out', str(tmp_path)]
    assert harness.run_campaign(name, words) == 0, capsys.readouterr()
    (rows,) = tmp_path.glob('*.jsonl')
    said = capsys.readouterr().out
    assert f'Cases: {len(rows.read_text().splitlines())} of commit' in said


@pytest.fixture
def toy(monkeypatch):
    """Run a campaign of two kinds, of which odd numbers of one are wrong; return its cases."""
    tried = []

    def run(case, options):
        tried.append(case)
        return {'wrong': 'odd' if case.kind == 'b' and case.number % 2 else ''}

    def table(rows, options):
        yield f'{len(rows)} rows'

    module = type('Module', (), {'__doc__': 'Toy.', 'CAMPAIGN': None})
    module.CAMPAIGN = Campaign(lambda options: ['a', 'b'], run, table, each=3, page='page.md')
    monkeypatch.setattr(harness, 'load_campaign', lambda name: module.CAMPAIGN)
    monkeypatch.setitem(harness.sys.modules, 'campaigns.toy', module)
    return tried


def test_a_campaign_goes_on_where_it_was_and_tries_again_what_was_wrong(toy, tmp_path, capsys):
    words = ['--out', str(tmp_path)]
    assert harness.run_campaign('toy', [*words, '--each', '2']) == 1
    assert sorted(toy) == [('a', 0), ('a', 1), ('b', 0), ('b', 1)]
    assert '- b 1: odd\n' in capsys.readouterr().out
    toy.clear()
    assert harness.run_campaign('toy', words) == 1
    assert sorted(toy) == [('a', 2), ('b', 2)]
    toy.clear()
    harness.run_campaign('toy', [*words, '--again'])
    assert toy == [('b', 1)]


def test_a_whole_campaign_alone_writes_its_part_of_the_page(toy, tmp_path, monkeypatch):
    monkeypatch.setattr(harness, 'ROOT', tmp_path)
    mark = '<!-- written by make campaign toy -->'
    page = tmp_path / 'docs' / 'page.md'
    page.parent.mkdir()
    page.write_text(f'by hand\n\n{mark}\nold\n{mark}\nafter\n')
    words = ['--out', str(tmp_path / 'runs'), '--write']
    harness.run_campaign('toy', [*words, '--kinds', 'a'])
    assert '\nold\n' in page.read_text()
    harness.run_campaign('toy', words)
    text = page.read_text()
    assert text.startswith(f'by hand\n\n{mark}\n\n6 rows\n')
    assert text.endswith(f'\n- b 1: odd\n\n{mark}\nafter\n')


def test_an_unknown_kind_is_refused(toy, tmp_path, capsys):
    with pytest.raises(SystemExit):
        harness.run_campaign('toy', ['--out', str(tmp_path), '--kinds', 'c'])
    assert "no kind 'c'; known: a, b" in capsys.readouterr().err


def test_a_case_that_hangs_is_wrong_and_nothing_of_it_is_left(monkeypatch):
    monkeypatch.setattr(harness.sys, 'executable', '/bin/sleep')
    row = harness.try_alone('toy', Case('a', 0), (), 0.01)
    assert row['wrong'].startswith(('it hung', 'it broke'))


def test_a_case_is_repeated_only_where_the_machine_stood_still(monkeypatch):
    rows = [{'wrong': 'late', 'timing': True, 'late': 1.0}] * 2 + [{'wrong': ''}]
    monkeypatch.setattr(harness, 'try_alone', lambda *words: rows.pop(0))
    assert harness.try_patiently('toy', Case('a', 0), (), 1.0) == {'wrong': '', 'again': 2}
    rows[:] = [{'wrong': 'late', 'timing': True, 'late': 0.01}, {'wrong': ''}]
    assert harness.try_patiently('toy', Case('a', 0), (), 1.0)['again'] == 0


def test_the_faults_of_a_graph_are_counted_by_the_way_to_start_it():
    row = {'told': 0.5, 'said': 0.6, 'took': None, 'wrong': '', 'way': 'lockstep'}
    rows = {Case('killed', 0): row, Case('killed', 3): row | {'told': 0.7, 'wrong': 'x'}}
    assert list(chaos.list_table(rows, None))[2] == (
        '| SIGKILL | 2 | shuts down in order | 0.70 s | 0.60 s |  | 1 of 2 |  |  |'
    )
