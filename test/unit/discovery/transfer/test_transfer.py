"""Names by forecasts: they carry over, values cover what is hidden, and nothing is nothing."""

from dataclasses import replace

from lta_discovery.finding import (
    ChannelErrors,
    IdentifiedGroup,
    LeftOutKind,
    LeftOutRegime,
    NamedEffect,
    StudyResult,
    TransferEvidence,
)
from lta_discovery.flights.measured_flight import PERIOD
from lta_discovery.flights.role_assignment import restrict_to_interval
from lta_discovery.forecast.forecast_fit import ForecastFitter
from lta_discovery.forecast.horizon_errors import HorizonErrors, HORIZONS
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.page.transfer_table import render_transfer
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.results.discovery_json import to_dict
from lta_discovery.results.terminal import format_forecast_evidence
from lta_discovery.transfer.bootstrap_intervals import (
    bootstrap_values,
    compute_confidence_intervals,
)
from lta_discovery.transfer.candidate_groups import (
    CandidateGroup,
    HULL,
    list_candidate_groups,
    list_knobs,
)
from lta_discovery.transfer.effect_confirmation import confirm_groups
from lta_discovery.transfer.effect_values import fit_effect_values
from lta_discovery.transfer.forward_selection import select_forward
from lta_discovery.transfer.online_lift import subtract_online_lift
from lta_discovery.transfer.overlapping_pieces import APART, cut_overlapping_pieces
import numpy as np
import pytest

Known = tuple[NominalVehicle, list[FreeParameter]]
OFF = 0.6  # of the drag that a model lacks
SIDES = {'first': [0], 'second': [1]}
NAMED = ('quadratic drag', 'added mass', 'cg offset', 'tracker misalignment')


def halves(flight: FlightLinearizer, knobs: list[FreeParameter]) -> list[FlightLinearizer]:
    """Return the two halves of a flight in pieces that are predicted."""
    out = []
    for begin, end in ((0.0, 0.5), (0.5, 1.0)):
        cut = replace(flight.replay.cut)
        half = FlightLinearizer(flight.replay.with_pieces(cut), knobs, flight.places)
        half.replay.flight = restrict_to_interval(flight.replay.flight, begin, end)
        found = cut_overlapping_pieces(half, knobs)
        assert found is not None
        out.append(found)
    return out


def some(knobs: list[FreeParameter]) -> list[CandidateGroup]:
    """Return a few candidates, so that the test is quick."""
    return [group for group in list_candidate_groups(knobs) if group.name in NAMED]


@pytest.fixture(scope='module')
def lacking(gtmab: Known, clean: FlightLinearizer) -> tuple[ForecastFitter, float]:
    """A model with too little drag on every axis, and by how much ahead."""
    wrong, known = gtmab
    off = OFF * wrong.parameter_value('quadratic_drag', 'surge')
    for axis in ('surge', 'sway', 'heave'):
        knob = next(one for one in known if one.name == f'quadratic_drag.{axis}')
        wrong = knob.apply_to(wrong, -OFF * wrong.parameter_value('quadratic_drag', axis))
    return ForecastFitter(wrong, halves(clean, known), 0.0006), off


def test_pieces_overlap_and_are_whole(gtmab: Known, clean: FlightLinearizer) -> None:
    found = cut_overlapping_pieces(clean, gtmab[1])
    assert found is not None
    assert np.diff(found.replay.cut.first)[0] == round(APART / PERIOD)
    last = found.replay.cut.first[-1] + round(HORIZONS[-1] / PERIOD)
    assert found.replay.flight.usable[last - 1]
    assert found.replay.cut.inside.all()


def test_every_direction_of_an_effect_has_one_name(gtmab: Known) -> None:
    _, known = gtmab
    found = {group.name: group for group in list_candidate_groups(known)}
    names = [known[k].name for k in found['added inertia'].knobs]
    assert names == ['added_inertia.roll', 'added_inertia.pitch', 'added_inertia.yaw']
    assert not any(known[k].per_flight for k in list_knobs(list(found.values())))
    assert HULL not in found  # this hull has its coefficients in other effects


