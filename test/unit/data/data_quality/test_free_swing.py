"""A flight without commands is a free swing only if it is proved to be one."""

from lta_data.bag.channels import SignalChannel
from lta_data.data_quality.free_swing import explain_no_swing
from lta_data.data_quality.recording import ChannelRecording
import numpy as np
from numpy.typing import NDArray
import pytest
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]
TIME = np.arange(0.0, 25.0, 0.02)
CALM = np.zeros(len(TIME))


def record(angles: Array, place: Array) -> ChannelRecording:
    """Return a recording of a pose alone; `angles` are yaw, pitch and roll."""
    rng = np.random.default_rng(1)
    turn = Rotation.from_euler('ZYX', angles + rng.normal(0.0, 1e-3, angles.shape))
    parts = {
        'position': (place + rng.normal(0.0, 3e-4, place.shape), 'xyz'),
        'orientation': (turn.as_quat(), 'xyzw'),
    }
    channels = {
        (name := f'ground_truth/odom/pose.pose.{part}.{axis}'): SignalChannel(
            name, '', TIME, values[:, k].copy()
        )
        for part, (values, axes) in parts.items()
        for k, axis in enumerate(axes)
    }
    return ChannelRecording(channels, {'data': 'measured'})


def swing(omega: float, damping: float, held: float = 0.0) -> Array:
    """Return a decaying swing from 0.3 rad [rad], that a hand holds for a while."""
    free = np.maximum(TIME - held, 0.0)
    return np.asarray(0.3 * np.exp(-damping * free) * np.cos(omega * free))


def hang(pitch: Array, drift: float = 0.0) -> ChannelRecording:
    """Return a swing in pitch of markers 0.2 m above the axis, with a drift [m/s]."""
    place = np.column_stack([0.2 * np.sin(pitch) + drift * TIME, CALM, 2.0 + CALM])
    return record(np.column_stack([0.02 * TIME, pitch, CALM]), place)


@pytest.mark.parametrize('omega', [1.0, 2.5, 5.0])
@pytest.mark.parametrize('damping', [0.03, 0.15])
def test_a_free_swing_is_proved(omega: float, damping: float) -> None:
    assert explain_no_swing(hang(swing(omega, damping))) == ''
    assert explain_no_swing(hang(swing(omega, damping, held=4.0), drift=0.05)) == ''


@pytest.mark.parametrize('radius', [0.6, 1.2, 3.0])
def test_a_vehicle_that_flies_in_circles_travels(radius: float) -> None:
    course = 0.4 / radius * TIME
    place = radius * np.column_stack([np.sin(course), -np.cos(course), CALM]) + [0.0, 0.0, 2.0]
    angles = np.column_stack([course, 0.12 * np.sin(0.9 * TIME), 0.08 * np.sin(1.3 * TIME)])
    assert 'travels at' in explain_no_swing(record(angles, place))


def test_a_swing_that_does_not_decay_is_driven() -> None:
    assert 'energy does not decay' in explain_no_swing(hang(swing(2.0, 0.0)))
    assert 'energy does not decay' in explain_no_swing(hang(swing(2.0, -0.02)))


def test_a_vehicle_that_is_steered_about_a_hover_follows_no_pendulum() -> None:
    rng = np.random.default_rng(2)
    steps = np.repeat(rng.normal(0.0, 0.15, 25), 50)
    lagged = np.convolve(steps, np.ones(40) / 40.0, mode='same')[: len(TIME)]
    assert explain_no_swing(hang(lagged))


def test_a_flight_with_commands_needs_no_proof() -> None:
    driven = hang(CALM)
    name = 'motors/effort.left'
    channels = {**driven.channels, name: SignalChannel(name, '1', TIME, CALM + 0.3)}
    assert explain_no_swing(ChannelRecording(channels)) == ''
