# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The flyable wind: bisection over made-up flights, the wind as it is set, the command."""

from io import StringIO
import json
import math

from lta_cli.app import build_app
from lta_config.errors import BadInput
from lta_flight.flight_spec import load_spec
from lta_model.scenario import Scenario
from lta_report.report_page import render_report
from lta_report.request import StudyRun
from lta_report.study import StudyOptions
from lta_studies.wind import flyable_wind, limits
from lta_studies.wind.flyable_wind import (
    find_flyable_wind,
    FlyableWind,
    GroundWind,
    makes_headway,
    set_wind,
)
from lta_studies.wind.limits import measure_limits, to_json, WindStudyRequest
from lta_studies.wind.report import build_report
import pytest
from rich.console import Console
from typer.testing import CliRunner


@pytest.fixture(scope='module')
def flight():
    return load_spec('gtmab', 'windy_field', 'bag', 'gtmab')


def asked(**changes):
    given = {
        'vehicles': ('gtmab',), 'roughness': (0.1, 0.3), 'height': 0.5, 'reference': 10.0,
        'scenario': 'windy_field', 'seeds': 2, 'quick': True, 'fly': True,
    }  # fmt: skip
    return WindStudyRequest(**given | changes)


def test_the_wind_blows_from_the_lamp_to_the_start(flight):
    even = Scenario.model_validate(
        set_wind(flight, 2.0, GroundWind(None)).contents['scenario']
    ).air
    assert even.wind.vector == pytest.approx((-2.0, 0.0, 0.0), abs=1e-12)
    assert even.profile is None
    rough = set_wind(flight, 2.0, GroundWind(0.1, 5.0))
    over = Scenario.model_validate(rough.contents['scenario']).air
    assert over.wind.vector == pytest.approx((0.0, 0.0, 0.0), abs=1e-12)
    assert (over.profile.wind.si, over.profile.height.si, over.profile.roughness.si) == (2, 5, 0.1)
    assert abs(over.profile.towards.si) == pytest.approx(math.pi)


def test_on_a_route_it_blows_from_the_first_lamp():
    made_of = load_spec('gtmab', 'warehouse', 'homing', 'gtmab')  # from (-9, -2) to (-3, -2)
    air = Scenario.model_validate(
        set_wind(made_of, 2.0, GroundWind(None)).contents['scenario']
    ).air
    assert air.wind.vector == pytest.approx((-2.0, 0.0, 0.0), abs=1e-12)


def made_up(monkeypatch, limit_of):
    """Fly nothing: a wind is flyable below a limit that depends on airspeed and seed."""
    flown = []

    def flies(made_of, seed):
        wind = math.hypot(*made_of.contents['scenario']['air']['wind']['value'][:2])
        flown.append(wind)
        return wind <= limit_of(made_of.read_value('mission.speed'), seed)

    monkeypatch.setattr(flyable_wind, 'makes_headway', flies)
    return flown


def test_bisection_finds_the_limit_of_the_worst_seed_and_the_best_airspeed(flight, monkeypatch):
    tops = {0.5: 0.31, 1.0: 0.74, 1.5: 0.58}
    made_up(monkeypatch, lambda speed, seed: tops[speed] + 0.01 * seed)
    shares: list[float] = []
    best = find_flyable_wind(
        flight, GroundWind(None), 2.0, (0.5, 1.0, 1.5), (3, 1, 2), 6, shares.append
    )
    assert shares == [0.0, 1.0 / 3.0, 2.0 / 3.0]
    assert best.airspeed == 1.0
    assert best.wind <= 0.75 < best.wind + best.fine
    assert best.fine <= 2.0 / 64


def test_a_drone_that_makes_no_way_in_calm_has_no_limit(flight, monkeypatch):
    flown = made_up(monkeypatch, lambda speed, seed: -1.0)
    found = find_flyable_wind(flight, GroundWind(None), 2.0, (0.5, 1.0), (1, 2), 6)
    assert found == FlyableWind(0.0, 0.5, 2.0)
    assert flown == [0.0, 0.0]  # one flight for each airspeed, no more


def test_a_wind_beyond_what_is_asked_is_said_as_that(flight, monkeypatch):
    made_up(monkeypatch, lambda speed, seed: 99.0)
    found = find_flyable_wind(flight, GroundWind(None), 2.0, (0.5,), (1,), 6)
    assert found.wind + found.fine == 2.0


