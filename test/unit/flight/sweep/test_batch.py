# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A sweep flown as one batch goes on, keeps what failed, and draws its map like any other."""

from collections import Counter
import io

import lta_analysis
from lta_config.errors import BadInput
from lta_config.files import list_shipped_names
from lta_config.schema.sweep_file import load_sweep
from lta_flight.batch.batch_flight import build_flight
from lta_flight.batch.flight import RAN_AWAY
from lta_flight.batch.flight_loop import FIGURES
from lta_flight.batch.fly import fly_many
from lta_flight.sweep import batch_workers
from lta_flight.sweep.batch_workers import SweepRow
from lta_flight.sweep.pictures import find_map_parameters, plot_heat_map
from lta_flight.sweep.plan import SweepPlan
from lta_flight.sweep.report import build_report, format_headline
from lta_flight.sweep.run import sweep_once, SweepRequest
from lta_flight.sweep.statistics import group_by_parameter, reached_share
from pyarrow import parquet
import pytest
from rich.console import Console
import yaml

HEAVY, SIDE = 'vehicle.trim.heaviness', 'scenario.air.wind.1'
SHORT = {'scenario.goal.time_limit': '0.05 s'}
QUIET = Console(file=io.StringIO())


@pytest.fixture
def sweep(tmp_path, batches):
    """Return a function that writes a sweep file of short flights."""

    def write(**content):
        given = {
            'schema': 1, 'name': 'short', 'about': 'Short flights.', 'vehicle': 'gtmab',
            'scenario': 'lamp_room', 'strategy': 'bag', 'gains': 'gtmab', 'seeds': {'count': 2},
            'set': SHORT,
            'vary': {SIDE: ['0 m/s', '0.1 m/s', '0.2 m/s'], HEAVY: ['1 g', '2 g', '3 g']},
        }  # fmt: skip
        path = tmp_path / 'short.yaml'
        path.write_text(yaml.safe_dump(given | content))
        return str(path)

    return write


def run(file, folder, **options):
    return sweep_once(
        SweepRequest(file=file, out=folder, **{'device': 'cpu-batch', **options}), QUIET
    )


def test_it_is_flown_once_and_has_table_and_report(sweep, tmp_path):
    file, folder = sweep(), tmp_path / 'out'
    done = run(file, folder)
    assert (done.new_flights, len(done.rows)) == (18, 18)
    assert Counter(row.outcome for row in done.rows) == {'timeout': 18}
    table = parquet.read_table(done.table)
    assert table.column('path_length').null_count == 0
    assert table.column('altitude_estimate_error').null_count == 18
    assert table.schema.metadata[b'flown as'] == b'--device cpu-batch'
    report = build_report(done)
    assert [each.name for each in report.blocks[1].blocks] == ['heat', 'by-0', 'by-1']
    assert report.facts['flown as'] == '--device cpu-batch'
    assert 'Fly one like the first lost flight' in report.commands
    again = run(file, folder)
    assert again.new_flights == 0
    assert again.rows == done.rows


def test_what_cannot_be_built_is_kept_as_failed(sweep, tmp_path, monkeypatch):
    """Each value can be flown alone, so that the check before the first flight passes."""

    def picky(vehicle, scenario, *others):
        if vehicle.heaviness > 2.5e-3 and scenario.air.wind.vector[1] > 0.05:
            raise BadInput('It is too heavy; take less.')
        return build_flight(vehicle, scenario, *others)

    monkeypatch.setattr(batch_workers, 'build_flight', picky)
    file = sweep(vary={SIDE: ['0 m/s', '0.1 m/s'], HEAVY: ['1 g', '3 g']})
    done = run(file, tmp_path / 'out')
    assert Counter(row.outcome for row in done.rows) == {'timeout': 6, 'failed': 2}
    assert {row.sentence for row in done.rows if row.outcome == 'failed'} == {
        'It is too heavy; take less.'
    }
    title = format_headline(done.plan, done.rows)
    assert title.startswith(
        '0 of 8 flights reached their goal, and 2 could not be flown; the 95 %'
    )


def test_what_a_batch_does_not_support_is_refused_before_the_first_flight(sweep, tmp_path):
    """A batch once flew what it could of a sweep and reported only that."""
    scale = 'vehicle.effects.gyro_scale.z'
    values = [{'value': value, 'unit': '1', 'source': 'assumed'} for value in (1.0, 1.1)]
    file, out = sweep(vary={scale: values}), tmp_path / 'out'
    with pytest.raises(BadInput, match=r'does not support the effect gyro_scale, .* out\.$'):
        run(file, out)
    assert not out.exists()


@pytest.mark.parametrize('name', list_shipped_names('sweeps'))
def test_every_shipped_sweep_can_be_flown_as_a_batch(name):
    plan = SweepPlan(load_sweep(name))
    batch_workers.BatchWorkers(plan.base, 'cpu-batch').check(plan)


def test_a_flight_whose_numbers_ran_away_has_failed(sweep, tmp_path, monkeypatch):
    def wild(made, seeds, *others, **options):
        told = fly_many(made, seeds, *others, **options)
        told[0, FIGURES.index('outcome')] = RAN_AWAY
        return told

    monkeypatch.setattr(batch_workers, 'fly_many', wild)
    first, *others = run(sweep(), tmp_path / 'out').rows
    assert first.outcome == 'failed'
    assert first.sentence.startswith('The simulation of gtmab diverged 0.05 s after the start')
    assert {row.outcome for row in others} == {'timeout'}


def test_a_map_shows_shares_and_medians(sweep, tmp_path):
    done = run(sweep(), tmp_path / 'out')
    first, *others = done.rows
    reached = type(first)(
        first.index, first.seed, first.values, 'reached', '', 0.0, {'search_time': 7.0}
    )
    both = find_map_parameters(done.plan)
    assert both == (SIDE, HEAVY)
    share, times = plot_heat_map([reached, *others], both, done.plan.units).data
    assert share.z[0][0] == 50.0
    assert share.z[2][2] == 0.0
    assert times.z[0][0] == 7.0
    assert times.z[2][2] is None


def test_a_sweep_over_few_values_is_no_map(sweep):
    assert (
        find_map_parameters(SweepPlan(load_sweep(sweep(vary={HEAVY: ['1 g', '2 g', '3 g']}))))
        is None
    )


def test_options_that_exclude_each_other_are_refused(tmp_path):
    with pytest.raises(BadInput, match='--device cannot be combined with --workers or --schedu'):
        lta_analysis.sweep('heaviness', out=tmp_path / 'out', device='gpu', workers=2)
    assert not (tmp_path / 'out').exists()


def test_values_of_a_grid_are_not_cut_in_two():
    """Ten values against another parameter that decides: all must look alike."""
    rows = [
        SweepRow(k, 1, {'a': float(k // 100), 'b': float(k % 100)}, outcome, '')
        for k in range(1000)
        for outcome in (['timeout', 'reached'][k % 100 < 50],)
    ]
    found = group_by_parameter(rows, 'a')
    assert [group.place for group in found] == list(range(10))
    assert {reached_share(group.rows).value for group in found} == {0.5}
