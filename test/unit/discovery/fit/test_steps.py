"""How far a fit may go: tolerances within their reach, steps that fit and forecast no worse."""

from dataclasses import replace
import math
from types import SimpleNamespace

from lta_config.errors import BadInput
from lta_discovery.fit import joint_fit as module
from lta_discovery.fit.bounds import bound_mean, find_exceeded_tolerances, parameter_bounds
from lta_discovery.fit.evidence import build_shared_prior, FLOOR, per_flight_variance, Prior
from lta_discovery.fit.joint_fit import JointFit, JointFitter
from lta_discovery.fit.misfit import forecast_error
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.model.quaternions import quaternion_product
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.replay.linearized_flight import unchanged_vehicle_point
from lta_discovery.replay.sensing import tracker_frame
from lta_discovery.study import prepare_flight
from lta_model.vehicle import load_vehicle
import numpy as np
import pytest

Known = tuple[NominalVehicle, list[FreeParameter]]

# A tolerance, a tolerance that can be an effect as well, an effect alone, and what is held.
KNOBS = [
    SimpleNamespace(name='mass', tolerance=0.1, typical=0.0, low=-0.5, high=9.0),
    SimpleNamespace(name='lag', tolerance=0.3, typical=0.4, low=-9.0, high=9.0),
    SimpleNamespace(name='wind', tolerance=0.0, typical=0.2, low=-9.0, high=9.0),
    SimpleNamespace(name='held', tolerance=0.1, typical=0.0, low=-9.0, high=9.0),
]


def _prior(*named: str) -> Prior:
    """Return the prior of KNOBS and one error of a sensor, some of them named."""
    variance = [k.tolerance**2 + (k.typical**2 if k.name in named else 0.0) for k in KNOBS]
    return Prior(np.zeros(5), np.diag([*variance[:3], 0.0, 4.0]))


def test_a_tolerance_may_go_six_standard_deviations_and_an_effect_to_its_bounds() -> None:
    """A tolerance of 0.3 that can be an effect of 0.4 as well may go 6 hypot(0.3, 0.4) = 3."""
    low, high = parameter_bounds(KNOBS, _prior('wind'))
    np.testing.assert_allclose(low, [-0.5, -3.0, -9.0, -9.0, -math.inf])
    np.testing.assert_allclose(high, [0.6, 3.0, 9.0, 9.0, math.inf])
    np.testing.assert_allclose(
        parameter_bounds(KNOBS, _prior('lag'))[1], [0.6, 9.0, 9.0, 9.0, math.inf]
    )


def test_a_tolerance_that_wants_out_is_told_and_an_effect_is_not() -> None:
    mean = np.array([0.61, 3.1, 99.0, 99.0, 99.0])
    assert find_exceeded_tolerances(KNOBS, _prior('wind'), mean) == ['mass', 'lag']
    assert find_exceeded_tolerances(KNOBS, _prior('lag', 'wind'), mean) == ['mass']
    assert find_exceeded_tolerances(KNOBS, _prior(), np.array([0.59, -2.9, 0.0, 0.0, 0.0])) == []


@pytest.fixture(scope='module')
def begun(gtmab: Known, clean: FlightLinearizer) -> tuple[JointFitter, JointFit]:
    """A flight about the vehicle file, and its fitter."""
    nominal, knobs = gtmab
    fitter = JointFitter(nominal, [clean], per_flight_variance(knobs), FLOOR)
    point = unchanged_vehicle_point(nominal, knobs, clean.replay.cut)
    group = fitter.linearize_flights(point.values, [point])
    return fitter, fitter.fit_deviations(group, build_shared_prior(knobs), FLOOR)


def _mass(fitter: JointFitter, joint: JointFit, value: float) -> JointFit:
    """Return a fit of which the flights are said to stand at another mass."""
    at = joint.group.at.copy()
    at[[knob.name for knob in fitter.flights[0].knobs].index('vehicle.mass')] = value
    return replace(joint, group=replace(joint.group, at=at))


def test_the_first_step_of_flights_that_stand_apart_is_checked_too(
    begun: tuple[JointFitter, JointFit], monkeypatch: pytest.MonkeyPatch
) -> None:
    """It used to be taken whatever it led to; where all steps are worse, they are gathered."""
    fitter, joint = begun
    apart = _mass(fitter, joint, 0.01)
    assert not apart.group.is_aligned
    monkeypatch.setattr(
        JointFitter,
        '_point_misfit',
        lambda self, last, at, points: 1.0 if at is last.group.at else 9e9,
    )
    step = fitter._choose_step(apart)
    assert step is not None
    assert step.at is apart.group.at
    same = np.flatnonzero(fitter.variance == 0.0)
    np.testing.assert_allclose(step.points[0].values[same], apart.group.at[same])


def test_a_step_after_which_forecasts_are_three_times_as_bad_is_refused(
    begun: tuple[JointFitter, JointFit], monkeypatch: pytest.MonkeyPatch
) -> None:
    fitter, joint = begun
    for worse, taken in ((2.9, True), (3.1, False)):
        errors = iter([1.0, *[worse] * 20])
        monkeypatch.setattr(module, 'forecast_error', lambda *_, told=errors: next(told))
        assert (fitter._choose_step(joint) is not None) is taken


