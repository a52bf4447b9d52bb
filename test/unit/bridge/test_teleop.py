# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Gamepads, keyboards and Joy messages as sticks, and what a full deflection does."""

import os
import struct

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from geometry_msgs.msg import TwistStamped, Vector3
from hypothesis import given
from hypothesis import strategies as st
from lta_bridge.teleop.messages import JoyDevice, SetpointFollowers, SILENT_SENDER, TwistDevice
from lta_bridge.teleop.steering import (
    HeadingAltitude,
    LEAD_TURN,
    step_state,
    TeleopRates,
    TeleopState,
)
from lta_bridge.teleop.sticks import (
    apply_dead_zone,
    Gamepad,
    GamepadLayout,
    KEY_HOLD,
    Keyboard,
    Sticks,
    to_sticks,
)
from lta_config.errors import BadInput
from lta_graph.ros.stamps import to_stamp
import pytest
from sensor_msgs.msg import Joy

LAYOUT = GamepadLayout()
REST = Sticks()


def test_a_second_of_full_deflection_is_what_the_rates_say():
    state, rates, felt = (
        TeleopState(),
        TeleopRates(speed=0.4, turn=0.5, climb=0.3),
        HeadingAltitude(1.0, 1.5),
    )
    for k in range(50):
        state, order = step_state(state, 0.02 * k, 0.02, Sticks(1.0, 1.0, 1.0), felt, rates)
    assert order.held
    assert order.setpoint == pytest.approx((1.8, 1.5, 0.4))
    for k in range(500):
        state, order = step_state(state, 1 + 0.02 * k, 0.02, Sticks(turn=1.0), felt, rates)
    assert order.setpoint.heading == pytest.approx(1.0 + LEAD_TURN)


def test_who_comes_back_begins_where_the_drone_is():
    _, order = step_state(
        TeleopState(), 0.0, 0.02, Sticks(take=True), HeadingAltitude(1.0, 1.5), TeleopRates()
    )
    held, _ = step_state(
        TeleopState(), 0.0, 0.02, Sticks(take=True), HeadingAltitude(1.0, 1.5), TeleopRates()
    )
    silent, nothing = step_state(held, 1.0, 0.02, None, HeadingAltitude(1.0, 1.4), TeleopRates())
    assert (nothing.held, nothing.setpoint) == (None, None)
    _, order = step_state(silent, 2.0, 0.02, REST, HeadingAltitude(2.0, 1.2), TeleopRates())
    assert order.setpoint == pytest.approx((1.2, 2.0, 0.0))


@pytest.mark.parametrize(
    ('raw', 'told'),
    [(0.05, 0.0), (-0.1, 0.0), (0.55, 0.5), (-1.0, -1.0), (3.0, 1.0), (float('nan'), 0.0)],
)
def test_the_play_about_the_rest_counts_as_none(raw, told):
    assert apply_dead_zone(raw, 0.1) == pytest.approx(told)


def test_another_gamepad_than_the_layout_s_is_none():
    assert to_sticks(LAYOUT, [0.0] * 2, [0] * 8) is None
    assert to_sticks(LAYOUT, [0.0] * 8, [0]) is None


def test_joy_messages_count_while_they_come():
    device = JoyDevice(LAYOUT)
    assert device.read_sticks(0.0) is None
    axes = [0.0] * 6
    axes[LAYOUT.turn] = 1.0
    device.receive(Joy(axes=axes, buttons=[0, 1, 0]), 1.0)
    assert device.read_sticks(1.0 + SILENT_SENDER) == Sticks(turn=1.0, give_back=True)
    assert device.read_sticks(1.01 + SILENT_SENDER) is None


def test_a_tap_between_two_looks_counts_once_by_joy():
    device = JoyDevice(LAYOUT)
    for at, stop in ((1.0, 0), (1.001, 1), (1.002, 0)):
        device.receive(Joy(axes=[0.0] * 6, buttons=[0, 0, stop]), at)
    assert device.read_sticks(1.02) == Sticks(stop=True)
    assert device.read_sticks(1.04) == REST


NOW_NS = 50_000_000_000


def send_velocity(device, now, frame='', stamp_ns=0, **linear):
    """Let a device get a velocity, with a turn of 0.3 rad/s to the left."""
    message = TwistStamped()
    message.header.frame_id, message.header.stamp = frame, to_stamp(stamp_ns)
    message.twist.linear = Vector3(**linear)
    message.twist.angular.z = 0.3
    device.receive(message, now, NOW_NS)


