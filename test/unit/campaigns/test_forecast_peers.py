# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The two peers of `make campaign forecasts` on flights that are integrated exactly."""

from campaigns import forecast_peers as peers
from lta_discovery.flights.measured_flight import GRID_PERIOD, MeasuredFlight, Stream
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

# Of surge, sway, heave and yaw; the moment acts the other way round
GAIN = np.array([2.0, 1.5, 1.0, -8.0])  # m/s2/N, rad/s2/N m
DRAG = np.array([0.3, 0.6, 0.9, 0.5])  # 1/s
BIAS = np.array([0.0, 0.0, 0.01, 0.0])
LIFTED = 0.03  # m/s2; of a flight whose lift differs
DELAY = 0.2  # s
HELD = 5.0  # s; of each command, long beside the half second of a start
FINE = 5  # steps in a grid period


def fly(seed, lift=0.0, seconds=60.0):
    """Return a flight with steps of the commands, by the exact solution of each axis."""
    draw = np.random.default_rng(seed)
    count = round(seconds / GRID_PERIOD)
    orders = draw.normal(size=(round(seconds / HELD), 4)) * (0.03, 0.02, 0.03, 0.01)
    step = GRID_PERIOD / FINE
    place, yaw, speed = np.array([0.0, 0.0, 2.0]), 0.3, np.zeros(4)
    positions, yaws = [place], [yaw]
    fade = np.exp(-DRAG * step)
    for k in range(count * FINE):
        order = orders[max(int(((k + 0.5) * step - DELAY) / HELD), 0)]
        final = (GAIN * order + BIAS + (0.0, 0.0, lift, 0.0)) / DRAG
        middle = final + (speed - final) * np.sqrt(fade)
        heading = yaw + 0.5 * step * middle[3]
        c, s = np.cos(heading), np.sin(heading)
        turned = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        place, yaw = place + step * turned @ middle[:3], yaw + step * middle[3]
        speed = final + (speed - final) * fade
        if (k + 1) % FINE == 0:
            positions.append(place)
            yaws.append(yaw)
    time, none = GRID_PERIOD * np.arange(count + 1), np.zeros((1, 0))
    wrench = np.zeros((len(orders), 6))
    wrench[:, [0, 1, 2, 5]] = orders
    return MeasuredFlight(
        time,
        np.array(positions),
        Rotation.from_rotvec(np.outer(yaws, [0.0, 0.0, 1.0])).as_quat(),
        np.full((len(time), 8), np.nan),
        np.full(14, np.inf),
        np.full(len(time), True),
        Stream(np.zeros(1), none),
        np.full(len(time), np.nan),
        Stream(HELD * np.arange(len(orders)), wrench),
    )


def rms(errors):
    return np.sqrt(np.nanmean(np.sum(errors**2, axis=1)))


@pytest.fixture
def taught():
    return [peers.Flown(fly(seed)) for seed in (1, 2)]


def forecasts(flight):
    """Return starts of a held-out flight, the truth 3 s ahead, and the error of lines [m]."""
    flown = peers.Flown(flight)
    starts = peers.Starts([flown], [flown.list_starts(1.5)])
    truth = starts.truth(3.0)[:, :3]
    return starts, truth, rms(truth - starts.extend_lines(3.0))


def test_physics_recovers_gain_drag_and_delay(taught):
    found = peers.Physics.fit(taught)
    assert found.delay == DELAY
    assert np.diag(found.gain) == pytest.approx(GAIN, rel=0.1)
    assert np.count_nonzero(found.gain) == 4
    assert found.drag == pytest.approx(DRAG, rel=0.2)
    assert found.bias[2] == pytest.approx(BIAS[2], abs=0.003)
    starts, truth, coast = forecasts(fly(3))
    assert rms(found.forecast(starts, (3.0,))[3.0] - truth) < 0.2 * coast


def test_physics_learns_the_lift_of_a_flight_from_ended_forecasts(taught):
    found = peers.Physics.fit(taught)
    starts, truth, _ = forecasts(fly(3, LIFTED))
    fixed, learned = found.fly(starts, (3.0,))[3.0], found.forecast(starts, (3.0,))[3.0]
    # Nothing has ended in the first 3 s
    first = starts.time < starts.time[0] + 3.0
    assert np.array_equal(fixed[first, :3], learned[first])
    late = starts.time > 20.0
    assert rms(learned[late] - truth[late]) < 0.5 * rms(fixed[late, :3] - truth[late])


def test_ridge_beats_straight_lines(taught):
    starts, truth, coast = forecasts(fly(3))
    assert rms(peers.Ridge.fit(taught, 3.0).forecast(starts) - truth) < 0.5 * coast
