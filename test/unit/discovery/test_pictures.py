"""`lta discover --pictures`: of the page of a study, and refused where there is no page."""

from types import SimpleNamespace

from lta_cli.verbs import discover as verb
import pytest


@pytest.fixture(autouse=True)
def _a_browser(monkeypatch):
    monkeypatch.setattr('lta_cli.options.common_options.find_chromium', lambda: 'chromium')


def test_the_pictures_of_the_page_are_taken_if_asked_for(tmp_path, monkeypatch, call):
    taken, page = [], tmp_path / 'out' / 'report.html'
    found = SimpleNamespace(page=page, data={})
    monkeypatch.setattr(verb, 'discover_effects', lambda *_: found)
    monkeypatch.setattr(verb, 'write_pictures', lambda *given: taken.append(given))
    words = ('--vehicle', 'gtmab', '--train', 'a', '--json', '--out', tmp_path / 'out')
    status, said = call('discover', *words, '--pictures', tmp_path / 'p')
    assert status == 0, said.err
    assert taken == [(page, tmp_path / 'p')]


def test_a_plan_without_flights_has_no_page(tmp_path, call):
    words = ('--vehicle', 'gtmab', '--between', 'linear_drag.surge', 'quadratic_drag.surge')
    status, said = call('discover', *words, '--pictures', tmp_path / 'p')
    assert status == 2
    assert said.err == '--between writes no HTML report; remove --pictures.\n'
