"""A study says what is missing, by how much, and what it is worth on a flight it has not seen."""

from lta_config.errors import BadInput
from lta_discovery.calibration.first_step import calibrate_first
from lta_discovery.flights.measured_flight import resample_flight
from lta_discovery.forecast.held_out import count_learning_pieces
from lta_discovery.study import DiscoveryStudy, study_flights
from lta_model.vehicle import load_vehicle
import numpy as np
import pytest

from .hidden_cases import CASES, off_by_tolerance
from .hidden_flight import flown

ROLES = ('train', 'confirm', 'holdout')
LENGTH = 44.0  # s
TRUTH = 0.03  # N s/m


# Half a minute; test_discover.py finds the same by the command, and reads it from its results.
LONG = pytest.mark.long


@pytest.fixture(scope='module')
def studied() -> DiscoveryStudy:
    """A vehicle within its tolerances, but for a linear drag that its file does not have."""
    changes = {**off_by_tolerance(5), **CASES['linear_drag.surge']}
    flights = [
        (f'flight {k}', role, resample_flight(flown(changes, 500 + k, LENGTH)))
        for k, role in enumerate(ROLES)
    ]
    return study_flights(load_vehicle('gtmab'), flights, seed=1)


@LONG
def test_the_hidden_effect_is_named_with_an_interval_about_the_truth(
    studied: DiscoveryStudy,
) -> None:
    found = studied.finding
    assert found.verdict == 'named'
    assert [effect.name for effect in found.effects] == ['linear_drag']
    (effect,) = found.effects
    assert effect.knobs == ('linear_drag.surge',)
    assert effect.confusable_with == ()
    assert effect.log_evidence > 50.0
    (value,) = effect.parameters
    assert (value.name, value.unit, value.before) == ('surge', 'N s/m', 0.0)
    low, high = value.ci95
    assert low - 0.001 < TRUTH < high + 0.001
    assert high - low < 0.3 * TRUTH
    assert studied.learned.parameter_value('linear_drag', 'surge') == value.value
    assert studied.learned.mass == studied.nominal.mass


@LONG
def test_the_ladder_ends_with_a_round_in_which_nothing_is_accepted(
    studied: DiscoveryStudy,
) -> None:
    ladder = studied.finding.ladder
    assert [sum(rung.accepted for rung in rungs) for rungs in ladder] == [1, 0, 0]
    assert ladder[0][0].knob == 'linear_drag.surge'
    # What the removal costs is what both flights won, less what they share of the tolerances.
    won = ladder[0][0].train + ladder[0][0].confirm
    assert studied.finding.effects[0].log_evidence == pytest.approx(won, rel=0.25)


@LONG
def test_the_gap_of_the_held_out_flight_shrinks_and_coast_is_far_off(
    studied: DiscoveryStudy,
) -> None:
    found = studied.finding
    gaps = {(gap.channel, gap.horizon_s): gap for gap in found.gaps}
    assert found.held_out
    assert {horizon for _, horizon in gaps} == {1.0, 2.0, 3.0, 5.0}
    far = gaps['position', 5.0]
    assert far.after < 0.6 * far.tuned < 0.6 * far.before < 0.1 * far.coast
    assert far.shrink == pytest.approx(1.0 - far.after / far.before)
    assert far.shrink_ci95[0] < far.shrink < far.shrink_ci95[1]
    (shown,) = studied.comparisons
    flight = shown.study_flight.flight
    assert 1 < far.pieces <= len(flight.replay.first) - count_learning_pieces(flight)
    sides = [gaps[axis, 5.0].after for axis in 'xyz']
    assert far.after == pytest.approx(float(np.linalg.norm(sides)))


def test_a_flight_too_short_for_two_pieces_is_refused() -> None:
    short = resample_flight(flown({}, 7, 3.6))  # of which 2 s are warm-up
    with pytest.raises(BadInput, match='Record more or longer flights'):
        study_flights(load_vehicle('gtmab'), [('a', 'train', short), ('b', 'confirm', short)])


def test_lifts_that_differ_by_flight_call_for_no_other_file() -> None:
    """The file is right; the ballast differs between flights, by up to 12 mN."""
    vehicle = load_vehicle('gtmab')
    flights = []
    for k, (role, lift) in enumerate((('train', 0.0), ('train', -0.012), ('confirm', 0.0))):
        ballast = {'vehicle.effects.net_lift.force': {'value': lift, 'unit': 'N'}}
        flights.append((f'flight {k}', role, resample_flight(flown(ballast, 520 + k, 30.0))))
    first = calibrate_first(vehicle, 'gtmab', flights, lambda _what, _part: None)
    assert first.calibration is None
    low, high = (one.value for one in first.lifts)
    assert high - low == pytest.approx(0.012, abs=0.001)
    fixed, free = (
        study_flights(vehicle, flights, 1, has_own_lifts=own).finding for own in (False, True)
    )
    # No calibration can mend what the next flight does not have
    assert [text.split(':')[0] for text in fixed.offsets] == ['net lift of flight 1']
    assert free.offsets == ()
    assert free.verdict == 'none'
    assert free.unexplained == ()
