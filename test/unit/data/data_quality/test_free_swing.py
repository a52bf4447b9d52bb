# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A flight without commands is a free swing only if it is proved to be one."""

from lta_data.data_quality.free_swing import explain_no_swing
from lta_data.flight import Channel, Flight
import numpy as np
from numpy.typing import NDArray
import pytest
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]
TIME = np.arange(0.0, 25.0, 0.02)
CALM = np.zeros(len(TIME))


def record(angles: Array, place: Array) -> Flight:
    """Return a recording of a pose alone; `angles` are yaw, pitch and roll."""
    rng = np.random.default_rng(1)
    turn = Rotation.from_euler('ZYX', angles + rng.normal(0.0, 1e-3, angles.shape))
    parts = {
        'position': (place + rng.normal(0.0, 3e-4, place.shape), 'xyz'),
        'orientation': (turn.as_quat(), 'xyzw'),
    }
    channels = {
        (name := f'ground_truth/odom/pose.pose.{part}.{axis}'): Channel(
            name, '', TIME, values[:, k].copy()
        )
        for part, (values, axes) in parts.items()
        for k, axis in enumerate(axes)
    }
    return Flight(channels, {'data': 'measured'})


def swing(omega: float, damping: float, held: float = 0.0) -> Array:
    """Return a decaying swing from 0.3 rad [rad], that a hand holds for a while."""
    free = np.maximum(TIME - held, 0.0)
    return np.asarray(0.3 * np.exp(-damping * free) * np.cos(omega * free))


def hang(pitch: Array, drift: float = 0.0) -> Flight:
    """Return a swing in pitch of markers 0.2 m above the axis, with a drift [m/s]."""
    place = np.column_stack([0.2 * np.sin(pitch) + drift * TIME, CALM, 2.0 + CALM])
    return record(np.column_stack([0.02 * TIME, pitch, CALM]), place)


@pytest.mark.parametrize('omega', [1.0, 2.5, 5.0])
@pytest.mark.parametrize('damping', [0.03, 0.15])
def test_a_free_swing_is_proved(omega: float, damping: float) -> None:
    assert explain_no_swing(hang(swing(omega, damping))) == ''
    assert explain_no_swing(hang(swing(omega, damping, held=4.0), drift=0.05)) == ''


def test_a_swing_of_both_axes_seen_by_a_poor_tracker_is_proved() -> None:
    rng = np.random.default_rng(4)
    angles = np.column_stack([CALM, swing(2.0, 0.05), 0.6 * swing(2.7, 0.08)])
    angles += rng.normal(0.0, 0.01, angles.shape)
    place = 0.2 * np.column_stack([np.sin(angles[:, 1]), -np.sin(angles[:, 2]), CALM])
    assert explain_no_swing(record(angles, place + rng.normal(0.0, 3e-3, place.shape))) == ''


@pytest.mark.parametrize(
    ('radius', 'speed'), [(0.3, 0.1), (0.3, 0.4), (0.6, 0.2), (1.2, 0.4), (3.0, 0.4)]
)
@pytest.mark.parametrize('damping', [0.0, 0.1])
def test_a_vehicle_that_flies_in_circles_is_driven(
    radius: float, speed: float, damping: float
) -> None:
    course = speed / radius * TIME
    place = radius * np.column_stack([np.sin(course), -np.cos(course), CALM]) + [0.0, 0.0, 2.0]
    fade = np.exp(-damping * TIME)
    angles = np.column_stack(
        [course, 0.12 * np.sin(1.9 * TIME) * fade, 0.08 * np.sin(1.9 * TIME) * fade]
    )
    assert 'no free swing' in explain_no_swing(record(angles, place))


def test_a_swing_that_is_twice_is_driven() -> None:
    twice = swing(2.0, 0.1) + 0.15 * np.where(TIME > 12.0, swing(2.0, 0.1, 12.0) / 0.3, 0.0)
    assert 'energy grows' in explain_no_swing(hang(twice))


def test_a_vehicle_that_climbs_or_leaves_travels() -> None:
    assert 'travels at' in explain_no_swing(hang(swing(2.0, 0.1), drift=0.3))


def test_a_large_tilt_late_in_a_flight_is_no_release() -> None:
    assert 'comes late' in explain_no_swing(hang(0.2 * swing(2.0, 0.0) + swing(2.0, 0.1, 17.0)))


def test_commands_without_a_number_are_no_commands() -> None:
    driven = hang(CALM)
    name = 'motors/effort.left'
    channels = {**driven.channels, name: Channel(name, '1', TIME, CALM * np.nan)}
    assert explain_no_swing(Flight(channels))


def test_a_swing_that_does_not_decay_is_driven() -> None:
    assert 'energy does not decay' in explain_no_swing(hang(swing(2.0, 0.0)))
    assert 'comes late' in explain_no_swing(hang(swing(2.0, -0.02)))


def test_a_vehicle_that_is_steered_about_a_hover_follows_no_pendulum() -> None:
    rng = np.random.default_rng(2)
    steps = np.repeat(rng.normal(0.0, 0.15, 25), 50)
    lagged = np.convolve(steps, np.ones(40) / 40.0, mode='same')[: len(TIME)]
    assert explain_no_swing(hang(lagged))


def test_a_flight_with_commands_needs_no_proof() -> None:
    driven = hang(CALM)
    name = 'motors/effort.left'
    channels = {**driven.channels, name: Channel(name, '1', TIME, CALM + 0.3)}
    assert explain_no_swing(Flight(channels)) == ''
