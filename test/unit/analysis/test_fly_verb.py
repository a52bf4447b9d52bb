"""What `lta fly --json` prints."""

import json

from lta_analysis.flight import Flown
from lta_analysis.report.results import Results
from lta_analysis.verbs import fly as verb
import pytest


@pytest.mark.parametrize('page', [True, False])
def test_every_figure_has_its_unit(monkeypatch, tmp_path, capsys, page):
    flown = Flown(tmp_path, tmp_path / 'bag', 'reached', 'reached the lamp', 2.5)
    monkeypatch.setattr(verb, 'fly_once', lambda order, watcher: flown)
    monkeypatch.setattr(verb, 'write_page', lambda bag, out: Results(path_length=6.0))
    verb.fly(json=True, page=page)
    found = json.loads(capsys.readouterr().out)
    units = found.pop('units')
    assert units['pace'] == '1'
    numbers = found.keys() - {'outcome', 'bag', 'page', 'success'}
    assert units.keys() == numbers
    assert not page or (found['path_length'], units['path_length']) == (6.0, 'm')
