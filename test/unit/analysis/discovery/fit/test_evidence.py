"""Evidence on small matrices is the evidence of the dense Gaussian."""

from dataclasses import replace

from lta_analysis.discovery.fit.evidence import (
    fitted,
    FLOOR,
    knot_precision,
    OWN,
    PIECE_PRESSURE,
    Pieces,
    Prior,
    STATE,
    tolerances,
)
from lta_analysis.discovery.model.knobs import Knob
from lta_analysis.discovery.model.nominal import Nominal
from lta_analysis.discovery.naming.scan import likeness, scan
from lta_analysis.discovery.replay.linear import AXES, KNOTS, Linear, origin, RANDOM
from lta_analysis.discovery.replay.linearise import Linearised
import numpy as np
import pytest
from scipy.stats import multivariate_normal

from ..hidden_flight import flown, prepared  # noqa: TID252 - `test` is Python's own

Known = tuple[Nominal, list[Knob]]
DEVIATIONS = 0.8 * FLOOR


@pytest.fixture(scope='module')
def linear(gtmab: Known, clean: Linearised) -> Linear:
    """The clean flight about the vehicle file."""
    return clean.at(origin(gtmab[0], gtmab[1], len(clean.replay.first)))


def test_the_evidence_is_that_of_the_dense_gaussian(gtmab: Known, clean: Linearised) -> None:
    nominal, knobs = gtmab
    point = origin(nominal, knobs, len(clean.replay.first))
    columns, left = (part[:1, ::15] for part in clean.columns(point))
    known = np.isfinite(left)
    table = np.where(known[..., None], columns, 0.0).reshape(-1, columns.shape[-1])[known.ravel()]
    y = left[known]
    full = np.column_stack([table, y])
    whole = Linear(
        (*(knob.name for knob in knobs), *('own' for _ in OWN)),
        (full.T @ full)[None],
        np.array([len(y)]),
        replace(point, random=point.random[:1]),
        left,
    )
    knots = np.linalg.inv(knot_precision())
    prior = np.zeros((RANDOM, RANDOM))
    prior[np.diag_indices(12)] = STATE**2
    for axis in range(AXES):
        at = slice(12 + axis * KNOTS, 12 + (axis + 1) * KNOTS)
        prior[at, at] = knots * DEVIATIONS[axis] ** 2
    prior[-1, -1] = PIECE_PRESSURE**2
    own = tolerances(knobs)
    shared, single = table[:, RANDOM:], table[:, :RANDOM]
    covariance = np.eye(len(y)) + single @ prior @ single.T + shared @ own.covariance @ shared.T
    expected = multivariate_normal.logpdf(y, np.zeros(len(y)), covariance, allow_singular=False)
    found = fitted(Pieces(whole).reduced(DEVIATIONS), point.values, own)
    assert found.log_evidence == pytest.approx(expected, abs=1e-4 * abs(expected))
    answer = own.covariance @ shared.T @ np.linalg.solve(covariance, y)
    np.testing.assert_allclose(found.mean, answer, rtol=1e-4, atol=1e-9)


def test_a_glance_is_the_difference_of_two_evidences(gtmab: Known, linear: Linear) -> None:
    knobs, reduced = gtmab[1], Pieces(linear).reduced(DEVIATIONS)
    at, without = linear.point.values, tolerances(gtmab[1])
    for seen in scan(reduced, at, without, knobs)[:8]:
        there = fitted(reduced, at, tolerances(knobs, (seen.name,)))
        k = linear.names.index(seen.name)
        gain = there.log_evidence - fitted(reduced, at, without).log_evidence
        assert seen.gain == pytest.approx(gain, abs=1e-3)
        assert seen.value == pytest.approx(there.mean[k], rel=1e-3)
        assert seen.deviation == pytest.approx(there.covariance[k, k] ** 0.5, rel=1e-3)


@pytest.mark.long
def test_linearised_at_the_truth_scores_are_those_of_noise(gtmab: Known) -> None:
    # Nuisances that may be anything, so that it does not matter which the truth has.
    nominal, knobs = gtmab
    known = tolerances(knobs)
    wide = Prior(known.mean, 100.0 * known.covariance)
    scores = []
    for seed in (21, 22, 23):
        flight = prepared(flown({}, seed, 45.0), knobs)
        about = flight.at(origin(nominal, knobs, len(flight.replay.first)))
        first = Pieces(about)
        change = fitted(first.reduced(0.2 * FLOOR), about.point.values, wide).mean
        random = first.solved(0.2 * FLOOR, change)
        # States and biases where they are most probable; the vehicle where the truth is.
        again = flight.at(replace(about.point, random=random))
        reduced = Pieces(again).reduced(0.2 * FLOOR)
        seen = scan(reduced, again.point.values, wide, knobs)
        free = {knob.name for knob in knobs if knob.tolerance == 0.0}
        scores += [one.score for one in seen if one.name in free]
    assert abs(np.mean(scores)) < 0.35
    assert 0.7 < np.std(scores) < 1.3
    assert np.abs(scores).max() < 4.0


def test_one_constant_force_has_many_names_and_drag_has_its_own(
    gtmab: Known, linear: Linear
) -> None:
    names = ('net_lift.force', 'ballast.mass', 'payload.mass', 'quadratic_drag.surge')
    reduced, prior = Pieces(linear).reduced(DEVIATIONS), tolerances(gtmab[1])
    cosine = np.abs(likeness(reduced, prior, names, gtmab[1]))
    np.testing.assert_allclose(np.diag(cosine), 1.0)
    assert cosine[:3, :3].min() > 0.98
    assert cosine[3, :3].max() < 0.7
