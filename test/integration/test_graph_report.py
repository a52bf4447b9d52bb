# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""`lta report`: the page from a bag, and its pictures."""

from ..unit.report_flight import write_flight  # noqa: TID252 - `test` is Python's own


def test_the_page_comes_again_from_the_bag(lta, call, tmp_path):
    bag = write_flight(tmp_path / 'run' / 'bag')
    result = lta.run('report', bag)
    assert (result.returncode, result.stderr) == (0, '')
    page = tmp_path / 'run' / 'report.html'
    assert result.stdout == f'Page {page}\n'
    assert 'reached it in 12.0 s' in page.read_text()
    assert call('report', bag / 'bag_0.mcap', '--out', tmp_path / 'x')[0] == 0
    assert (tmp_path / 'x' / 'report.html').stat().st_size > 1_000_000


def test_what_cannot_be_is_one_sentence_and_makes_nothing(call, tmp_path):
    bag = write_flight(tmp_path / 'bag', until=1.0)
    (tmp_path / 'mine').mkdir()
    (tmp_path / 'mine' / 'thesis.tex').write_text('mine')
    for words, sentence in (
        ((tmp_path / 'none', '--pictures', tmp_path / 'new'), 'does not exist'),
        ((bag, '--pictures', tmp_path / 'mine'), 'is not empty'),
        ((bag, '--out', bag / 'metadata.yaml' / 'x'), 'cannot be created'),
    ):
        status, said = call('report', *words)
        assert status == 2
        assert sentence in said.err
        assert said.err.count('\n') == 1
    assert sorted(path.name for path in tmp_path.iterdir()) == ['bag', 'mine']