def test_a_velocity_is_a_share_of_the_largest_and_has_control_while_messages_come():
    rates = TeleopRates(speed=0.4, turn=0.6, climb=0.2)
    device = TwistDevice(lambda: rates, ('', 'base_link'))
    assert device.read_sticks(0.0) is None
    send_velocity(device, 1.0, x=0.1, y=0.7, z=-5.0)
    assert device.read_sticks(1.0) == Sticks(0.25, 0.5, -1.0, take=True)
    assert device.read_sticks(0.99 + SILENT_SENDER) is not None
    assert device.read_sticks(1.0 + SILENT_SENDER) is None


@pytest.mark.parametrize(
    ('how', 'why'),
    [
        ({'x': float('nan')}, 'cmd_vel: '),
        ({'frame': 'odom'}, "cmd_vel: in the frame 'odom', not base_link"),
        ({'stamp_ns': NOW_NS - 600_000_000}, 'cmd_vel: its stamp is 0.6 s old'),
        ({'stamp_ns': NOW_NS + 10_000_000_000}, 'cmd_vel: its stamp is inf s old'),
    ],
)
def test_a_velocity_that_cannot_be_followed_counts_as_none_and_is_counted(how, why):
    device = TwistDevice(TeleopRates, ('', 'base_link'))
    send_velocity(device, 1.0, **how)
    assert device.read_sticks(1.0) is None
    assert device.unsound.count == 1
    assert device.unsound.why.startswith(why)
    send_velocity(device, 1.1, 'base_link', NOW_NS - 400_000_000)
    assert device.read_sticks(1.1) is not None


numbers = st.one_of(st.floats(width=32), st.sampled_from([-1.0, 0.0, 1.0]))


@given(
    st.lists(numbers, max_size=70),
    st.lists(st.integers(-(2**31), 2**31 - 1), max_size=70),
)
def test_any_joy_message_is_hands_at_rest_or_in_range_or_a_dead_device_and_counted(axes, buttons):
    device = JoyDevice(LAYOUT)
    device.receive(Joy(axes=axes, buttons=buttons), 0.0)
    sticks = device.read_sticks(0.0)
    fits = len(axes) > 4 and len(buttons) > 2  # the largest numbers of the layout
    assert (sticks is not None) == fits
    sound = fits and all(abs(axis) <= 1e9 for axis in axes)
    assert device.unsound.count == (not sound)
    if sticks is not None:
        assert all(-1.0 <= each <= 1.0 for each in sticks[:3])
        assert sticks.stop == (buttons[LAYOUT.stop] == 1)


def test_a_stop_counts_though_the_axes_are_no_numbers():
    device = JoyDevice(LAYOUT)
    device.receive(Joy(axes=[float('nan')] * 6, buttons=[0, 0, 1]), 0.0)
    assert device.read_sticks(0.0) == Sticks(stop=True)
    assert device.unsound.count == 1


def test_who_flies_by_whom_is_read_from_the_health_of_this_drone_s_nodes():
    def told(name, robot='lta1', **values):
        pairs = [KeyValue(key=key, value=value) for key, value in values.items()]
        status = DiagnosticStatus(name=name, hardware_id=robot, values=pairs)
        return DiagnosticArray(status=[status])

    flyers = SetpointFollowers('/lta1')
    for other in (told('teleop: helm'), told('controller: helm', 'lta2', held='True')):
        flyers.add_diagnostics(other)
        assert flyers.is_operator_steering is None
    flyers.add_diagnostics(told('controller: helm', held='False'))
    assert flyers.is_operator_steering is False
    flyers.add_diagnostics(told('crazyflie_bridge: helm', held='True'))
    assert flyers.is_operator_steering is True


def test_a_gamepad_is_read_and_its_loss_is_noticed(tmp_path):
    """Events as joystick-api.rst lays them out; the far end of a pipe is the kernel."""
    path = tmp_path / 'js0'
    os.mkfifo(path)
    device = Gamepad(path, LAYOUT)
    kernel = os.open(path, os.O_WRONLY)

    def event(value, kind, number):
        os.write(kernel, struct.pack('<IhBB', 0, value, kind, number))

    for axis in range(8):
        event(0, 0x82, axis)
    for button in range(11):
        event(0, 0x81, button)
    assert device.read_sticks(0.0) == REST
    event(-32767, 0x02, LAYOUT.forward)  # up
    event(1, 0x01, LAYOUT.stop)
    assert device.read_sticks(0.1) == Sticks(forward=1.0, stop=True)
    os.close(kernel)
    assert device.read_sticks(0.2) is None
    path.unlink()
    assert device.read_sticks(5.0) is None
    device.close()


