"""A change for good is found where it is, and not where there is none."""

from lta_analysis.discovery.change_point import change, gains
import numpy as np
import pytest
from scipy.stats import norm


def _remembering(rng, n, k, memory=6.0):
    """Return series that forget themselves over some rows, of unit spread."""
    keep = np.exp(-1.0 / memory)
    out = np.empty((n, k))
    out[0] = rng.standard_normal(k)
    for i in range(1, n):
        out[i] = keep * out[i - 1] + np.sqrt(1.0 - keep**2) * rng.standard_normal(k)
    return out


def test_the_gain_is_the_log_likelihood_ratio_of_two_gaussians_and_one():
    series = np.random.default_rng(1).normal(2.0, 3.0, (40, 2))
    found = gains(series, 5)
    for at in (5, 17, 35):
        ratio = 0.0
        for column in series.T:
            parts = column[:at], column[at:]
            ratio += sum(norm.logpdf(p, p.mean(), p.std()).sum() for p in parts)
            ratio -= norm.logpdf(column, column.mean(), column.std()).sum()
        assert found[at] == pytest.approx(ratio, rel=1e-6)
    assert np.isneginf(found[[0, 4, 36]]).all()


def test_a_step_in_one_of_six_series_is_found_where_it_is():
    series = _remembering(np.random.default_rng(2), 160, 6)
    series[90:, 2] += 5.0
    found = change(series, 9, 1)
    assert found is not None
    assert abs(found.index - 90) <= 3


def test_a_change_of_size_without_one_of_mean_is_found():
    series = _remembering(np.random.default_rng(3), 200, 3)
    series[110:] *= 6.0
    found = change(series, 9, 1)
    assert found is not None
    assert abs(found.index - 110) <= 6


def test_series_that_only_remember_have_no_change():
    rng = np.random.default_rng(4)
    found = [change(_remembering(rng, 150, 6), 9, seed) for seed in range(40)]
    assert sum(one is not None for one in found) <= 2


def test_a_short_series_says_nothing():
    assert change(np.r_[np.zeros((10, 1)), np.ones((10, 1))], 9, 1) is None


def test_one_seed_is_one_answer():
    series = _remembering(np.random.default_rng(5), 120, 2)
    series[60:] += 4.0
    assert change(series, 6, 7) == change(series, 6, 7)
