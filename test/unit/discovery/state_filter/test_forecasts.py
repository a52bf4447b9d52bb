# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Forecasts know nothing of later poses, and are right where the model is."""

from dataclasses import replace

from lta_discovery.flights.measured_flight import (
    FlightStreams,
    GRID_PERIOD,
    MeasuredFlight,
    resample_flight,
    Stream,
)
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter, list_free_parameters
from lta_discovery.state_filter.forecast_noise import CLEARLY, fit_forecast_noise, measure_errors
from lta_discovery.state_filter.forecast_scores import COASTING, FILE_MODEL, score_forecasts
from lta_discovery.state_filter.forecasts import (
    coast,
    COASTING_PERIODS,
    FlightForecasts,
    forecast_flights,
    list_flight_parameters,
    VARIES,
)
from lta_discovery.state_filter.likelihood import linearize_all, ParameterPrior
from lta_discovery.state_filter.linear_flight import FlightSystem
from lta_discovery.state_filter.noise_model import NoiseModel
from lta_model.vehicle import load_vehicle
import numpy as np
from numpy.typing import NDArray
import pytest
from scipy.spatial.transform import Rotation

from .. import hidden_flight  # noqa: TID252 - `test` is Python's own

Array = NDArray[np.float64]
Known = tuple[NominalVehicle, list[FreeParameter]]

HORIZONS = (1.0, 3.0)
LIFT = -0.008  # N


def fly(changes: dict[str, object], seed: int, seconds: float, noise: float) -> FlightStreams:
    """Return a flight of which the tracker alone tells, with a share of its usual noise."""
    with pytest.MonkeyPatch.context() as patch:
        for name in ('POSE_NOISE', 'TURN_NOISE'):
            patch.setattr(hidden_flight, name, noise * getattr(hidden_flight, name))
        streams = hidden_flight.flown(changes, seed, seconds)
    return replace(streams, others={'voltage': streams.others['voltage']})


def forecast(
    flight: MeasuredFlight,
    nominal: NominalVehicle,
    parameters: list[FreeParameter],
    is_exact: bool = False,
) -> FlightForecasts:
    """Return the forecasts of a flight, whose tracker and model may be exact."""
    guess = NoiseModel.guess(nominal, flight)
    if is_exact:
        guess = replace(
            guess,
            white=0.1 * guess.white,
            correlated=0.1 * guess.correlated,
            wrench=0.01 * guess.wrench,
        )
    own = list_flight_parameters(nominal, parameters)
    return forecast_flights(load_vehicle('gtmab'), nominal, [flight], own, [guess], HORIZONS)[0]


@pytest.fixture(scope='module')
def heavy() -> MeasuredFlight:
    """A flight with 8 mN less lift than the file has."""
    lift = {'vehicle.effects.net_lift.force': {'value': LIFT, 'unit': 'N'}}
    return resample_flight(fly(lift, 43, 44.0, 1.0))


def test_a_perfect_model_forecasts_to_millimetres(gtmab: Known) -> None:
    """What is left is the start, which the poses tell, and the time steps of both."""
    nominal, _ = gtmab
    flight = resample_flight(fly({}, 41, 24.0, 0.0))
    told = forecast(flight, nominal, [], is_exact=True)
    assert len(told.starts) > 10
    near, middle = score_forecasts({FILE_MODEL: [told]})
    for score, place, turn in ((near, 5e-4, 5e-4), (middle, 1e-3, 1e-3)):
        assert score.errors[FILE_MODEL].position < place
        assert score.errors[FILE_MODEL].attitude < turn
        assert score.errors[COASTING].position > 50.0 * place


