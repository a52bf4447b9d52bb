# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""No sequence of events lets motors turn without arming, its confirmation and fresh commands."""

import math

from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.stateful import invariant, rule, RuleBasedStateMachine
from lta_bridge.crazyflie.safety import (
    LOST_POSITION,
    LOW_VOLTAGE_TIME,
    RAMP,
    SafetyInputs,
    SafetyLimits,
    SafetyOutputs,
    SafetyRequest,
    SafetyStage,
    SafetyState,
    SILENT_LINK,
    STALE,
    step_state,
)
from lta_bridge.crazyflie.supervisor_word import explain_fault, SupervisorBit
import pytest

PERIOD = 0.02
LIMITS = SafetyLimits(voltage=3.2, time=600.0, height=4.0, distance=50.0)

words = st.sampled_from(
    [
        0,
        SupervisorBit.CAN_BE_ARMED,
        SupervisorBit.ARMED,
        SupervisorBit.ARMED | SupervisorBit.FLYING,
        SupervisorBit.LOCKED,
        SupervisorBit.TUMBLED,
        SupervisorBit.CRASHED,
    ]
)
ages = st.one_of(st.floats(0.0, 1.0), st.just(math.inf))
seen = st.builds(
    SafetyInputs,
    linked=st.booleans(),
    active=st.booleans(),
    word=words,
    silence=ages,
    command_age=ages,
    voltage=st.one_of(st.floats(2.5, 4.2), st.just(math.nan)),
    height=st.one_of(st.floats(0.0, 8.0), st.just(math.nan)),
    distance=st.one_of(st.floats(0.0, 100.0), st.just(math.nan)),
    place_age=ages,
    blind=st.booleans(),
    rivals=st.sampled_from(['', '', '', 'a stranger']),
)
asked = st.builds(SafetyRequest, arm=st.sampled_from([None, True, False]), stop=st.booleans())
FIT = SafetyInputs(True, True, int(SupervisorBit.ARMED), 0.0, 0.0, 4.0, 1.0, 1.0, 0.0)


class Bridge(RuleBasedStateMachine):
    """The bridge under whatever may happen, watched by what must never."""

    def __init__(self):
        super().__init__()
        self.state, self.order, self.now, self.seen = (
            SafetyState(),
            SafetyOutputs(),
            0.0,
            SafetyInputs(),
        )
        self.asked_to_arm = self.confirmed = self.stopped = False
        self.fresh_at = -math.inf
        self.drive = 0.0

    def step(self, seen, asked, dt=PERIOD):
        self.now += dt
        before, self.drive = self.state, self.order.drive
        self.asked_to_arm |= bool(asked.arm)
        self.stopped |= asked.stop
        self.fresh_at = max(self.fresh_at, self.now - seen.command_age)
        self.state, self.order = step_state(self.state, self.now, seen, asked, LIMITS)
        self.seen = seen
        if before.stage is SafetyStage.ARMING and self.state.stage is SafetyStage.READY:
            self.confirmed = bool(seen.word & SupervisorBit.ARMED)
        if self.state.stage is SafetyStage.DISARMED:
            self.confirmed = False

    @rule(seen=seen, asked=asked, dt=st.floats(0.001, 3.0))
    def anything(self, seen, asked, dt):
        self.step(seen, asked, dt)

    @rule(count=st.integers(1, 60), age=st.floats(0.0, 0.2))
    def a_good_flight(self, count, age):
        self.step(FIT, SafetyRequest(arm=True))
        for _ in range(count):
            self.step(FIT._replace(command_age=age), SafetyRequest())

    @rule(part=seen)
    def a_first_command_in_whatever_trouble(self, part):
        waiting = FIT._replace(command_age=math.inf)
        for asked in (SafetyRequest(arm=True), SafetyRequest()):
            self.step(waiting, asked)
        self.step(
            part._replace(linked=True, word=int(SupervisorBit.ARMED), command_age=0.0),
            SafetyRequest(),
        )

    @rule(count=st.integers(1, 80), part=seen)
    def commands_stop(self, count, part):
        for turn in range(count):
            self.step(part._replace(command_age=STALE + turn * PERIOD), SafetyRequest())

    @invariant()
    def motors_turn_only_when_they_may(self):
        order = self.order
        if order.drive == 0.0:
            return
        assert self.asked_to_arm
        assert self.confirmed
        assert not self.stopped
        assert self.seen.linked
        assert not explain_fault(self.seen.word)
        assert self.state.stage in (SafetyStage.FLYING, SafetyStage.LANDING)
        assert order.stream
        if self.state.stage is SafetyStage.FLYING:
            assert self.seen.command_age <= STALE
            self.knows_the_position_or_may_fly_blind()
            assert self.seen.word & SupervisorBit.ARMED
            assert self.seen.active
            assert self.seen.silence <= SILENT_LINK
            assert not self.seen.rivals

    def knows_the_position_or_may_fly_blind(self):
        seen = self.seen
        if seen.blind and math.isinf(seen.place_age):
            return
        assert seen.place_age <= LOST_POSITION
        assert math.isfinite(seen.height)
        assert math.isfinite(seen.distance)

    @invariant()
    def a_ramp_only_falls(self):
        if self.state.stage is SafetyStage.LANDING and self.order.drive:
            assert self.order.drive <= self.drive or self.state.since == self.now

    @invariant()
    def nothing_is_armed_that_nobody_asked_for(self):
        if not self.asked_to_arm:
            assert self.order.arm is not True
            assert self.state.stage in (SafetyStage.DISARMED, SafetyStage.STOPPED)

    @invariant()
    def a_stop_is_for_good(self):
        if self.stopped:
            assert self.state.stage is SafetyStage.STOPPED
            assert not self.order.stream
            assert self.order.arm is None


