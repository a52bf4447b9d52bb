# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The measurement effects by hand, and the core that applies them."""

import math

from lta_model.effects.commands import find_command, WRENCH_GAIN
from lta_model.effects.sensors import (
    CLOCK_OFFSET,
    CLOCK_SKEW,
    GYRO_BIAS,
    GYRO_SCALE,
    IMU_BIAS,
    PRESSURE_DRIFT,
    RANGE_OFFSET,
    TRACKER_DELAY,
    TRACKER_MISALIGNMENT,
)
from lta_model.measurement_chain import apply_chain, build_chains
import numpy as np
import pytest

DECLARED = (
    IMU_BIAS,
    GYRO_SCALE,
    GYRO_BIAS,
    PRESSURE_DRIFT,
    RANGE_OFFSET,
    TRACKER_MISALIGNMENT,
    TRACKER_DELAY,
    CLOCK_OFFSET,
    CLOCK_SKEW,
)
EFFECTS = {effect.name: effect for effect in DECLARED}


def told(given, channel, values, time=0.0):
    return apply_chain(build_chains(given, EFFECTS)[channel], values, time)


def rotated(quaternion):
    """Return the rotation matrix of a quaternion x y z w, by the textbook's other formula."""
    v, w = np.array(quaternion[:3]), quaternion[3]
    skew = np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])
    return (w * w - v @ v) * np.eye(3) + 2 * np.outer(v, v) + 2 * w * skew


def test_biases_and_drift_by_hand():
    given = {'imu_bias': {'x': 0.1, 'z': -0.2}, 'gyro_bias': {'y': 0.01}}
    assert told(given, 'force', (0.0, 0.5, 9.8)) == pytest.approx((0.1, 0.5, 9.6))
    assert told(given, 'rates', (0.3, 0.0, 0.0)) == (0.3, 0.01, 0.0)
    drift = {'pressure_drift': {'rate': 0.03}}
    assert told(drift, 'pressure', (101325.0,), 600.0) == pytest.approx((101343.0,), abs=1e-9)
    assert told({'range_offset': {'offset': -0.02}}, 'range', (1.5,)) == pytest.approx((1.48,))


def test_the_gyroscope_is_scaled_before_its_bias():
    """At rest it says its bias, whatever its scale."""
    given = {'gyro_bias': {'z': 0.02}, 'gyro_scale': {'z': 1.1}}
    assert told(given, 'rates', (0.0, 0.0, 0.0)) == (0.0, 0.0, 0.02)
    assert told(given, 'rates', (0.0, 0.0, 1.0)) == pytest.approx((0.0, 0.0, 1.12))


def test_misalignment_against_matrices():
    """R = Rz Ry Rx takes the tracker's axes to the map; both point and attitude turn back."""
    yaw, pitch, roll = 0.7, -0.2, 0.3
    c, s = math.cos, math.sin
    z = np.array([[c(yaw), -s(yaw), 0], [s(yaw), c(yaw), 0], [0, 0, 1]])
    y = np.array([[c(pitch), 0, s(pitch)], [0, 1, 0], [-s(pitch), 0, c(pitch)]])
    x = np.array([[1, 0, 0], [0, c(roll), -s(roll)], [0, s(roll), c(roll)]])
    attitude = np.array([0.1, -0.4, 0.2, 0.8])
    attitude /= np.linalg.norm(attitude)
    point = np.array([1.0, -2.0, 3.0])
    given = {'tracker_misalignment': {'yaw': yaw, 'pitch': pitch, 'roll': roll}}
    seen = told(given, 'pose', (*point, *attitude))
    back = (z @ y @ x).T
    np.testing.assert_allclose(seen[:3], back @ point, atol=1e-14)
    np.testing.assert_allclose(rotated(seen[3:]), back @ rotated(attitude), atol=1e-14)


def test_clocks_by_hand():
    given = {
        'clock_offset': {'offset': 0.2},
        'clock_skew': {'skew': 5e-5},
        'tracker_delay': {'delay': 0.03},
    }
    # After ten minutes 50 ppm are 30 ms.
    assert told(given, 'clock', (600.0,), 600.0) == pytest.approx((600.23,), abs=1e-12)
    assert told(given, 'pose_time', (600.0,), 600.0) == pytest.approx((599.97,), abs=1e-12)


# Half of a thrust that goes with the square of the command, and 0.6 of it in reverse
SQUARE = {'surge': 0.5, 'exponent_surge': 2.0, 'reverse_surge': 0.6, 'reference_surge': 0.1}


@pytest.mark.parametrize(
    ('command', 'force'), [(0.1, 0.05), (0.05, 0.0125), (-0.2, -0.12), (0, 0)]
)
def test_thrust_by_a_power_of_the_command_and_weaker_in_reverse(command, force):
    """0.5 x 0.1 N x (0.05 / 0.1)^2 = 12.5 mN; 0.6 x 0.5 x 0.1 N x 2^2 = 120 mN backwards."""
    chain = build_chains({'wrench_gain': SQUARE}, {'wrench_gain': WRENCH_GAIN})
    acting = apply_chain(chain['command_wrench'], (command, -0.3, 0.3, 0, 0, 0.01), 0.0)
    np.testing.assert_allclose(acting, (force, -0.3, 0.3, 0, 0, 0.01), rtol=1e-12)
    p = tuple(SQUARE.get(known.name, known.null) for known in WRENCH_GAIN.parameters)
    # A replay passes all commands of a flight at once
    many = WRENCH_GAIN.reading(p, tuple(np.full((6, 3), command)), 0.0)
    np.testing.assert_allclose(many[0], 3 * [force], rtol=1e-12)
    np.testing.assert_allclose(find_command(p, acting)[0], command, rtol=1e-12)


def test_a_command_acts_on_other_axes():
    """Rotors 0.2 m below the hull pitch it; jets lift by a share of a force, or of its size."""
    given = {
        'heave_from_sway': 0.5,
        'heave_from_sway_size': -0.1,
        'heave_from_yaw_size': 4.0,
        'pitch_from_surge': 0.2,
        'roll_from_sway': -0.3,
    }
    chain = build_chains({'wrench_gain': given}, {'wrench_gain': WRENCH_GAIN})
    acting = apply_chain(chain['command_wrench'], (0.1, -0.05, 0.02, 0, 0.001, -0.003), 0.0)
    # Heave: 0.02 - 0.5 x 0.05 - 0.1 x 0.05 + 4 x 0.003
    wanted = (0.1, -0.05, 0.002, 0.015, 0.021, -0.003)
    np.testing.assert_allclose(acting, wanted, rtol=1e-12)
