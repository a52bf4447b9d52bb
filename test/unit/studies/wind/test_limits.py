# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The wind limits of platforms: what sets them, over which ground, and the command."""

import json

from lta_cli.app import build_app
from lta_config.errors import BadInput
from lta_model.vehicle import load_vehicle
from lta_studies.wind import limits
from lta_studies.wind.limits import measure_limits, to_json, WindRequest
import pytest
from typer.testing import CliRunner


@pytest.fixture(autouse=True)
def few_draws(monkeypatch):
    monkeypatch.setattr(limits, 'LIMIT_DRAWS', 3)


def measured(name, **changes):
    request = WindRequest(**{'roughness': (0.1, 0.3)} | changes)
    return measure_limits(request, name, load_vehicle(name))


def test_a_limit_is_the_lowest_of_three_and_over_ground_that_by_its_share():
    found = measured('gtmab')
    assert found.static == found.rise == min(found.thrust, found.tumble, found.rise)
    assert [over.roughness for over in found.over] == [0.1, 0.3]
    assert found.over[1].static == pytest.approx(found.static / found.over[1].share)
    assert found.interval[0] < found.static < found.interval[1]


def test_a_hull_of_2_7_m_flies_higher_and_one_that_is_none_does_not_tumble():
    assert measured('skye').height == pytest.approx(1.35 + 0.1, abs=0.1)
    printed = json.dumps(to_json([measured('multirotor')], WindRequest()), allow_nan=False)
    assert json.loads(printed)['vehicles'][0]['tumble'] is None


def test_ground_that_leaves_no_wind_is_refused():
    with pytest.raises(BadInput, match='not below the height of the given wind, --reference 3 m'):
        measured('gtmab', roughness=(5.0,), reference=3.0)
    with pytest.raises(BadInput, match=r'profile has no wind at 0\.5 m, where gtmab flies'):
        measured('gtmab', roughness=(1.0,))


def test_the_command_prints_a_table_json_and_a_page(tmp_path):
    call = ['wind', 'gtmab', 'skye', 'multirotor', '--out', str(tmp_path)]
    told = CliRunner().invoke(build_app(), call)
    assert told.exit_code == 0, told.output
    for text in ('1.84', '2.32', '0.76', '3.7', '51.09'):
        assert text in told.stdout
    content = json.loads((tmp_path / 'wind.json').read_text())
    assert [v['name'] for v in content['vehicles']] == ['gtmab', 'skye', 'multirotor']
    assert content['units']['static'] == 'm/s'
    page = (tmp_path / 'report.html').read_text()
    assert 'Flyable wind against the roughness' in page
    assert 'roughness 0.3 m' in page
    assert '$' not in page.split('<main ')[1].split('</main>')[0].split('<script')[0]