def test_a_tap_between_two_looks_counts_once_by_gamepad_though_the_plug_is_pulled(tmp_path):
    path = tmp_path / 'js0'
    os.mkfifo(path)
    device = Gamepad(path, LAYOUT)
    kernel = os.open(path, os.O_WRONLY)
    tap = struct.pack('<IhBBIhBB', 10, 1, 0x01, LAYOUT.stop, 15, 0, 0x01, LAYOUT.stop)
    os.write(kernel, b''.join(struct.pack('<IhBB', 0, 0, 0x82, axis) for axis in range(8)))
    os.write(kernel, struct.pack('<IhBB', 0, 0, 0x81, 10) + tap)
    assert device.read_sticks(0.0) == Sticks(stop=True)
    assert device.read_sticks(0.02) == REST
    os.write(kernel, tap)
    os.close(kernel)
    assert device.read_sticks(0.04) == Sticks(stop=True)
    assert device.read_sticks(0.06) is None
    device.close()


def test_a_gamepad_that_is_not_there_is_told_in_a_sentence(tmp_path):
    with pytest.raises(BadInput, match='no gamepad at'):
        Gamepad(tmp_path / 'js0', LAYOUT)


def test_keys_count_while_they_are_held():
    person, terminal = os.openpty()
    device = Keyboard(terminal)
    assert device.read_sticks(0.0) == REST
    os.write(person, b'wA')
    assert device.read_sticks(1.0) == Sticks(forward=1.0, turn=1.0)
    os.write(person, b'wf')
    assert device.read_sticks(1.5) == Sticks(forward=1.0, turn=1.0, climb=-1.0)
    assert device.read_sticks(1.5 + 0.9 * KEY_HOLD) == Sticks(forward=1.0, climb=-1.0)
    assert device.read_sticks(1.5 + KEY_HOLD) == REST
    for key, told in ((b' ', 'take'), (b'b', 'give_back'), (b'x', 'stop')):
        os.write(person, key)
        assert device.read_sticks(9.0) == Sticks(**{told: True})
        assert device.read_sticks(9.01) == REST
    os.close(person)
    assert device.read_sticks(9.1) is None
    device.close()
    os.close(terminal)


@pytest.mark.parametrize(
    'key',
    [
        b'\x1b[A', b'\x1b[B', b'\x1b[C', b'\x1b[D',  # arrows
        b'\x1bOB', b'\x1bOS', b'\x1bOX',  # arrows and keypad in application mode, F4
        b'\x1b[F', b'\x1b[3~', b'\x1b[15~', b'\x1b[1;2B', b'\x1b[[A',  # End, Delete, F5, F1
    ],
)  # fmt: skip
def test_keys_that_come_as_an_escape_mean_nothing_torn_or_whole(key):
    person, terminal = os.openpty()
    device = Keyboard(terminal)
    for cut in range(len(key)):
        os.write(person, key[:cut])
        assert device.read_sticks(2.0 * cut) == REST, key[:cut]
        os.write(person, key[cut:] + b'\x1b[Bw\x1b[A')
        assert device.read_sticks(2.0 * cut + 0.02) == Sticks(forward=1.0), key[:cut]
    for fd in (person, terminal):
        os.close(fd)


def test_an_escape_alone_holds_no_key_back():
    person, terminal = os.openpty()
    device = Keyboard(terminal)
    for typed in (b'\x1bx', b'\x1b\x1bx'):
        os.write(person, typed)
        assert device.read_sticks(1.0) == Sticks(stop=True)
    for typed in (b'\x1b', b'\x1b[', b'\x1bO'):
        os.write(person, typed)
        assert device.read_sticks(2.0) == REST
        assert device.read_sticks(2.02) == REST
        os.write(person, b'x')
        assert device.read_sticks(2.04) == Sticks(stop=True)
    for fd in (person, terminal):
        os.close(fd)


def test_without_a_terminal_there_are_no_keys(tmp_path):
    with (tmp_path / 'file').open('w+b') as file, pytest.raises(BadInput, match='a terminal'):
        Keyboard(file.fileno())