def test_a_damped_step_is_taken_where_the_whole_leads_too_far(
    begun: tuple[JointFitter, JointFit], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A misfit that falls up to a fifth of the way, and is so large beyond that nothing helps."""
    fitter, joint = begun
    way = fitter.propose_step(joint)[0] - joint.group.at

    def misfit(self, last, at, points):
        part = float((at - joint.group.at) @ way / (way @ way))
        return 9e9 if part > 0.2 else 1e6 - 1e4 * part

    monkeypatch.setattr(JointFitter, '_point_misfit', misfit)
    monkeypatch.setattr(module, 'predict_linear_misfit', lambda *_: 1e6 - 1.0)
    monkeypatch.setattr(module, 'forecast_error', lambda *_: 1.0)
    step = fitter._choose_step(joint)
    assert step is not None
    assert not step.whole
    part = float((step.at - joint.group.at) @ way / (way @ way))
    assert 0.0 < part < 0.2


def test_unknowns_of_pieces_are_solved_for_again_where_their_prediction_is_off(
    begun: tuple[JointFitter, JointFit],
) -> None:
    """States 2 cm and 2 degrees off, in a flight whose noise is millimetres, hide good values."""
    fitter, joint = begun
    at, points = fitter.propose_step(joint)
    best = fitter._point_misfit(joint, at, points)
    off = points[0].random.copy()
    off[:, :6] += [0.02, 0.02, 0.02, 0.035, 0.035, 0.035]
    away = [replace(points[0], random=off)]
    assert fitter._point_misfit(joint, at, away) > 10.0 * best
    misfit, settled = fitter._settle_points(joint, at, away, best)
    assert misfit < best + 2.0
    np.testing.assert_array_equal(
        settled[0].values[fitter.variance == 0.0], at[fitter.variance == 0.0]
    )


def test_what_is_beyond_a_bound_takes_the_others_along() -> None:
    """
    Of a Gaussian with mean (2, 1) and correlation 0.9, at a first value of 1.

    The second is 1 + 0.9 (1 - 2) = 0.1 there; where that is below its bound of 0.5, it is on it.
    """
    mean, covariance = np.array([2.0, 1.0]), np.array([[1.0, 0.9], [0.9, 1.0]])
    far = np.full(2, np.inf)
    np.testing.assert_allclose(bound_mean(mean, covariance, -far, far), mean)
    high = np.array([1.0, np.inf])
    np.testing.assert_allclose(bound_mean(mean, covariance, -far, high), [1.0, 0.1])
    low = np.array([-np.inf, 0.5])
    np.testing.assert_allclose(bound_mean(mean, covariance, low, high), [1.0, 0.5])


def test_a_forecast_by_the_wrong_mass_is_off(
    gtmab: Known, clean: FlightLinearizer, begun: tuple[JointFitter, JointFit]
) -> None:
    """
    49 mN on 0.415 kg and 0.343 kg of air: a = 65 mm/s2, off by a t^2 / 2.

    Its root mean square over T = 3 s is a T^2 / (2 x 5^0.5) = 0.130 m at rest. In flight, the lift
    of the hull slows it by 0.63 N s2/m2 times the speed: at the highest, 0.6 m/s, with the time
    constant tau = 2.0 s, a tau (t - tau (1 - e^(-t / tau))) has 0.090 m, less a little for drag.
    """
    nominal, knobs = gtmab
    point = unchanged_vehicle_point(nominal, knobs, clean.replay.cut)
    heavy = replace(point, nominal=nominal.with_value('net_lift', 'force', -0.049))
    noise = clean.replay.flight.noise[2]
    assert forecast_error([clean], [point]) < 40.0
    lost = forecast_error([clean], [heavy]) * noise * np.sqrt(3.0)
    assert 0.9 * 0.090 < lost < 0.130  # of the vertical alone


def test_forecasts_are_compared_in_the_frame_of_the_tracker(
    gtmab: Known, clean: FlightLinearizer
) -> None:
    """A tracker is tilted by 3 degrees, and the model has that: forecasts are as good as ever."""
    nominal, knobs = gtmab
    tilted, seen = nominal.with_value('tracker_misalignment', 'pitch', 0.05), clean.replay.flight
    frame, turn = tracker_frame(tilted.build_replay_rows().acting)
    turned = quaternion_product(np.broadcast_to(turn, seen.quaternion.shape), seen.quaternion)
    told = replace(seen, position=seen.position @ frame.T, quaternion=turned)
    flight = prepare_flight(load_vehicle('gtmab'), told, knobs)
    straight = forecast_error([clean], [unchanged_vehicle_point(nominal, knobs, clean.replay.cut)])
    point = unchanged_vehicle_point(tilted, knobs, flight.replay.cut)
    assert forecast_error([flight], [point]) == pytest.approx(straight, rel=0.05)
    assert forecast_error([flight], [replace(point, nominal=nominal)]) > 3.0 * straight


def test_flights_that_no_number_describes_are_refused_in_a_sentence(
    begun: tuple[JointFitter, JointFit], monkeypatch: pytest.MonkeyPatch
) -> None:
    fitter, joint = begun
    wild = replace(
        joint.group.linears[0], grams=np.full_like(joint.group.linears[0].grams, np.inf)
    )
    monkeypatch.setattr(FlightLinearizer, 'linearize', lambda *_: wild)
    with pytest.raises(BadInput, match='diverges'):
        fitter.linearize_flights(joint.group.at, [joint.group.linears[0].point])
