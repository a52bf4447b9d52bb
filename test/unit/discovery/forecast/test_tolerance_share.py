"""Tolerances are kept as far as forecasts of the flights that they were fitted to bear them."""

from dataclasses import replace

from lta_discovery.fit.evidence import (
    build_shared_prior,
    FLOOR,
    ParameterPosterior,
    per_flight_variance,
)
from lta_discovery.fit.joint_fit import JointFit, JointFitter
from lta_discovery.forecast import tolerance_shrinkage as module
from lta_discovery.forecast.tolerance_shrinkage import shrink_tolerances
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.replay.linearized_flight import unchanged_vehicle_point
import numpy as np
import pytest

Known = tuple[NominalVehicle, list[FreeParameter]]


@pytest.fixture(scope='module')
def fitted(gtmab: Known, clean: FlightLinearizer) -> tuple[JointFitter, JointFit]:
    """A flight about the vehicle file, and all that flights share said to be 0.02 off."""
    nominal, knobs = gtmab
    fitter = JointFitter(nominal, [clean], per_flight_variance(knobs), FLOOR)
    point = unchanged_vehicle_point(nominal, knobs, clean.replay.cut)
    joint = fitter.fit_deviations(
        fitter.linearize_flights(point.values, [point]), build_shared_prior(knobs), FLOOR
    )
    mean = np.where(per_flight_variance(knobs) > 0.0, 0.0, 0.02)
    return fitter, replace(joint, fitted=ParameterPosterior(0.0, mean, joint.fitted.covariance))


@pytest.mark.parametrize(
    ('errors', 'share'),
    [
        ((1.0, 0.99, 0.99, 0.99), 1.0),
        ((1.0, 0.9, 0.95, 1.2), 0.5),
        ((3.0, 2.0, 1.5, 1.0), 0.0),
        ((np.inf, 2.0, 1.0, 1.5), 0.25),
        ((np.inf,) * 4, 1.0),
    ],
)
def test_the_share_that_forecasts_best_is_kept_and_a_name_with_all_of_its_value(
    fitted: tuple[JointFitter, JointFit],
    monkeypatch: pytest.MonkeyPatch,
    errors: tuple[float, ...],
    share: float,
) -> None:
    """Of all, a half, a quarter and none of the tolerances; less than 2 % better is no reason."""
    fitter, joint = fitted
    told = iter(errors)
    monkeypatch.setattr(module, 'forecast_error', lambda flights, points: next(told))
    mean = shrink_tolerances(fitter, joint, named=[3]).fitted.mean
    expected = share * joint.fitted.mean
    expected[3] = joint.fitted.mean[3]
    np.testing.assert_allclose(mean, expected)


def test_forecasts_of_a_sound_flight_drop_tolerances_that_are_wrong(
    fitted: tuple[JointFitter, JointFit],
) -> None:
    """Nothing is off in this flight, so that 2 % or 2 cm of everything is too much."""
    fitter, joint = fitted
    assert not shrink_tolerances(fitter, joint).fitted.mean.any()
