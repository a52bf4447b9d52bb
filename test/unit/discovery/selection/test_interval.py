"""The spread of a value includes an assumed error of the model itself."""

from types import SimpleNamespace

from lta_discovery.fit.evidence import ParameterPosterior
from lta_discovery.selection.interval import NORMAL, parameter_deviations
import numpy as np
import pytest
from scipy.stats import norm


@pytest.mark.parametrize(('beside', 'wider'), [(False, 1.0), (True, 1.44)])
def test_a_spread_includes_half_a_percent_of_the_value(beside: bool, wider: float) -> None:
    """
    Half a percent of 200 is 1; the clock skew has a least error of 5e-6 as well.

    Beside effects outside the library deviations are larger by a fifth, variances by 1.2^2 = 1.44.
    """
    knobs = [
        SimpleNamespace(name=name, tolerance=0.0, per_flight=False)
        for name in ('vehicle.mass', 'clock_skew.skew')
    ]
    covariance = np.diag([4.0, 9e-12, 77.0])
    found = ParameterPosterior(0.0, np.array([-200.0, 0.0, 5.0]), covariance)
    expected = np.sqrt([4.0 * wider + 1.0, 9e-12 * wider + 25e-12])
    np.testing.assert_allclose(parameter_deviations(found, knobs, beside), expected)


def test_a_spread_includes_a_fifth_of_the_tolerance_of_what_all_flights_share() -> None:
    """A fifth of 20 is 4, and 3, 4 make 5; what each flight draws anew averages out."""
    knobs = [
        SimpleNamespace(name=name, tolerance=20.0, per_flight=own)
        for name, own in (('quadratic_drag.heave', False), ('net_lift.force', True))
    ]
    found = ParameterPosterior(0.0, np.zeros(2), np.diag([9.0, 9.0]))
    np.testing.assert_allclose(parameter_deviations(found, knobs, False), [5.0, 3.0])


def test_an_interval_holds_95_percent() -> None:
    assert norm.cdf(NORMAL) - norm.cdf(-NORMAL) == pytest.approx(0.95, abs=1e-4)
