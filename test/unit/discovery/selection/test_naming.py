"""Hidden effects get their names from two flights, and clean flights get none."""

from dataclasses import replace

from lta_discovery.fit.evidence import build_prior, build_shared_prior
from lta_discovery.fit.joint_fit import fit_flight
from lta_discovery.forecast.held_out import compute_model_errors, FlightUnderModels
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.replay.linearized_flight import unchanged_vehicle_point
from lta_discovery.selection.candidate_acceptance import CandidateTrial
from lta_discovery.selection.effect_search import EffectSearch, EffectSearchResult
import pytest

from ..hidden_cases import CASES, Changes, off_by_tolerance  # noqa: TID252 - `test` is Python's own
from ..hidden_flight import flown, prepared  # noqa: TID252 - `test` is Python's own

Known = tuple[NominalVehicle, list[FreeParameter]]
LENGTH = 40.0  # s
HIDDEN = {'linear_drag.surge': 0.03, 'cg_offset.x': 0.006, 'command_delay.delay': 0.045}


def _named(known: Known, changes: Changes, seed: int) -> EffectSearchResult:
    nominal, knobs = known
    pair = (
        [prepared(flown(changes, seed, LENGTH), knobs)],
        [prepared(flown(changes, seed + 1, LENGTH), knobs)],
    )
    return EffectSearch(nominal, pair).run()


LONG = ('linear_drag.surge', 'command_delay.delay')  # test_study.py names the first as well


@pytest.mark.parametrize(
    'name', [pytest.param(name, marks=pytest.mark.long if name in LONG else ()) for name in HIDDEN]
)
def test_a_hidden_effect_is_named_and_nothing_else(gtmab: Known, name: str) -> None:
    expected, found = HIDDEN[name], _named(gtmab, CASES[name], 40)
    assert found.names == (name,)
    assert found.steps[0].tied == ()
    k = found.fits[0].group.linears[0].names.index(name)
    for one in found.fits:
        spread = one.fitted.covariance[k, k] ** 0.5
        assert abs(one.fitted.mean[k] - expected) < 4.0 * spread + 0.005 * expected


@pytest.mark.long
def test_an_effect_that_cannot_be_so_large_is_not_named(gtmab: Known) -> None:
    nominal, knobs = gtmab
    name = 'linear_drag.surge'
    small = [replace(one, high=0.1 * HIDDEN[name]) if one.name == name else one for one in knobs]
    assert name not in _named((nominal, small), CASES[name], 40).names


def test_a_vehicle_within_its_tolerances_names_nothing(gtmab: Known) -> None:
    found = _named(gtmab, off_by_tolerance(3), 60)
    assert found.names == ()
    assert all(not trial.is_accepted for step in found.steps for trial in step.trials)


@pytest.mark.long
def test_the_gap_goes_from_nominal_over_tuned_to_named(gtmab: Known) -> None:
    nominal, knobs = gtmab
    flight = prepared(flown(CASES['linear_drag.surge'], 70, LENGTH), knobs)
    start = unchanged_vehicle_point(nominal, knobs, flight.replay.cut)
    tuned, named = (
        fit_flight(flight, nominal, build_prior(knobs, names), start).linear.point
        for names in ((), ('linear_drag.surge',))
    )
    models = FlightUnderModels(start, tuned, named)
    far = compute_model_errors([flight], [models], 1, ('position',))[-1]
    assert far.horizon_s == 5.0
    assert far.before > 1.5 * far.tuned > 2.25 * far.after
    assert far.coast > 5.0 * far.before
    assert far.noise_floor == pytest.approx(1e-3 * 3**0.5, rel=0.1)


def test_one_flight_alone_names_nothing() -> None:
    assert CandidateTrial('a', 60.0, 30.0, 20.0, 1.0, 0.2).is_accepted
    assert not CandidateTrial('a', 60.0, -4.0, -6.0, 1.0, 0.2).is_accepted
    assert not CandidateTrial('a', 60.0, 30.0, 20.0, 7.0, 0.3).is_accepted  # two different values
    assert not CandidateTrial('a', 4.0, 4.0, 3.0, 0.0, 0.0).is_accepted


def test_a_candidate_that_loses_on_one_flight_what_it_wins_on_the_other_is_torn() -> None:
    assert CandidateTrial('a', 631.0, -6.0, -9.0, 8.0, 0.9).is_contradictory
    assert CandidateTrial('a', -6.0, 631.0, 2.0, 8.0, 0.9).is_contradictory
    assert not CandidateTrial('a', 631.0, -2.0, -9.0, 4.0, 0.9).is_contradictory  # nothing lost
    assert not CandidateTrial('a', 2.0, -6.0, -9.0, 4.0, 0.9).is_contradictory  # nothing won


def test_a_constant_with_two_values_is_torn_whatever_it_wins() -> None:
    """A damping that won 11 and 101 nats, with values 12 deviations apart, hid ballast."""
    assert CandidateTrial('a', 10.7, 101.2, 6.1, 12.2, 0.9).is_contradictory
    assert not CandidateTrial('a', 10.7, 101.2, 6.1, 12.2, 0.09).is_contradictory  # but alike


def test_only_a_candidate_that_both_flights_support_wins_on_both() -> None:
    assert CandidateTrial('a', 240.0, 227.0, 200.0, 1.0, 0.1).wins_on_both
    assert not CandidateTrial('a', 240.0, 4.0, 200.0, 1.0, 0.1).wins_on_both


@pytest.mark.long
def test_only_what_is_unlike_a_torn_candidate_gets_past_it(gtmab: Known) -> None:
    nominal, knobs = gtmab
    pair = tuple([prepared(flown({}, seed, 20.0), knobs)] for seed in (60, 61))
    naming = EffectSearch(nominal, (pair[0], pair[1]))
    bare = naming.run().bare
    torn, sound = (631.0, -6.0, -9.0, 8.0, 0.9), (240.0, 227.0, 200.0, 1.0, 0.1)
    for name, other, past in (
        ('linear_drag.surge', 'rotational_drag.yaw', True),
        ('linear_drag.surge', 'quadratic_drag.surge', False),
    ):
        trial, better = CandidateTrial(name, *sound), CandidateTrial(other, *torn)
        assert naming._is_admissible(trial, [better, trial], (), bare, ()) == past
        assert not naming._is_admissible(
            trial, [better._replace(replicated=9.0, apart=1.0), trial], (), bare, ()
        )
        agreed = better._replace(replicated=9.0, apart=1.0)  # beside what has failed already
        assert naming._is_admissible(trial, [agreed, trial], (), bare, ('cg_offset.x',)) == past
        assert naming._is_admissible(trial, [better, trial], (), bare, ('cg_offset.x',))
    prior = build_shared_prior(naming.knobs)
    left = naming._list_excluded_candidates(['linear_drag.surge'], prior, bare)
    assert {'linear_drag.surge', 'quadratic_drag.surge', 'rotational_drag.yaw'} <= left
    assert {'steady_wind.x', 'helium_leak.rate'} <= left
    assert not {'gyro_bias.z', 'net_lift.force'} & left