def test_what_is_lacking_is_named_and_its_value_covered(
    lacking: tuple[ForecastFitter, float],
) -> None:
    sight, off = lacking
    found = select_forward(sight, [0, 1], SIDES, some(sight.knobs))
    assert found.names[0] == 'quadratic drag'
    kept = confirm_groups(sight, found, [[0], [1]])
    assert kept[0].name == 'quadratic drag'
    best = fit_effect_values(sight, kept[:1], SIDES, 1)
    surge = next(k for k, knob in enumerate(sight.knobs) if knob.name == 'quadratic_drag.surge')
    assert best.fitted.values[surge] == pytest.approx(off, rel=0.2)
    assert all(one.ratio < 0.8 for one in best.regimes)


def test_nothing_carries_over_where_nothing_is_missing(
    gtmab: Known, clean: FlightLinearizer
) -> None:
    nominal, known = gtmab
    sight = ForecastFitter(nominal, halves(clean, known), 0.0006)
    assert select_forward(sight, [0, 1], SIDES, some(known)).names == ()


def test_flights_that_say_the_same_leave_no_doubt(lacking: tuple[ForecastFitter, float]) -> None:
    """Drawn anew from one flight, over and over, values are those of that flight."""
    sight, off = lacking
    k = next(k for k, knob in enumerate(sight.knobs) if knob.name == 'quadratic_drag.surge')
    fitted = sight.fit([k], np.array([3.0 * off]), [0], rounds=2)
    ((low, high),) = compute_confidence_intervals(
        bootstrap_values(fitted, sight.knobs, [k], np.array([3.0 * off]), 1)
    )
    assert low == pytest.approx(fitted.values[k]) == high
    both = sight.fit([k], np.array([3.0 * off]), [0, 1], rounds=2)
    ((low, high),) = compute_confidence_intervals(
        bootstrap_values(both, sight.knobs, [k], np.array([3.0 * off]), 1)
    )
    assert low < both.values[k] < high


def test_a_lift_is_learned_from_what_is_over() -> None:
    """Errors that a constant lift makes vanish in the second piece, and stay in the first."""
    time = np.array([0.0, 10.0])
    column = np.zeros((2, len(HORIZONS), 6, 1))
    column[..., 2, 0] = np.square(HORIZONS)
    seen = HorizonErrors(0.01 * column[..., 0], column)
    left = subtract_online_lift(seen, time, lift=1.0)
    np.testing.assert_allclose(left[0], seen.errors[0])
    assert np.abs(left[1]).max() < 1e-3 * np.abs(seen.errors[1]).max()


CARRIED = TransferEvidence(
    (IdentifiedGroup('added inertia', 0.028),),
    (LeftOutRegime('slow', 5, 0.95), LeftOutRegime('fast', 4, 0.8)),
    ('hull lift',),
    72,
    ('wind gradient: rejected, as it makes forecasts of attitude 8 % worse',),
    (LeftOutKind('slower than 0.54 m/s', 0.83, 1.01),),
)
GAP = ChannelErrors(
    'position', 'm', 5.0, 0.28, 0.27, 0.23, 0.31, 0.014, 0.18, (0.15, 0.22), 105, 0.17
)


def told() -> StudyResult:
    """Return a finding by forecasts."""
    effect = NamedEffect('added_inertia', ('added_inertia.yaw',), (), 23.8)
    return StudyResult(
        'named+unexplained', (effect,), (), (), (GAP,), True, (), (), 1, {}, 'rgblimp',
        carried=CARRIED,
    )  # fmt: skip


def test_programs_and_people_are_told_what_names_rest_on() -> None:
    known = to_dict(told())
    assert known['carried']['regimes'][0] == {'name': 'slow', 'flights': 5, 'ratio': 0.95}
    assert known['carried']['interpolates'] == ['hull lift']
    assert known['carried']['rejected'] == list(CARRIED.rejected)
    assert known['carried']['kinds'] == [
        {'name': 'slower than 0.54 m/s', 'position': 0.83, 'attitude': 1.01}
    ]
    assert known['gap']['refitted'] == 0.17
    assert '2 of 2 flight regimes' in format_forecast_evidence(CARRIED)
    page = render_transfer(told())
    assert '2.8 %' in page
    assert '\N{MINUS SIGN}5 %' in page  # of the worst regime
    assert '<b>hull lift</b>' in page
    assert '8 % worse' in page
    assert 'slower than 0.54 m/s' in page
    assert 'with all 72 candidate parameters fitted' in page
    assert to_dict(replace(told(), carried=None))['carried'] is None
    assert render_transfer(replace(told(), carried=None)) == ''