def test_flights_that_make_way_and_that_do_not(flight):
    assert makes_headway(set_wind(flight, 0.1, GroundWind(None)), 1)
    assert not makes_headway(set_wind(flight, 1.5, GroundWind(None)), 1)


@pytest.mark.long
def test_limits_of_a_platform_flown_and_not(monkeypatch):
    made_up(monkeypatch, lambda speed, seed: 0.4)
    one = measure_limits(asked(), 'gtmab')
    assert one.flown.wind == pytest.approx(0.4, abs=one.flown.fine)
    assert [over.roughness for over in one.over] == [0.1, 0.3]
    assert one.over[1].static == pytest.approx(one.static / one.over[1].share)
    # Every shipped platform has a law by now; one of people's own may have none.
    monkeypatch.setattr('lta_studies.wind.limits._find_gains_name', lambda vehicle: None)
    other = measure_limits(asked(vehicles=('skye',)), 'skye')
    assert other.flown is None
    assert other.height == pytest.approx(1.35 + 0.1, abs=0.1)  # a hull of 2.7 m flies higher
    printed = json.dumps(to_json([one, other], asked()), allow_nan=False)
    assert json.loads(printed)['vehicles'][1]['tumble'] is None
    made = render_report(build_report([one, other], asked()))
    assert f'In uniform wind gtmab makes headway up to {one.flown.wind:.2f} m/s.' in made
    flown = f'{one.flown.wind:.2f} (+{one.flown.fine:.2f})'
    assert f'<td>{one.static:.2f}</td><td>{flown}</td>' in made
    assert '<td>1.50</td>' in made  # where the larger hull flies
    assert 'wind at 10 m, roughness 0.3 m' in made


def test_a_stopped_study_reports_the_finished_platforms(tmp_path, monkeypatch):
    measured = measure_limits(asked(fly=False), 'gtmab')

    def measure(request, name):
        if name == 'skye':
            raise KeyboardInterrupt
        return measured

    monkeypatch.setattr(limits, 'measure_limits', measure)

    def run_in(name):
        console = Console(file=StringIO())
        return StudyRun(console, tmp_path / name, options=StudyOptions(1))

    both = asked(vehicles=('gtmab', 'skye'), fly=False)
    found = limits.find_limits(both, run_in('both'))
    assert found == [measured]
    report = build_report(found, both)
    assert report.status == 130
    assert report.closing[-1] == 'Stopped after 1 of 2 platforms.'
    assert report.introduction.endswith(' Stopped after 1 of 2 platforms.')
    assert build_report(found, asked(fly=False)).status == 0
    with pytest.raises(KeyboardInterrupt):
        limits.find_limits(asked(vehicles=('skye',), fly=False), run_in('none'))


def test_ground_that_leaves_no_wind_is_refused_before_any_work(tmp_path):
    def find(request):
        limits.find_limits(request, StudyRun(Console(), tmp_path / 'out'))

    with pytest.raises(BadInput, match='not below the height of the given wind, --reference 3 m'):
        find(asked(roughness=(5.0,), reference=3.0, fly=False))
    with pytest.raises(BadInput, match=r'profile has no wind at 0\.5 m, where gtmab flies'):
        find(asked(roughness=(1.0,), fly=False))
    assert not (tmp_path / 'out').exists()


def test_the_command_prints_a_table_json_and_a_page(tmp_path):
    call = ['wind', 'gtmab', 'skye', 'multirotor', '--no-fly', '--quick', '--out', str(tmp_path)]
    told = CliRunner().invoke(build_app(), call)
    assert told.exit_code == 0, told.output
    for text in ('1.84', '2.32', '0.76', '3.7', '51.09'):
        assert text in told.stdout
    content = json.loads((tmp_path / 'wind.json').read_text())
    assert [v['name'] for v in content['vehicles']] == ['gtmab', 'skye', 'multirotor']
    page = (tmp_path / 'report.html').read_text()
    assert 'Flyable wind against the roughness' in page
    assert '$' not in page.split('<main ')[1].split('</main>')[0].split('<script')[0]
    (tmp_path / 'wind.json').unlink()
    CliRunner().invoke(build_app(), call)  # what is stored is reported again
    assert json.loads((tmp_path / 'wind.json').read_text()) == content
    call[-1] = str(tmp_path / 'json')
    call[1:4] = ['multirotor']
    printed = CliRunner().invoke(build_app(), [*call, '--json'])
    assert json.loads(printed.stdout)['units']['static'] == 'm/s'
