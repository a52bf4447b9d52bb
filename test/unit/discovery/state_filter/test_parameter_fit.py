# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Fits of linear flights against the posterior, computed densely; columns by differences."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.state_filter.forecast_noise import ForecastSum, weigh_errors
from lta_discovery.state_filter.likelihood import ParameterPrior
from lta_discovery.state_filter.linear_flight import FlightSystem, LinearFlight
from lta_discovery.state_filter.parameter_fit import fit_likelihood
import numpy as np
from numpy.typing import NDArray
import pytest
from scipy.linalg import block_diag
from scipy.optimize import minimize_scalar
from scipy.stats import multivariate_normal

from .dense_gaussian import build_dense, build_flight, NOISE, PARAMETERS

Array = NDArray[np.float64]

DEVIATIONS = np.array([0.5, 0.3, 0.8])
OWN = 2  # the parameter that each flight has of its own


class LinearSystem:
    """A flight that is linear in its parameters, so that one Gauss-Newton step is exact."""

    def __init__(self, flight: LinearFlight) -> None:
        self._flight = flight
        self.parameters = [
            FreeParameter(
                f'effect.{k}', '1', {('effect', str(k)): 1.0}, 1.0, 1.0, float(deviation),
                per_flight=k == OWN,
            )
            for k, deviation in enumerate(DEVIATIONS)
        ]  # fmt: skip

    def build_point(self, _nominal: NominalVehicle, values: Array, _columns: object) -> Array:
        """Return what flights with these parameters have in common."""
        return values

    def linearize_about(self, values: Array) -> LinearFlight:
        """Return the flight as seen from some values."""
        at = self._flight
        return replace(
            at, defect=at.defect + at.moved @ values, left=at.left - at.read_moved @ values
        )


def test_a_fit_is_the_posterior_of_the_parameters() -> None:
    """Of two flights that share two parameters and have a third one each."""
    # Their first states do not depend on the parameters
    flights = [build_flight(seed) for seed in (11, 12)]
    flights = [replace(one, begun=0.0 * one.begun) for one in flights]
    systems: Any = [LinearSystem(one) for one in flights]
    nominal: Any = SimpleNamespace()
    fit = fit_likelihood(systems, nominal, np.zeros(PARAMETERS), [NOISE, NOISE], learning=())
    dense = [build_dense(one, NOISE) for one in flights]
    # Unknowns: the two shared ones, then that of each flight
    design = np.concatenate([one.design[:, :OWN] for one in dense])
    design = np.column_stack([design, block_diag(*(one.design[:, OWN:] for one in dense))])
    values = np.concatenate([one.values for one in dense])
    own = block_diag(*(one.covariance for one in dense))
    prior = np.diag(np.concatenate([DEVIATIONS[:OWN], DEVIATIONS[[OWN, OWN]]]) ** 2.0)
    weight = np.linalg.inv(own)
    covariance = np.linalg.inv(design.T @ weight @ design + np.linalg.inv(prior))
    mean = covariance @ design.T @ weight @ values
    np.testing.assert_allclose(fit.values, [*mean[:OWN], 0.0], rtol=1e-6)
    np.testing.assert_allclose(fit.covariance[:OWN, :OWN], covariance[:OWN, :OWN], rtol=1e-6)
    for k, (each, spread) in enumerate(fit.own):
        assert each[OWN] == pytest.approx(mean[OWN + k], rel=1e-6)
        assert spread[OWN, OWN] == pytest.approx(covariance[OWN + k, OWN + k], rel=1e-6)
    evidence = multivariate_normal(np.zeros(len(values)), own + design @ prior @ design.T)
    wanted = evidence.logpdf(values) + 0.5 * len(values) * np.log(2.0 * np.pi)
    assert fit.evidence == pytest.approx(wanted, rel=1e-8)


def build_steady_flight(left: Array) -> LinearFlight:
    """Return a body at rest; the parameter is an error of its first coordinate."""
    count = len(left)
    readings, slopes = np.full((count, 6), np.nan), np.zeros((count, 6, 1))
    readings[:, 0], slopes[:, 0] = left, 1.0
    motion: Any = None
    still: Any = SimpleNamespace(mass=0.1)
    return LinearFlight(
        motion, np.zeros((count, 12, 12)), np.zeros((count, 12, 6)), np.zeros((count, 12, 1)),
        np.zeros((count, 12)), readings, np.zeros((count, 6, 12)), np.zeros((count, 6, 6)),
        slopes, np.ones(count), [(0, count)], np.zeros((1, 12, 1)), still,
    )  # fmt: skip


