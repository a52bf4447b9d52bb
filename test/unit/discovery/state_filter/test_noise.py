# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The noise of trackers of any rate is found by the evidence of the readings."""

from dataclasses import replace

from lta_discovery.flights.measured_flight import FlightStreams, resample_flight, Stream
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.model.quaternions import quaternion_exponential, quaternion_product
from lta_discovery.state_filter.likelihood import ParameterPrior
from lta_discovery.state_filter.linear_flight import FlightSystem
from lta_discovery.state_filter.noise_fit import learn_noise
from lta_discovery.state_filter.noise_model import average_noise, NoiseModel
from lta_model.vehicle import load_vehicle
import numpy as np
from numpy.typing import NDArray
import pytest

from .. import hidden_flight  # noqa: TID252 - `test` is Python's own

Array = NDArray[np.float64]

WHITE = np.array([2e-3] * 3 + [5e-3] * 3)  # m, rad
SLOW = np.array([3e-3] * 3 + [6e-3] * 3)  # m, rad
MEMORY = 0.3  # s
RATE = 100  # Hz; of the recording

Known = tuple[NominalVehicle, list[FreeParameter]]


@pytest.fixture(scope='module')
def exact() -> FlightStreams:
    """A minute's flight of which nothing but exact poses is known."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(hidden_flight, 'POSE_NOISE', 0.0)
        patch.setattr(hidden_flight, 'TURN_NOISE', 0.0)
        streams = hidden_flight.flown({}, 31, 62.0)
    return replace(streams, others={'voltage': streams.others['voltage']})


def observe(streams: FlightStreams, rate: int, white: Array, slow: Array) -> FlightStreams:
    """Return what a tracker of a rate reads, with white errors and slow ones."""
    rng = np.random.default_rng(rate)
    time = streams.pose.time
    kept = np.exp(-np.diff(time, prepend=time[0] - 1.0 / RATE) / MEMORY)
    wander = np.zeros((len(time), 6))
    wander[0] = slow * rng.standard_normal(6)
    for k in range(1, len(time)):
        fresh = np.sqrt(1.0 - kept[k] ** 2) * slow * rng.standard_normal(6)
        wander[k] = kept[k] * wander[k - 1] + fresh
    error = wander + white * rng.standard_normal((len(time), 6))
    values = streams.pose.values.copy()
    values[:, :3] += error[:, :3]
    values[:, 3:] = quaternion_product(values[:, 3:], quaternion_exponential(error[:, 3:]))
    every = RATE // rate
    return replace(streams, pose=Stream(time[::every], values[::every]))


@pytest.mark.parametrize('rate', [10, 25, 100])
def test_white_and_slow_errors_of_a_tracker_are_told_apart(
    exact: FlightStreams, gtmab: Known, rate: int
) -> None:
    nominal, every = gtmab
    parameters = [one for one in every if one.name in ('net_lift.force', 'thrust_scale.factor')]
    flight = resample_flight(observe(exact, rate, WHITE, SLOW))
    system = FlightSystem(load_vehicle('gtmab'), flight, parameters)
    values = np.zeros(len(parameters))
    linear = system.linearize(nominal, values)
    begin = [NoiseModel.guess(nominal, flight)]
    (found,) = learn_noise([linear], ParameterPrior.of(parameters), values, begin)
    np.testing.assert_allclose(found.white, WHITE, rtol=0.2)
    np.testing.assert_allclose(found.correlated, SLOW, rtol=0.2)
    assert found.correlation == pytest.approx(MEMORY, rel=0.3)


def test_the_mean_of_noise_models_is_geometric(gtmab: Known) -> None:
    one = NoiseModel(
        np.full(6, 1e-3), np.full(6, 4e-3), 0.2, np.array([1.0, 2.0, 3.0, 4.0, 5.0, 6.0]),
        np.array([2.0] * 3 + [8.0] * 3),
    )  # fmt: skip
    other = replace(one, white=np.full(6, 4e-3), correlation=0.8, wrench=4.0 * one.wrench)
    both = average_noise([one, other])
    np.testing.assert_allclose(both.white, 2e-3)
    np.testing.assert_allclose(both.correlated, 4e-3)
    assert both.correlation == pytest.approx(0.4)
    np.testing.assert_allclose(both.wrench, 2.0 * one.wrench)
    np.testing.assert_allclose(both.memory, one.memory)
    np.testing.assert_allclose(one.with_logarithms(one.logarithms).wrench, one.wrench)
