"""How much force flights leave unexplained is found along the slope of the evidence."""

from lta_analysis.discovery.fit.deviations import best, strides, weighed
from lta_analysis.discovery.fit.evidence import (
    evidence_of,
    FLOOR,
    log_prior,
    own_variance,
    Pieces,
    Prior,
    shared,
)
from lta_analysis.discovery.fit.group import Group
from lta_analysis.discovery.fit.steepness import Steepness, steepness
from lta_analysis.discovery.model.knobs import Knob
from lta_analysis.discovery.model.nominal import Nominal
from lta_analysis.discovery.replay.linear import origin
from lta_analysis.discovery.replay.linearise import Linearised
import numpy as np
from numpy.typing import NDArray
import pytest

Known = tuple[Nominal, list[Knob]]
Array = NDArray[np.float64]


@pytest.fixture(scope='module')
def begun(gtmab: Known, clean: Linearised) -> tuple[Group, Prior]:
    """A flight about the vehicle file, and what is known of that."""
    nominal, knobs = gtmab
    at = origin(nominal, knobs, len(clean.replay.first))
    return Group((Pieces(clean.at(at)),), at.values, own_variance(knobs)), shared(knobs)


def logged(group: Group, prior: Prior, deviations: Array) -> float:
    """Return the log evidence as it is defined."""
    return evidence_of(group.reduced(deviations), group.at, prior) + log_prior(deviations)


@pytest.mark.parametrize('size', [0.3, 1.0, 6.0])
def test_the_slope_is_that_of_the_evidence(begun: tuple[Group, Prior], size: float) -> None:
    group, prior = begun
    at = size * FLOOR
    seen = steepness(group, prior, at, FLOOR)
    assert seen.value == pytest.approx(logged(group, prior, at), abs=1e-6)
    aside = 1e-3 * np.eye(len(FLOOR))
    ups, downs = (
        np.array([logged(group, prior, at * np.exp(way * each)) for each in aside])
        for way in (1.0, -1.0)
    )
    assert seen.slope == pytest.approx((ups - downs) / 2e-3, rel=1e-3, abs=1e-3)
    assert np.linalg.eigvalsh(seen.bend).min() > 0.0


def test_the_same_deviations_are_found_from_above_and_below(begun: tuple[Group, Prior]) -> None:
    group, prior = begun
    low, high = (weighed(group, prior, size * FLOOR, FLOOR, ()) for size in (0.2, 20.0))
    assert low[1] == pytest.approx(high[1], abs=0.1)
    assert low[0] == pytest.approx(high[0], rel=0.1)
    for axis in range(len(FLOOR)):  # nothing near is better
        for factor in (0.7, 1.4):
            near = low[0].copy()
            near[axis] *= factor
            assert logged(group, prior, near) < low[1]


def test_a_stride_ends_where_a_variance_does() -> None:
    """With one knot that is known exactly, the best variance is its square."""
    for spent in (0.5, 4.0):
        seen = Steepness(0.0, np.full(6, spent - 1.0), 2.0 * np.eye(6))
        assert strides(seen) == pytest.approx(0.5 * np.log(spent))


def test_no_stride_is_made_where_there_is_no_evidence() -> None:
    def steep(_: Array) -> Steepness:
        raise AssertionError

    at, value = best(lambda _: -np.inf, steep, FLOOR, FLOOR)
    assert value == -np.inf
    assert at == pytest.approx(FLOOR)