@pytest.mark.parametrize('wander', [0.0, 0.5])
def test_pieces_that_disagree_widen_the_interval(wander: float) -> None:
    """White noise of 1, and an error that is another one in each piece of 10 s."""
    rng = np.random.default_rng(4)
    # Grid points; a piece ends with the reading at the start of the next one, the first at 1 s
    ends = [26, *range(276, 5_000, 250), 5_000]
    pieces = np.repeat(np.arange(len(ends)), np.diff([0, *ends]))
    left = rng.standard_normal(len(pieces)) + wander * rng.standard_normal(len(ends))[pieces]
    system: Any = LinearSystem(build_steady_flight(left))
    system.parameters = [replace(system.parameters[0], tolerance=10.0)]
    noise = replace(NOISE, white=np.ones(6), correlated=np.full(6, 1e-9))
    nominal: Any = SimpleNamespace()
    fit = fit_likelihood([system], nominal, np.zeros(1), [noise], learning=(), is_near=True)
    precision = len(left) + 10.0**-2
    assert fit.values[0] == pytest.approx(left.sum() / precision, rel=1e-6)
    pulls = [float(np.sum(left[pieces == k] - fit.values[0])) for k in range(len(ends))]
    scatter = np.sum(np.square(pulls)) + 10.0**-2
    wider = max(1.0, np.sqrt(scatter / precision))
    assert fit.excess[0] == pytest.approx(wider, rel=1e-6)
    assert fit.covariance[0, 0] == pytest.approx(wider**2 / precision, rel=1e-6)
    # With 250 readings in a piece, a wander of 0.5 has 62.5 times the variance of their mean
    assert (fit.excess[0] > 5.0) == (wander > 0.0)


class ProductSystem(LinearSystem):
    """A flight that tells the product of two factors, a lost share and a tolerance."""

    def linearize_about(self, values: Array) -> LinearFlight:
        """Return the flight as seen from some values."""
        lost, more = values
        slopes = np.zeros((*self._flight.left.shape, 2))
        slopes[:, 0] = -1.0 - more, 1.0 - lost
        left = self._flight.left - (1.0 - lost) * (1.0 + more)
        return replace(
            self._flight, left=left, read_moved=slopes, moved=np.zeros((len(left), 12, 2)),
            begun=np.zeros((1, 12, 2)),
        )  # fmt: skip


def test_a_fit_follows_factors_whose_product_is_known() -> None:
    """From the improbable one of two factors of 0.86 to the probable one."""
    system: Any = ProductSystem(build_steady_flight(np.full(100, 0.86)))
    system.parameters = [
        replace(one, tolerance=deviation, low=low)
        for one, deviation, low in zip(
            system.parameters[:2], (0.2, 0.02), (0.0, -0.5), strict=True
        )
    ]
    noise = replace(NOISE, white=np.full(6, 1e-2), correlated=np.full(6, 1e-9))
    nominal: Any = SimpleNamespace()
    begin = np.array([0.0, -0.14])
    fit = fit_likelihood([system], nominal, begin, [noise], learning=(), is_near=True)

    def cost(lost: float) -> float:
        """Return the cost of the factor, with the other one as the product wants it."""
        return float((lost / 0.2) ** 2 + ((0.86 / (1.0 - lost) - 1.0) / 0.02) ** 2)

    wanted = float(minimize_scalar(cost, bounds=(0.0, 0.3), method='bounded').x)
    assert fit.values[0] == pytest.approx(wanted, abs=3e-4)
    assert (1.0 - fit.values[0]) * (1.0 + fit.values[1]) == pytest.approx(0.86, abs=1e-4)


def test_one_wild_forecast_weighs_like_a_linear_cost() -> None:
    """All errors have the size 1 of a normal median; one of 45 weighs by the root of 0.1."""
    errors = np.zeros((101, 1, 6, 2))
    errors[..., -1] = 0.6745
    errors[0, ..., -1] = 45.0
    errors[1] = np.nan
    weighed, size = weigh_errors(errors)
    np.testing.assert_allclose(size, 1.0, rtol=1e-3)
    assert weighed[2, 0, 0, -1] == pytest.approx(0.6745, rel=1e-3)
    # Attitudes weigh half
    assert weighed[2, 0, 3, -1] == pytest.approx(0.5 * 0.6745, rel=1e-3)
    assert weighed[0, 0, 0, -1] == pytest.approx(45.0 * 0.1**0.5, rel=1e-3)
    assert not weighed[1].any()


