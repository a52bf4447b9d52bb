"""Tolerances are kept as far as forecasts of the flights that they were fitted to bear them."""

from dataclasses import replace

from lta_discovery.fit.evidence import Fitted, FLOOR, own_variance, shared
from lta_discovery.fit.fit import Fitter, Joint
from lta_discovery.forecast import share as module
from lta_discovery.forecast.share import forecasting
from lta_discovery.model.knobs import Knob
from lta_discovery.model.nominal import Nominal
from lta_discovery.replay.linear import origin
from lta_discovery.replay.linearise import Linearised
import numpy as np
import pytest

Known = tuple[Nominal, list[Knob]]


@pytest.fixture(scope='module')
def fitted(gtmab: Known, clean: Linearised) -> tuple[Fitter, Joint]:
    """A flight about the vehicle file, and all that flights share said to be 0.02 off."""
    nominal, knobs = gtmab
    fitter = Fitter(nominal, [clean], own_variance(knobs), FLOOR)
    point = origin(nominal, knobs, clean.replay.cut)
    joint = fitter.settled(fitter.about(point.values, [point]), shared(knobs), FLOOR)
    mean = np.where(own_variance(knobs) > 0.0, 0.0, 0.02)
    return fitter, replace(joint, fitted=Fitted(0.0, mean, joint.fitted.covariance))


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
    fitted: tuple[Fitter, Joint],
    monkeypatch: pytest.MonkeyPatch,
    errors: tuple[float, ...],
    share: float,
) -> None:
    """Of all, a half, a quarter and none of the tolerances; less than 2 % better is no reason."""
    fitter, joint = fitted
    told = iter(errors)
    monkeypatch.setattr(module, 'forecast_error', lambda flights, points: next(told))
    mean = forecasting(fitter, joint, named=[3]).fitted.mean
    expected = share * joint.fitted.mean
    expected[3] = joint.fitted.mean[3]
    np.testing.assert_allclose(mean, expected)


def test_forecasts_of_a_sound_flight_drop_tolerances_that_are_wrong(
    fitted: tuple[Fitter, Joint],
) -> None:
    """Nothing is off in this flight, so that 2 % or 2 cm of everything is too much."""
    fitter, joint = fitted
    assert not forecasting(fitter, joint).fitted.mean.any()
