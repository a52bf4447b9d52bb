"""A vehicle file that is far off is fitted from the beginnings of the pieces on."""

from types import SimpleNamespace

from lta_config.errors import BadInput
from lta_discovery.fit.evidence import build_shared_prior, per_flight_variance, Prior, wrench_floor
from lta_discovery.fit.initial_guess import guess_start, shorten_pieces
from lta_discovery.fit.joint_fit import JointFitter
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.replay.linearized_flight import LinearizationPoint, unchanged_vehicle_point
import numpy as np
import pytest

from ..hidden_flight import flown, prepared  # noqa: TID252 - `test` is Python's own

Start = tuple[JointFitter, Prior, list[LinearizationPoint]]

LOW = {'vehicle.effects.cg_height.z': {'value': 0.06, 'unit': 'm'}}  # 20 of its tolerances


def test_only_the_beginning_of_each_piece_of_a_shortened_flight_counts(
    clean: FlightLinearizer,
) -> None:
    short = shorten_pieces(clean, 0.8)
    assert short.replay.cut.inside[0, :20].all()
    assert not short.replay.cut.inside[:, 20:].any()
    assert clean.replay.cut.inside[0].all()
    assert short.replay.flight is clean.replay.flight


@pytest.fixture
def start(gtmab: tuple[NominalVehicle, list[FreeParameter]], clean: FlightLinearizer) -> Start:
    """What `guess_start` takes: a flight to fit, a prior, and the point of the vehicle file."""
    nominal, knobs = gtmab
    fitter = JointFitter(nominal, [clean], per_flight_variance(knobs), wrench_floor(nominal))
    return (
        fitter,
        build_shared_prior(knobs),
        [unchanged_vehicle_point(nominal, knobs, clean.replay.cut)],
    )


def test_a_stage_that_ends_lost_is_no_place_to_go_on_from(
    start: Start, monkeypatch: pytest.MonkeyPatch
) -> None:
    fitter, prior, points = start
    lost = SimpleNamespace(deviations=np.where(np.arange(6) == 4, 1000.0, 1.0) * fitter.floor)
    stages: list[JointFitter] = []
    monkeypatch.setattr(JointFitter, 'fit', lambda self, *_, **__: stages.append(self) or lost)
    at, then, deviations = guess_start(fitter, prior, points[0].values, points)
    assert len(stages) == 1
    assert (then, at is points[0].values) == (points, True)
    np.testing.assert_array_equal(deviations, fitter.floor)


def test_each_stage_starts_from_the_result_of_the_stage_before(
    start: Start, monkeypatch: pytest.MonkeyPatch
) -> None:
    """
    The stages fit the first 0.8 s and 2.4 s of each piece, which are 20 and 60 points at 25 Hz.

    The second starts with the deviations that the first found, limited to 2.5 floors.
    """
    fitter, prior, points = start
    left = [np.array([299.0, 2.4, 2.6, 0.5, 1.0, 1.0]), np.full(6, 9.0)]
    seen, begun_with = [], []

    def about(self, at, there, prior=None):
        seen.append((at, there, self.flights[0].replay.cut.inside[0].sum()))
        return f'about {at}'

    def fitted(self, prior, group, deviations, rounds, rest, narrow):
        begun_with.append((group, deviations / self.floor, rounds, rest, narrow))
        return SimpleNamespace(deviations=left[len(begun_with) - 1] * self.floor)

    monkeypatch.setattr(JointFitter, 'linearize_flights', about)
    monkeypatch.setattr(JointFitter, 'fit', fitted)
    monkeypatch.setattr(
        JointFitter, 'propose_step', lambda *_: (f'at {len(seen)}', [f'point {len(seen)}'])
    )
    at, then, deviations = guess_start(fitter, prior, points[0].values, points)
    assert [each[2] for each in seen] == [20, 60]
    assert seen[1][:2] == ('at 1', ['point 1'])
    assert [each[0] for each in begun_with][1:] == ['about at 1']
    assert [each[2:] for each in begun_with] == [(6, 10.0, True)] * 2
    np.testing.assert_allclose(begun_with[0][1], 1.0)
    np.testing.assert_allclose(begun_with[1][1], [2.5, 2.4, 2.5, 0.5, 1.0, 1.0])
    assert (at, then) == ('at 2', ['point 2'])
    np.testing.assert_allclose(deviations, 2.5 * fitter.floor)


def test_a_stage_whose_vehicle_is_impossible_is_the_last(
    start: Start, monkeypatch: pytest.MonkeyPatch
) -> None:
    fitter, prior, points = start
    tried: list[JointFitter] = []

    def about(self, *_):
        tried.append(self)
        raise BadInput('no such vehicle can be')

    monkeypatch.setattr(JointFitter, 'linearize_flights', about)
    at, then, deviations = guess_start(fitter, prior, points[0].values, points)
    assert len(tried) == 1
    assert (then, at is points[0].values) == (points, True)
    np.testing.assert_array_equal(deviations, fitter.floor)


@pytest.mark.long
def test_a_centre_of_gravity_far_too_low_does_not_run_away(
    gtmab: tuple[NominalVehicle, list[FreeParameter]],
) -> None:
    nominal, knobs = gtmab
    flight, floor, prior = (
        prepared(flown(LOW, 40, 26.0), knobs),
        wrench_floor(nominal),
        build_shared_prior(knobs),
    )
    fitter = JointFitter(nominal, [flight], per_flight_variance(knobs), floor)
    points = [unchanged_vehicle_point(nominal, knobs, flight.replay.cut)]
    at, then, deviations = guess_start(fitter, prior, points[0].values, points)
    found = fitter.fit(prior, fitter.linearize_flights(at, then), deviations)
    # Its tolerance, stretched, explains it: nothing is left to a latent wrench.
    assert np.all(found.deviations < floor)
    assert found.rounds <= 2
    lost = fitter.fit(prior, fitter.linearize_flights(points[0].values, points), floor)
    assert lost.evidence < found.evidence + 1.0
    assert lost.rounds > found.rounds