def test_a_step_ends_where_errors_have_the_smallest_sizes() -> None:
    """Of 200 linear errors, a tenth is wild; a step with the first weights ends elsewhere."""
    rng = np.random.default_rng(5)
    errors = np.zeros((200, 1, 6, 2))
    errors[..., 0] = rng.uniform(-1.0, 1.0, (200, 1, 6))
    errors[..., 1] = 0.1 * rng.standard_normal((200, 1, 6)) + 3.0 * errors[..., 0]
    errors[:20, ..., 1] += 4.0 * np.sign(errors[:20, ..., 0])
    errors[..., 3:, :] = 0.0

    def size(change: float) -> float:
        after = errors.copy()
        after[..., 1] += change * errors[..., 0]
        return float(weigh_errors(after)[1][0, 0])

    best = float(minimize_scalar(size, bounds=(-5.0, 0.0), method='bounded').x)
    prior = ParameterPrior(np.array([100.0]), np.array([-9.0]), np.array([9.0]), np.array([False]))
    slopes, values = np.moveaxis(weigh_errors(errors)[0], -1, 0)
    inner, pull = np.array([[np.sum(slopes**2)]]), np.array([-np.sum(slopes * values)])
    sums = ForecastSum(inner, pull, size(0.0), np.zeros((1, 1)), errors)
    first = prior.step(np.zeros(1), inner, pull)[0]
    assert abs(sums.step(prior, np.zeros(1), 0.0, 9.0)[0] - best) < 0.3 * abs(first - best)
    assert sums.step(prior, np.zeros(1), 0.0, 0.01)[0] == pytest.approx(-1.0)


Known = tuple[NominalVehicle, list[FreeParameter]]
CHECKED = (
    'thrust_scale.factor', 'rotor_fault.lost_3', 'linear_drag.surge', 'quadratic_drag.heave',
    'vehicle.mass', 'cg_offset.y', 'munk_moment.lost', 'motor_lag', 'command_delay.delay',
    'battery_sag.sensitivity', 'helium_leak.rate', 'gyro_scale.z', 'range_offset.offset',
    'tracker_delay.delay', 'steady_wind.x', 'ground_effect.gain',
)  # fmt: skip


@pytest.fixture(scope='module')
def linear(gtmab: Known, clean: FlightSystem) -> LinearFlight:
    """The clean flight about the vehicle of the file."""
    return clean.linearize(gtmab[0], np.zeros(len(gtmab[1])))


def _differ(expected: NDArray[np.float64], column: NDArray[np.float64]) -> float:
    """Return how far a column is from the expected one, by its size."""
    known = np.isfinite(expected) & np.isfinite(column)
    off = np.linalg.norm((expected - column)[known])
    # What nothing changes is 0 but for rounding
    return float(off / max(np.linalg.norm(expected[known]), 1e-6))


@pytest.mark.parametrize('name', CHECKED)
def test_a_column_is_what_another_value_changes(
    gtmab: Known, clean: FlightSystem, linear: LinearFlight, name: str
) -> None:
    """A step leaves less of its defect, and a prediction takes what it gains from the reading."""
    k = [one.name for one in gtmab[1]].index(name)
    values = np.zeros(len(gtmab[1]))
    values[k] = 1e-3 * gtmab[1][k].typical or 1e-4
    if name == 'command_delay.delay':
        values[k] = 1e-3
    none = np.zeros(len(values), dtype=np.bool_)
    after = clean.linearize(gtmab[0], values, none)
    before = clean.linearize(gtmab[1][k].enable_effect(gtmab[0]), 0.0 * values, none)
    # Nothing is known outside the run
    ((begin, end),) = linear.runs
    inside = slice(begin, end - 1)
    moved = ((after.defect - before.defect) / values[k])[inside]
    assert _differ(moved, linear.moved[inside, :, k]) < 0.06
    read = ((before.left - after.left) / values[k])[inside, :6]
    assert _differ(read, linear.read_moved[inside, :6, k]) < 0.06
