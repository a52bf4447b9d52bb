# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A flight in this process: its figures are those of its bag, and its changes are kept."""

import json

from lta_bag import provenance
from lta_bag.reader import read_bag
from lta_config.parameter_override import parse_assignment
from lta_config.topics import load_topic_table, robot_topic
from lta_data.bag import open_flight
from lta_flight import simulate as simulation
from lta_flight.flight_spec import load_spec
from lta_flight.report.results import compute_results
from lta_flight.report.view import FlightView
from lta_flight.simulate import simulate_once
import pytest
import yaml

TABLE = load_topic_table()


@pytest.fixture(autouse=True)
def _unbuilt(monkeypatch):
    """Run without a built workspace as well, whose version would not be found."""
    monkeypatch.setattr(provenance, 'version', lambda _: '0')


class Silent:
    def show_position(self, time, distance, pace):
        pass

    def show_message(self, sentence):
        pass

    def wait_for(self, what):
        pass


def simulated(folder, *changes, **options):
    spec = load_spec('gtmab', 'lamp_room', 'bag', 'gtmab')
    spec = spec.with_values(dict(map(parse_assignment, changes)))
    return simulate_once(spec, 3, folder, Silent(), **options)


def test_the_figures_without_a_bag_are_those_of_the_bag(tmp_path):
    """To the last bit but for the clock: a bag's times are differences of large whole numbers."""
    change = 'scenario.goal.radius=4 m'
    flight, figures = simulated(tmp_path / 'a', change)
    assert flight.outcome == 'reached'
    of_bag = compute_results(FlightView(open_flight(flight.bag))).to_dict()
    own = figures.to_dict()
    # No sun warms the gas in this room
    for results in (own, of_bag):
        assert (results.pop('gas_warmth'), results.pop('gas_lift')) == (None, None)
    assert own == pytest.approx(of_bag, rel=1e-12, nan_ok=False)
    assert None not in of_bag.values()
    _, bare = simulated(tmp_path / 'b', change, record=False)
    assert bare == figures
    assert not (tmp_path / 'b').exists()


def test_the_bag_has_every_message_that_the_rhythm_makes_due(tmp_path):
    flight, _ = simulated(tmp_path / 'out', 'scenario.goal.time_limit=2.05 s')
    bag = read_bag(flight.bag)
    assert bag.is_complete
    end = max(when for _, when, _ in bag.iterate_messages(['/lta1/imu']))
    assert end == TABLE.start_ns + 2_110_000_000  # one step after the light block
    repeatable = {
        robot_topic('lta1', name): name for name, topic in TABLE.topics.items() if topic.repeatable
    }
    assert set(bag.topics) == set(repeatable)
    for full, name in repeatable.items():
        once = 2 if name == '/tf_static' else 1  # by the description and by the simulator
        due = TABLE.count_due(name, end) if TABLE[name].period_ns else once
        assert bag.topics[full].count == due, name


def test_what_was_changed_is_kept_and_told(tmp_path):
    changes = ('vehicle.trim.heaviness=4 g', 'gains.heading_kp=0.5', 'mission.altitude=0.7')
    flight, _ = simulated(tmp_path / 'out', *changes, 'scenario.goal.time_limit=0.1 s')
    kept = {path.name: yaml.safe_load(path.read_text()) for path in flight.folder.glob('*.yaml')}
    assert kept['vehicle.yaml']['trim']['heaviness']['value'] == 4.0
    told = read_bag(flight.bag).provenance
    assert yaml.safe_load(told['vehicle_file']) == kept['vehicle.yaml']
    assert 'heading_kp: 0.5' in told['gains_file']
    assert 'mission.altitude=0.7' in told['set']


def test_a_model_that_is_compiled_first_is_told_where_no_bar_shows(call, monkeypatch):
    few = ('--no-bag', '--json', '--set', 'scenario.goal.time_limit=0.1 s')
    monkeypatch.setattr(simulation, 'is_compiled', lambda: False)
    _, said = call('simulate', *few)
    assert said.err.splitlines()[0] == f'{simulation.COMPILING} ...'
    assert json.loads(said.out)['outcome'] == 'timeout'
    monkeypatch.setattr(simulation, 'is_compiled', lambda: True)
    assert simulation.COMPILING not in call('simulate', *few)[1].err