def test_no_forecast_changes_with_later_poses(heavy: MeasuredFlight, gtmab: Known) -> None:
    """Nor by what is learned of lift and commands; the errors do, by just that change."""
    nominal, parameters = gtmab
    first = forecast(heavy, nominal, parameters)
    s = 14
    start = first.starts[s]
    shift = np.array([0.3, -0.2, 0.1])

    def move(time: Array, position: Array) -> Array:
        late = (time > start + 0.5 * GRID_PERIOD)[:, None]
        out: Array = np.where(late, position + (time - start)[:, None] * shift, position)
        return out

    assert heavy.poses is not None
    poses = heavy.poses.values.copy()
    poses[:, :3] = move(heavy.poses.time, poses[:, :3])
    second = forecast(
        replace(
            heavy,
            position=move(heavy.time, heavy.position),
            poses=Stream(heavy.poses.time, poses),
        ),
        nominal,
        parameters,
    )
    np.testing.assert_array_equal(first.starts, second.starts)
    for h, horizon in enumerate(HORIZONS):
        change = second.errors[s, h] - first.errors[s, h]
        np.testing.assert_allclose(change, [*(horizon * shift), 0.0, 0.0, 0.0], atol=1e-9)
        # Those that end before it are the same
        ended = first.starts + horizon <= start
        np.testing.assert_allclose(second.errors[ended, h], first.errors[ended, h], atol=1e-9)
        np.testing.assert_array_equal(second.coasting[ended, h], first.coasting[ended, h])
    assert np.abs(second.errors[s + 2] - first.errors[s + 2]).max() > 0.01


def test_lift_that_the_file_lacks_is_learned_on_the_way(
    heavy: MeasuredFlight, gtmab: Known
) -> None:
    nominal, parameters = gtmab
    lift = [replace(one, tolerance=0.01) for one in parameters if one.name == 'net_lift.force']
    right = nominal.with_value('net_lift', 'force', LIFT)
    with_lift, without, known = (
        forecast(heavy, vehicle, own)
        for vehicle, own in ((nominal, lift), (nominal, []), (right, []))
    )
    late = with_lift.starts > heavy.time[0] + 20.0
    up, blind, best = (
        float(np.sqrt(np.nanmean(each.errors[late, 1, 2] ** 2)))
        for each in (with_lift, without, known)
    )
    assert up < 0.3 * blind
    assert up < 1.5 * best


def test_noise_of_forecasts_is_better_than_the_noise_before(
    heavy: MeasuredFlight, gtmab: Known
) -> None:
    nominal = gtmab[0].with_value('net_lift', 'force', LIFT)
    parameters = [one for one in gtmab[1] if one.tolerance > 0.0]
    systems = [FlightSystem(load_vehicle('gtmab'), heavy, parameters)]
    linear = linearize_all(systems, nominal, np.zeros(len(parameters)))
    prior, guess = ParameterPrior.of(parameters), NoiseModel.guess(nominal, heavy)

    def measure(one: NoiseModel) -> float:
        return measure_errors(linear, [one], prior, HORIZONS)

    first = replace(guess, wrench=8.0 * guess.wrench)
    # Slopes by what flights share change no error
    own = [one.keep_columns(prior.own) for one in linear]
    assert 0 < own[0].moved.shape[2] < linear[0].moved.shape[2]
    assert measure_errors(own, [first], prior.of_flight, HORIZONS) == pytest.approx(
        measure(first), rel=1e-9
    )
    (best,) = fit_forecast_noise(linear, [first], prior, HORIZONS)
    assert measure(best) < measure(first) - CLEARLY
    np.testing.assert_array_equal(best.white, guess.white)
    # The model is right, so that any smaller force is better still, as far as it is looked for
    for other in (
        replace(best, wrench=2.0 * best.wrench),
        replace(best, memory=0.5 * best.memory),
    ):
        assert measure(other) > measure(best) - CLEARLY


def test_what_a_flight_has_of_its_own(gtmab: Known) -> None:
    """Its lift, biases, and the strength of its commands, but not a trend of the lift."""
    nominal, parameters = gtmab
    own = {one.name: one for one in list_flight_parameters(nominal, parameters)}
    assert own['net_lift.force'].tolerance > 0.0
    assert 'helium_leak.rate' not in own
    assert 'linear_drag.surge' not in own
    wrench = list_free_parameters(nominal.with_value('wrench_gain', 'surge', -0.5), wrench=True)
    pushed = {
        one.name: one
        for one in list_flight_parameters(nominal.with_value('wrench_gain', 'surge', -0.5), wrench)
    }
    assert pushed['wrench_gain.surge'].tolerance == pytest.approx(0.5 * VARIES)
    assert pushed['wrench_gain.yaw'].tolerance == pytest.approx(VARIES)
    assert not any('reference' in name for name in pushed)


