"""Intervals of fitted values, including the error of the model itself."""

from types import SimpleNamespace

from lta_analysis.discovery.fit.evidence import Fitted
from lta_analysis.discovery.naming.interval import NORMAL, spread
import numpy as np
import pytest
from scipy.stats import norm


@pytest.mark.parametrize(('beside', 'wider'), [(False, 1.0), (True, 1.44)])
def test_a_value_is_off_by_half_a_percent_at_least(beside: bool, wider: float) -> None:
    """For 200 that is 1; unexplained forces widen the deviation by a fifth."""
    knobs = [SimpleNamespace(name=name) for name in ('vehicle.mass', 'clock_skew.skew')]
    covariance = np.diag([4.0, 9e-12, 77.0])
    found = Fitted(0.0, np.array([-200.0, 0.0, 5.0]), covariance)
    expected = np.sqrt([4.0 * wider + 1.0, 9e-12 * wider + 25e-12])
    np.testing.assert_allclose(spread(found, knobs, beside), expected)


def test_an_interval_holds_95_percent() -> None:
    assert norm.cdf(NORMAL) - norm.cdf(-NORMAL) == pytest.approx(0.95, abs=1e-4)