TestBridge = Bridge.TestCase
TestBridge.settings = settings(max_examples=60, stateful_step_count=25, deadline=None)


@given(seen=seen, gap=st.floats(0.0, 0.1))
@settings(max_examples=200)
def test_stale_commands_end_in_rest_within_the_ramp(seen, gap):
    """Whatever else is known, the drive is gone when the newest command is this old."""
    state = SafetyState(SafetyStage.FLYING)
    now = 0.0
    while now < STALE + RAMP + 2 * PERIOD + gap:
        state, order = step_state(
            state, now, seen._replace(command_age=now), SafetyRequest(), LIMITS
        )
        now += PERIOD
    assert order.drive == 0.0


def flying():
    return SafetyState(SafetyStage.FLYING, began=0.0)


@given(
    seen=seen, stage=st.sampled_from([SafetyStage.READY, SafetyStage.FLYING, SafetyStage.DISARMED])
)
@settings(max_examples=200)
def test_no_drone_is_armed_or_flown_without_height_and_position(seen, stage):
    for change in ({'height': math.nan}, {'distance': math.nan}, {'place_age': math.inf}):
        # Chance seldom draws inputs of which nothing else forbids to fly
        for part in (seen, FIT):
            lost = part._replace(blind=False, **change)
            state, order = step_state(
                SafetyState(stage, asked_at=0.0), 1.0, lost, SafetyRequest(arm=True), LIMITS
            )
            assert state.stage not in (SafetyStage.FLYING, SafetyStage.ARMING)
            assert order.arm is not True


@given(seen=seen, drive=st.booleans())
def test_no_motor_begins_to_turn_while_nobody_tells_the_place(seen, drive):
    for part in (seen, FIT):
        state = SafetyState(SafetyStage.FLYING if drive else SafetyStage.READY)
        state, _ = step_state(
            state, 0.0, part._replace(place_age=LOST_POSITION + 0.01), SafetyRequest(), LIMITS
        )
        assert state.stage is not SafetyStage.FLYING


def landed_after(voltages):
    """Return after how long the voltages told ten times a second end a flight; None if never."""
    state, each = flying(), round(0.1 / PERIOD)
    for turn in range(len(voltages) * each):
        now = turn * PERIOD
        seen = FIT._replace(voltage=voltages[turn // each])
        state, _ = step_state(state, now, seen, SafetyRequest(), LIMITS)
        if state.stage is SafetyStage.LANDING:
            assert state.why.startswith('the battery has')
            return now
    return None


@given(st.lists(st.floats(-1e3, 3.1), min_size=1, max_size=3), st.integers(0, 20))
def test_a_cell_that_is_told_low_for_a_moment_is_flown_on_with(low, before):
    assert landed_after([4.0] * before + low + [4.0] * 10) is None


@given(st.lists(st.floats(-1e3, 3.1), min_size=5, max_size=20))
def test_a_cell_that_stays_low_lands_in_time(low):
    assert landed_after(low) == pytest.approx(LOW_VOLTAGE_TIME, abs=1.01 * PERIOD)
