# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The trust checks, by few of the flights and corruptions of `make campaign trust`."""

from dataclasses import replace

from campaigns import ROOT, trust_corruptions, trust_flights
from lta_data.data_quality.duplicate_runs import find_duplicate_runs
from lta_data.data_quality.recording import Severity
from lta_data.data_quality.registry import CHECKS, run_checks
from lta_data.data_quality.roles import vector_name
import numpy as np
import pytest


@pytest.fixture(scope='module')
def clean():
    """Return a few clean simulated flights."""
    return [trust_flights.simulated(seed) for seed in (1, 5, 6, 32)]


def test_clean_simulated_flights_have_no_findings_and_each_check_is_pure(clean):
    for flight in clean:
        before = {name: channel.values.copy() for name, channel in flight.channels.items()}
        assert [f for f in run_checks(flight).findings if f.is_grave] == []
        for name, values in before.items():
            np.testing.assert_array_equal(flight.channels[name].values, values)


CASES = {
    'constant': 4, 'frozen': 4, 'clipped': 4, 'duplicate': 2, 'impossible': 6, 'filtered': 3,
    'unit': 6, 'axes': 6, 'clock': 5, 'stamps': 4, 'held': 4,
}  # fmt: skip


@pytest.mark.parametrize('kind', CASES)
def test_corruptions_of_simulated_flights_are_found(clean, kind):
    rng = np.random.default_rng(list(kind.encode()))
    done = missed = 0
    for attempt in range(200):
        wrong = trust_corruptions.CORRUPTIONS[kind](clean[attempt % len(clean)], rng)
        if wrong is None:
            continue
        names = {*wrong.names, *map(vector_name, wrong.names)}
        found = [f for f in run_checks(wrong.recording).findings if f.kind == kind]
        right = [f for f in found if {f.channel, vector_name(f.channel)} & names]
        missed += not any(f.from_s <= wrong.to_s and f.to_s >= wrong.from_s for f in right)
        done += 1
        if done == CASES[kind]:
            break
    assert done == CASES[kind]
    # Of so few, one in six may be missed; docs/trust.md has the shares of many
    assert 6 * missed <= done


def test_every_kind_of_check_is_scored():
    assert set(trust_corruptions.CORRUPTIONS) == set(CHECKS) == set(CASES)


def test_one_run_again_is_found_and_two_runs_are_not(clean):
    first, second = clean[:2]
    copy = trust_corruptions.twin(first, np.random.default_rng(4))
    found = find_duplicate_runs([('a', first), ('b', second), ('copy of a', copy.recording)])
    assert list(found) == ['copy of a']
    (twin,) = found['copy of a']
    assert twin.values['agreement'] > 0.9
    assert "'a'" in twin.evidence


def test_two_flights_of_one_plan_in_still_air_are_two(clean):
    seeds = [
        replace(clean[0], provenance={'data': 'simulated', 'seed': seed})
        for seed in ('1', '2', '2')
    ]
    found = find_duplicate_runs(list(zip('abc', seeds, strict=True)))
    assert {name: len(twin) for name, twin in found.items()} == {'c': 1}
    assert "'b'" in found['c'][0].evidence


def test_real_flights_are_clean_and_rgblimp_is_told_to_be_filtered():
    if not trust_flights.rgblimp_files():
        pytest.skip('needs ../shared/data (published flights of others)')
    for path in trust_flights.rgblimp_files()[::20]:
        found = run_checks(trust_flights.rgblimp(path)).findings
        assert {(f.kind, f.severity) for f in found} == {('filtered', Severity.WARNING)}
    for path in trust_flights.crazyflie_files()[:2]:
        assert run_checks(trust_flights.crazyflie(path)).findings == ()


def test_the_page_tells_of_every_kind():
    page = (ROOT / 'docs/trust.md').read_text(encoding='utf-8')
    rows = {line.split('|')[1].strip() for line in page.splitlines() if line.startswith('| ')}
    assert {*CHECKS, 'twin'} <= rows
