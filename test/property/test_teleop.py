# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Whatever hands, devices and estimates do: a stick wins at once; a button alone hands back."""

import math

from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import invariant, rule, RuleBasedStateMachine
from lta_bridge.teleop.steering import (
    HeadingAltitude,
    LEAD_CLIMB,
    LEAD_TURN,
    step_state,
    STOP_REQUESTS,
    TeleopOutputs,
    TeleopRates,
    TeleopStage,
    TeleopState,
)
from lta_bridge.teleop.sticks import Sticks
from lta_control.motion import wrap_angle

PERIOD = 0.02
RATES = TeleopRates()
deflections = st.one_of(st.just(0.0), st.floats(-1.0, 1.0))
hands = st.builds(
    Sticks,
    forward=deflections,
    turn=deflections,
    climb=deflections,
    take=st.booleans(),
    give_back=st.booleans(),
)
estimates = st.builds(
    HeadingAltitude, heading=st.floats(-math.pi, math.pi), altitude=st.floats(0.0, 3.0)
)


class Person(RuleBasedStateMachine):
    """A person who does anything, watched by what consumers of the orders remember."""

    def __init__(self):
        super().__init__()
        self.state, self.order, self.now = TeleopState(), TeleopOutputs(), 0.0
        self.sticks, self.felt = None, None
        self.held = self.stopped = False
        self.stops = 0

    def step(self, sticks, felt):
        self.now += PERIOD
        self.sticks, self.felt = sticks, felt
        self.state, self.order = step_state(
            self.state, self.now, PERIOD, sticks, felt, RATES, person_steers=self.held
        )
        self.stopped |= sticks is not None and sticks.stop
        self.stops += self.order.stop
        if self.order.held is not None:
            self.held = self.order.held

    @rule(sticks=hands, felt=estimates)
    def steer(self, sticks, felt):
        before = self.held
        self.step(sticks, felt)
        if not self.stopped:
            takes = sticks.is_deflected or sticks.take
            if takes:
                assert self.held, 'a stick wins at once'
            elif before and not self.held:
                assert sticks.give_back, 'only the button hands back'
            if sticks.give_back and not takes:
                assert not self.held

    @rule(sticks=st.one_of(st.none(), hands), felt=st.one_of(st.none(), estimates))
    def fail(self, sticks, felt):
        before = self.held
        self.step(sticks, felt)
        if sticks is None or felt is None:
            assert self.held == before
            assert self.order.setpoint is None

    @rule(felt=estimates)
    def start_again(self, felt):
        self.state = TeleopState()
        before, self.stopped, self.stops = self.held, False, 0
        self.step(Sticks(), felt)
        assert (self.state.stage is TeleopStage.PERSON) == before
        assert (self.order.setpoint is not None) == before

    @rule(felt=st.one_of(st.none(), estimates))
    def stop(self, felt):
        self.step(Sticks(forward=1.0, stop=True), felt)
        assert self.state.stage is TeleopStage.STOPPED

    @invariant()
    def a_setpoint_is_a_person_s_and_near_the_drone(self):
        if self.order.setpoint is None:
            return
        assert self.held
        assert not self.stopped
        assert abs(self.order.setpoint.speed) <= RATES.speed
        assert abs(wrap_angle(self.order.setpoint.heading - self.felt.heading)) <= LEAD_TURN + 1e-9
        assert abs(self.order.setpoint.altitude - self.felt.altitude) <= LEAD_CLIMB + 1e-9

    @invariant()
    def stops_are_said_only_when_asked_for_and_then_in_every_tick(self):
        assert self.stopped or not self.stops
        if self.stopped and self.stops < STOP_REQUESTS:
            assert self.order.stop


Person.TestCase.settings = settings(max_examples=60, stateful_step_count=40, deadline=None)
TestPerson = Person.TestCase


def test_an_emergency_stop_is_said_again_and_again():
    state, said = TeleopState(), []
    for k in range(500):
        sticks = Sticks(stop=k == 0)
        state, order = step_state(state, k * PERIOD, PERIOD, sticks, None, RATES)
        said.append(order.stop)
    assert all(said[:STOP_REQUESTS])
    assert 15 <= sum(said[STOP_REQUESTS:]) <= 20  # ten seconds, each half of one
