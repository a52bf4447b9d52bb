"""What the pieces disagree about counts; where the noise is as taken, it is what was expected."""

from dataclasses import replace
from types import SimpleNamespace

from lta_discovery.fit import robust_variance
from lta_discovery.fit.evidence import build_shared_prior, FLOOR, per_flight_variance, PieceReducer
from lta_discovery.fit.joint_fit import JointFit, JointFitter
from lta_discovery.fit.robust_variance import sandwich_variance
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.replay.linearized_flight import unchanged_vehicle_point
import numpy as np
import pytest

Known = tuple[NominalVehicle, list[FreeParameter]]


@pytest.fixture(scope='module')
def begun(gtmab: Known, clean: FlightLinearizer) -> tuple[JointFitter, JointFit]:
    """A clean flight where its tolerances are most probable."""
    nominal, knobs = gtmab
    fitter = JointFitter(nominal, [clean], per_flight_variance(knobs), FLOOR)
    begin = unchanged_vehicle_point(nominal, knobs, clean.replay.cut)
    return fitter, fitter.fit(
        build_shared_prior(knobs), fitter.linearize_flights(begin.values, [begin]), FLOOR
    )


def test_noise_as_taken_leaves_the_variance_near_what_it_was(
    begun: tuple[JointFitter, JointFit],
) -> None:
    joint = begun[1]
    free = joint.prior.free
    ratio = sandwich_variance(joint)[free] / np.diag(joint.fitted.covariance)[free]
    assert 0.6 < np.median(ratio) < 1.6
    assert (sandwich_variance(joint)[~free] == 0.0).all()


def test_noise_larger_than_taken_is_seen_by_the_pieces(
    begun: tuple[JointFitter, JointFit],
) -> None:
    fitter, joint = begun
    (linear,) = joint.group.linears
    # The same flight, its noise taken to be half of what it is: columns and residual double.
    sure = replace(joint.group, pieces=(PieceReducer(replace(linear, grams=4.0 * linear.grams)),))
    told = fitter.fit_deviations(sure, joint.prior, joint.deviations)
    after, before = np.diag(told.fitted.covariance), np.diag(joint.prior.covariance)
    shown = joint.prior.free & (after < 0.1 * before)  # by the flight, not beforehand
    assert (
        np.max(sandwich_variance(told)[shown] / after[shown]) > 2.0
    )  # of 4 where no force hides it


def test_the_pull_of_a_piece_is_corrected_for_its_leverage(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """
    One knob has a variance of 0.04, pieces of information 1, 5 and 24, and a prior precision of 2.

    It was fitted 0.1 above the point, so the scores are 0.5 - 0.1, -1 - 0.5 and 2 - 2.4. The
    leverages are 0.04 times the informations: 0.04, 0.2 and 0.96, limited to 0.9.
    """
    products = np.zeros((3, 2, 2))
    products[:, 0, 0], products[:, 0, 1] = (1.0, 5.0, 24.0), (0.5, -1.0, 2.0)
    monkeypatch.setattr(robust_variance, 'reduce_each_piece', lambda linear, deviations: products)
    fitted = SimpleNamespace(covariance=np.array([[0.04]]), mean=np.array([0.3]))
    linear = SimpleNamespace(point=SimpleNamespace(values=np.array([0.2])))
    joint = SimpleNamespace(
        fitted=fitted,
        prior=SimpleNamespace(free=np.array([True]), covariance=np.array([[0.5]])),
        members=[SimpleNamespace(linear=linear, fitted=fitted)],
        deviations=None,
        group=SimpleNamespace(variance=np.zeros(1)),
    )
    pulls = 0.04 * np.array([0.4, -1.5, -0.4]) / np.array([0.96, 0.8, 0.1])
    np.testing.assert_allclose(sandwich_variance(joint), [np.sum(pulls**2) + 0.04**2 * 2.0])
    # If each flight also has its own value of the knob, of precision 1 / 0.25 = 4, that value
    # takes up 30 / (30 + 4) of a change of the shared one; scores shrink by the rest, and
    # informations by its square. The own prior is strained by the share that is taken up.
    joint.group.variance = np.array([0.25])
    through = 1.0 - 30.0 / 34.0
    scores = np.array([0.4, -1.5, -0.4]) * through
    drawn = 0.04 * np.array([1.0, 5.0, 24.0]) * through**2
    expected = np.sum((0.04 * scores / (1.0 - drawn)) ** 2)
    expected += 0.04**2 * (2.0 + (30.0 / 34.0) ** 2 * 4.0)
    np.testing.assert_allclose(sandwich_variance(joint), [expected])
