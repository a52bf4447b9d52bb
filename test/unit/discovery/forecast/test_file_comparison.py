"""No fit is returned that predicts its own flights worse than the vehicle file."""

from dataclasses import replace

from lta_discovery.finding import ChannelErrors
from lta_discovery.fit.evidence import build_shared_prior, per_flight_variance, wrench_floor
from lta_discovery.fit.joint_fit import JointFit, JointFitter
from lta_discovery.forecast.file_comparison import is_worse_than_file, limit_to_file
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.replay.linearized_flight import unchanged_vehicle_point
import numpy as np
import pytest

Known = tuple[NominalVehicle, list[FreeParameter]]
DRAG, THRUST = 'linear_drag.surge', 'thrust_scale.factor'


@pytest.fixture(scope='module')
def fit(gtmab: Known, clean: FlightLinearizer) -> JointFit:
    """A clean flight, fitted at the file's values."""
    nominal, knobs = gtmab
    prior = build_shared_prior(knobs, (DRAG,))
    fitter = JointFitter(nominal, [clean], per_flight_variance(knobs), wrench_floor(nominal))
    point = unchanged_vehicle_point(nominal, knobs, clean.replay.cut)
    group = fitter.linearize_flights(point.values, [point], prior)
    return fitter.fit_deviations(group, prior, wrench_floor(nominal))


def moved(fit: JointFit, gtmab: Known, **values: float) -> JointFit:
    """Return a fit with other values, 'effect__parameter', and 0 elsewhere."""
    mean = np.zeros(len(fit.fitted.mean))
    for k, knob in enumerate(gtmab[1]):
        mean[k] = values.get(knob.name.replace('.', '__'), 0.0)
    return replace(fit, fitted=fit.fitted._replace(mean=mean))


def test_a_fit_at_the_file_stays(gtmab: Known, clean: FlightLinearizer, fit: JointFit) -> None:
    same = moved(fit, gtmab)
    found = limit_to_file(gtmab[0], [clean], same, same)
    assert found.bare is same
    assert found.full is same
    assert (found.share, found.withdrawn) == (1.0, False)
    assert {one.tuned / one.before for one in found.errors} == {1.0}


def test_a_fit_that_is_worse_is_scaled_down(
    gtmab: Known, clean: FlightLinearizer, fit: JointFit
) -> None:
    worse = moved(fit, gtmab, thrust_scale__factor=0.8)
    found = limit_to_file(gtmab[0], [clean], worse, worse)
    assert found.share < 0.5
    assert not is_worse_than_file(found.errors, 'tuned')
    assert found.full is found.bare
    index = [knob.name for knob in gtmab[1]].index(THRUST)
    assert found.bare.fitted.mean[index] == pytest.approx(0.8 * found.share)


def test_an_effect_that_makes_forecasts_worse_is_withdrawn(
    gtmab: Known, clean: FlightLinearizer, fit: JointFit
) -> None:
    bare = moved(fit, gtmab)
    named = moved(fit, gtmab, linear_drag__surge=0.5)
    index = [knob.name for knob in gtmab[1]].index(DRAG)
    found = limit_to_file(gtmab[0], [clean], bare, named, [index])
    assert found.withdrawn
    assert found.full is bare
    assert not is_worse_than_file(found.errors, 'after')


def errors(before: float, tuned: float, horizon: float = 3.0) -> ChannelErrors:
    """Return errors of the attitude."""
    return ChannelErrors(
        'attitude', 'rad', horizon, before, tuned, tuned, 1.0, 0.0, 0.0, (0.0, 0.0), 5
    )


def test_a_diverging_fit_is_worse_unless_the_file_diverges_too() -> None:
    assert is_worse_than_file([errors(1.0, np.inf)], 'tuned')
    assert not is_worse_than_file([errors(np.inf, np.inf)], 'tuned')
    assert is_worse_than_file([errors(1.0, 1.1)], 'tuned')
    # Beyond 3 s nothing is compared
    assert not is_worse_than_file([errors(1.0, 1.0), errors(1.0, 2.0, 5.0)], 'tuned')