def coasting_flight(acceleration: float, rate: float) -> MeasuredFlight:
    """Return a flight along x with constant acceleration, and about z with a constant rate."""
    time = 2.0 + GRID_PERIOD * np.arange(150)
    x = 0.3 * time + 0.5 * acceleration * (time - 4.0) ** 2
    position = np.column_stack([x, -0.1 * time, np.ones_like(time)])
    return MeasuredFlight(
        time, position, Rotation.from_euler('z', (rate * time)[:, None]).as_quat(),
        np.full((len(time), 8), np.nan), np.concatenate([np.full(6, 1e-3), np.full(8, np.inf)]),
        np.ones(len(time), dtype=np.bool_), Stream(time, np.zeros((len(time), 4))),
        np.full(len(time), np.nan),
    )  # fmt: skip


def test_coasting_at_constant_velocity_has_no_error() -> None:
    """Past the end there is none to tell, and none without four poses before the start."""
    errors = coast(coasting_flight(0.0, 0.0), np.array([40, 130]), HORIZONS)
    np.testing.assert_allclose(errors[0], 0.0, atol=1e-9)
    assert np.isnan(errors[1]).all()
    assert np.isnan(coast(coasting_flight(0.0, 0.0), np.array([2]), HORIZONS)).all()


def test_coasting_goes_on_round_a_circle() -> None:
    """
    A line through half a second of a circle is too short by sinc and ends inside of it.

    So coasting is off by a few millimetres of a metre and a half, where straight on is off by half
    a metre after 3 s.
    """
    time, rate, radius = 2.0 + GRID_PERIOD * np.arange(150), 0.4, 1.0
    flight = coasting_flight(0.0, rate)
    place = radius * np.column_stack([np.sin(rate * time), -np.cos(rate * time), 0.0 * time])
    errors = coast(replace(flight, position=place), np.array([50]), HORIZONS)[0]
    np.testing.assert_allclose(errors[:, 3:], 0.0, atol=1e-9)
    assert np.linalg.norm(errors[:, :3], axis=1).max() < 0.01


def test_coasting_misses_an_acceleration_by_a_closed_form() -> None:
    """
    The line through a t^2 / 2 at N even times about m has its slope there, and their variance.

    So it is off by a / 2 ((h - m)^2 - variance) after h.
    """
    acceleration, count = 0.4, COASTING_PERIODS + 1
    errors = coast(coasting_flight(acceleration, 0.0), np.array([50]), HORIZONS)
    middle, variance = (
        -0.5 * COASTING_PERIODS * GRID_PERIOD,
        GRID_PERIOD**2 * (count**2 - 1) / 12.0,
    )
    for h, horizon in enumerate(HORIZONS):
        wanted = 0.5 * acceleration * ((horizon - middle) ** 2 - variance)
        np.testing.assert_allclose(errors[0, h], [wanted, *[0.0] * 5], atol=1e-9)


def test_forecasts_that_were_not_measured_do_not_count() -> None:
    """Errors of 3, 4 cm in the plane and one unknown: 5 cm; 0.1 rad of yaw."""
    errors = np.zeros((3, 1, 6))
    errors[:2, 0, :3] = 0.03, 0.04, 0.0
    errors[:2, 0, 5] = 0.1
    errors[2, 0, 0] = np.nan
    # The nose points along y
    floor = np.full((3, 1, 6), [0.01, 0.02, 0.02, 0.0, 0.0, 0.03])
    floor[2] = np.nan
    north = np.full(3, 0.5 * np.pi)
    flight = FlightForecasts(np.arange(3.0), (1.0,), errors, errors, north, floor)
    (score,) = score_forecasts({FILE_MODEL: [flight]})
    assert score.errors[FILE_MODEL] == pytest.approx((0.05, 0.1, 0.04, 0.03, 0.0))
    assert score.least == pytest.approx((0.03, 0.03))
    assert score.forecasts == 2
    unstable = replace(flight, floor=np.full((3, 1, 6), np.nan))
    (score,) = score_forecasts({FILE_MODEL: [unstable]})
    assert np.isnan(score.least).all()
    lost = replace(flight, errors=np.full((3, 1, 6), np.nan))
    assert score_forecasts({FILE_MODEL: [lost]}) == ()
