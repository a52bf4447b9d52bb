# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What the pilot's sticks do, and that a gamepad with these axes is read as those sticks."""

from itertools import islice
import math
from types import SimpleNamespace

from hypothesis import given
from hypothesis import strategies as st
from lta_bridge.parameters import PilotSettings
from lta_bridge.teleop import stick_plan
from lta_bridge.teleop.stick_plan import HIGHEST_RISE, limit_climb, plan_pieces, StickFlight
from lta_bridge.teleop.sticks import from_sticks, GamepadLayout, Sticks, to_sticks
from lta_control.odometry.tracked_motion import TrackedMotion
import pytest
from sensor_msgs.msg import Joy

DEFLECTION = st.floats(-1.0, 1.0).filter(lambda value: value == 0.0 or abs(value) > 1e-3)


@given(DEFLECTION, DEFLECTION, DEFLECTION, st.booleans(), st.booleans())
def test_a_joy_message_carries_the_sticks(forward, turn, climb, take, give_back):
    layout, sticks = GamepadLayout(), Sticks(forward, turn, climb, take, give_back)
    axes, buttons = from_sticks(layout, sticks)
    heard = Joy(axes=axes, buttons=buttons)  # which rounds to single precision
    got = to_sticks(layout, heard.axes, heard.buttons)
    assert got[:3] == pytest.approx(sticks[:3], abs=1e-6)
    assert got[3:] == sticks[3:]
    # At rest a stick is exactly at rest: else it would take control
    assert [value == 0.0 for value in got[:3]] == [value == 0.0 for value in sticks[:3]]


@pytest.mark.parametrize('seconds', [0.5, 9.0, 30.0, 60.0, 200.0])
def test_the_pieces_of_a_flight_take_its_time(seconds):
    holds = [hold for piece in plan_pieces(seconds, 1) for hold in piece]
    assert sum(hold.seconds for hold in holds) == pytest.approx(seconds)
    assert all(hold.seconds > 0.0 for hold in holds)


def test_each_axis_moves_alone_first_and_then_all_move():
    moved = [
        {k for hold in piece for k, value in enumerate(hold.sticks[:3]) if value}
        for piece in plan_pieces(120.0, 1)
    ]
    assert moved[:3] == [{0}, {1}, {2}]
    assert all(len(each) > 1 for each in moved[3:-1])
    # Two flights differ, so that one can confirm the other
    assert list(islice(plan_pieces(60.0, 1), 4)) != list(islice(plan_pieces(60.0, 2), 4))


def test_a_drone_far_from_its_height_climbs_no_further():
    up, down = Sticks(forward=1.0, climb=1.0), Sticks(climb=-0.5)
    far = HIGHEST_RISE + 0.01
    assert limit_climb(up, far) == Sticks(forward=1.0)
    assert limit_climb(up, -far) == limit_climb(up, HIGHEST_RISE) == up
    assert limit_climb(down, -far) == Sticks()
    assert limit_climb(down, far) == down


class Room:
    """A flight that stands still where a test puts it, on a clock that each step advances."""

    def __init__(self, monkeypatch, x=0.0):
        self.now, self.x, self.commands = 100.0, x, []
        monkeypatch.setattr(stick_plan, 'time', SimpleNamespace(monotonic=lambda: self.now))
        settings = PilotSettings(seconds=9.0, room=6.0)
        self.flight = StickFlight(settings, self.command, lambda what: None)
        self.pushed = 0

    def command(self, name):
        self.commands.append(name)
        yield
        return ''

    def end(self, tracked_until=math.inf):
        """Fly to the end, with teleop that follows; return why it failed."""
        steps = self.flight.fly()
        while True:
            if self.now < tracked_until:
                place = TrackedMotion(0, (self.x, 0.0), 0.0, (0.0, 0.0))
                self.flight.receive_tracking(place, 1.2)
            try:
                next(steps)
            except StopIteration as end:
                return end.value
            sticks = self.flight.sticks
            self.pushed += sticks.is_deflected
            self.flight.held = not sticks.give_back and (self.flight.held or sticks.take)
            self.now += 0.1


def test_a_flight_of_one_piece_returns_and_lands(monkeypatch):
    room = Room(monkeypatch)
    assert room.end() == ''
    assert room.commands == ['take_off', 'go_to_pose', 'go_to_pose', 'land']
    assert room.pushed >= 59  # six seconds ahead
    assert not room.flight.held


def test_without_the_tracker_the_sticks_go_back_and_it_lands(monkeypatch):
    room = Room(monkeypatch)
    assert room.end(tracked_until=102.0) == 'the tracker is lost'
    assert room.now < 105.0
    assert room.commands[-1] == 'land'
    assert not room.flight.held


def test_where_it_could_leave_the_room_it_returns_at_once(monkeypatch):
    room = Room(monkeypatch, x=3.1)
    assert room.end() == ''
    assert room.pushed == 0
    assert room.commands == ['take_off', 'go_to_pose', 'go_to_pose', 'land']
