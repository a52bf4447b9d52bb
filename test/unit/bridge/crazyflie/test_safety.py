# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The state machine of the motors, order by order and time by time.

The times are literal numbers: those that docs/hardware.md states, whatever the code calls them.
"""

import math

from lta_bridge.crazyflie import readings
from lta_bridge.crazyflie.safety import (
    NO_OUTPUTS,
    SafetyInputs,
    SafetyLimits,
    SafetyOutputs,
    SafetyRequest,
    SafetyStage,
    SafetyState,
    step_state,
)
from lta_bridge.crazyflie.supervisor_word import explain_fault, SupervisorBit
import pytest

LIMITS = SafetyLimits(voltage=3.2, time=600.0, height=4.0, distance=50.0)
NOTHING, ARM, DISARM, STOP = (
    SafetyRequest(),
    SafetyRequest(arm=True),
    SafetyRequest(arm=False),
    SafetyRequest(stop=True),
)
ARMED = SafetyInputs(True, True, 2, 0.0, 0.0, 4.0, 1.0, 1.0, 0.0)
ALOFT = ARMED._replace(word=2 | 16)
ON_THE_GROUND = ARMED._replace(word=1)
FLYING = SafetyState(SafetyStage.FLYING, since=100.0, began=100.0, why='')
NO_ORDER = SafetyOutputs(arm=None, drive=0.0, stream=False, hand_over=False, stop=False)
RUN = SafetyOutputs(None, 1.0, True, False, False)


def run(state, *steps):
    """Return the stage and the order after each step, of (now, seen, asked)."""
    told = []
    for now, seen, asked in steps:
        state, order = step_state(state, now, seen, asked, LIMITS)
        told.append((state.stage, order))
    return told


def flown(now=200.0, asked=NOTHING, state=FLYING, **changed):
    """Return the stage after one tick in flight, with one thing otherwise."""
    return step_state(state, now, ALOFT._replace(**changed), asked, LIMITS)[0].stage


def test_at_rest_nothing_is_sent():
    assert NO_OUTPUTS == SafetyOutputs() == NO_ORDER
    assert run(SafetyState(), (0.0, ON_THE_GROUND, NOTHING)) == [(SafetyStage.DISARMED, NO_ORDER)]
    assert run(SafetyState(), (0.0, SafetyInputs(), ARM)) == [(SafetyStage.DISARMED, NO_ORDER)]


def test_a_request_to_arm_is_told_ten_times_a_second_until_it_is_confirmed():
    arm = NO_ORDER._replace(arm=True)
    confirmed = ARMED._replace(silence=0.01, command_age=math.inf)
    waiting = ON_THE_GROUND._replace(command_age=math.inf)
    assert run(
        SafetyState(),
        (10.0, waiting, ARM),
        (10.0625, waiting, NOTHING),
        (10.125, waiting, NOTHING),
        (10.1875, waiting, NOTHING),
        (10.25, confirmed, NOTHING),
        (10.3125, confirmed, NOTHING),
        (10.375, confirmed._replace(command_age=0.0), NOTHING),
    ) == [
        (SafetyStage.ARMING, arm),
        (SafetyStage.ARMING, NO_ORDER),
        (SafetyStage.ARMING, arm),
        (SafetyStage.ARMING, NO_ORDER),
        (SafetyStage.READY, NO_ORDER),
        (SafetyStage.READY, NO_ORDER._replace(stream=True)),  # motors still, for want of a command
        (SafetyStage.FLYING, RUN),
    ]


@pytest.mark.parametrize(
    ('after', 'stage'), [(1.0, SafetyStage.ARMING), (1.01, SafetyStage.DISARMED)]
)
def test_arming_is_given_up_after_a_second(after, stage):
    told = run(SafetyState(), (10.0, ON_THE_GROUND, ARM), (10.0 + after, ON_THE_GROUND, NOTHING))
    assert told[1][0] is stage
    assert told[1][1].arm is (stage is SafetyStage.ARMING)


@pytest.mark.parametrize('word', [2, 2 | 1])
def test_one_that_is_found_armed_is_disarmed_ten_times_a_second(word):
    found = ARMED._replace(word=word)
    disarm = NO_ORDER._replace(arm=False)
    told = run(SafetyState(), *((10.0 + 0.0625 * k, found, NOTHING) for k in range(4)))
    assert [order for _, order in told] == [disarm, NO_ORDER, disarm, NO_ORDER]


@pytest.mark.parametrize('word', [1, 2 | 16, 2 | 4])
def test_one_that_flies_or_arms_itself_is_not(word):
    """Disarmed in the air it would fall; and one that arms itself would at once again."""
    assert run(SafetyState(), (10.0, ARMED._replace(word=word), NOTHING))[0][1] == NO_ORDER


@pytest.mark.parametrize(
    ('what', 'well', 'ill'),
    [
        ('command_age', 0.3, 0.301),
        ('place_age', 0.5, 0.501),
        ('silence', 0.5, 0.501),
        ('height', 4.0, 4.001),
        ('distance', 50.0, 50.001),
        ('height', 4.0, math.nan),
        ('active', True, False),
    ],
)
def test_what_ends_a_flight_and_from_when(what, well, ill):
    assert flown(**{what: well}) is SafetyStage.FLYING
    assert flown(**{what: ill}) is SafetyStage.LANDING


def test_a_flight_lasts_as_long_as_its_limit():
    assert flown(now=700.0) is SafetyStage.FLYING
    assert flown(now=700.01) is SafetyStage.LANDING
    assert flown(asked=DISARM) is SafetyStage.LANDING


@pytest.mark.parametrize('voltage', [3.19, math.nan])
def test_a_low_cell_lands_after_three_tenths_of_a_second_on_end(voltage):
    low = ALOFT._replace(voltage=voltage)
    steps = [(200.0, low), (200.25, low), (200.26, ALOFT), (200.27, low), (200.55, low)]
    told = run(FLYING, *((now, seen, NOTHING) for now, seen in steps), (200.58, low, NOTHING))
    assert [stage for stage, _ in told] == [SafetyStage.FLYING] * 5 + [SafetyStage.LANDING]
    assert flown(voltage=3.2) is SafetyStage.FLYING


def test_a_landing_ramps_for_half_a_second_then_hands_over_and_disarms():
    end = ALOFT._replace(active=False)
    times = [0.0, 0.125, 0.25, 0.375, 0.5, 0.5625, 0.625, 0.75, 0.875, 5.0, 10.5]
    told = run(FLYING, *((200.0 + time, end, NOTHING) for time in times))
    hand_over = NO_ORDER._replace(hand_over=True)
    assert [order for _, order in told] == [
        RUN,
        RUN._replace(drive=0.75),
        RUN._replace(drive=0.5),
        RUN._replace(drive=0.25),
        hand_over,
        NO_ORDER,
        hand_over,
        hand_over,
        NO_ORDER,  # told again for 0.3 s
        NO_ORDER,
        NO_ORDER,
    ]
    assert {stage for stage, _ in told} == {SafetyStage.LANDING}
    last = step_state(SafetyState(SafetyStage.LANDING, since=200.0), 210.51, end, NOTHING, LIMITS)
    assert (last[0].stage, last[1]) == (SafetyStage.DISARMED, NO_ORDER._replace(arm=False))


@pytest.mark.parametrize('stale', [{'command_age': 0.31}, {'place_age': 0.51}])
@pytest.mark.parametrize(
    ('changed', 'asked', 'stage'),
    [
        ({}, NOTHING, SafetyStage.FLYING),
        ({'word': 16}, NOTHING, SafetyStage.LANDING),
        ({'command_age': 0.31}, NOTHING, SafetyStage.LANDING),
        ({'height': 5.0}, NOTHING, SafetyStage.LANDING),
        ({}, DISARM, SafetyStage.LANDING),
    ],
)
def test_a_hiccup_is_flown_through_within_the_ramp(stale, changed, asked, stage):
    state = step_state(FLYING, 200.0, ALOFT._replace(**stale), NOTHING, LIMITS)[0]
    assert flown(200.25, asked, state, **changed) is stage


def test_what_ended_for_another_reason_needs_a_new_request():
    state = step_state(FLYING, 200.0, ALOFT._replace(active=False), NOTHING, LIMITS)[0]
    assert flown(200.25, NOTHING, state) is SafetyStage.LANDING


def test_a_cure_that_was_refused_once_is_refused_for_good():
    state = step_state(FLYING, 200.0, ALOFT._replace(command_age=0.31), NOTHING, LIMITS)[0]
    state = step_state(state, 200.125, ALOFT, DISARM, LIMITS)[0]
    assert flown(200.25, NOTHING, state) is SafetyStage.LANDING


def test_a_stop_is_sent_ten_times_and_on_while_the_drone_says_that_it_is_armed():
    stop = NO_ORDER._replace(stop=True)
    steps = [(200.0 + k, ARMED._replace(word=0), STOP if k == 0 else ARM) for k in range(12)]
    told = run(FLYING, *steps, (212.0, ARMED, ARM), (213.0, SafetyInputs(word=2), NOTHING))
    assert [order for _, order in told] == [stop] * 10 + [NO_ORDER] * 2 + [stop, NO_ORDER]
    assert {stage for stage, _ in told} == {SafetyStage.STOPPED}


@pytest.mark.parametrize('stage', [SafetyStage.READY, SafetyStage.FLYING])
@pytest.mark.parametrize('changed', [{'linked': False}, {'word': 2 | 64}, {'word': 1}])
def test_one_that_is_gone_locked_or_disarmed_gets_no_order(stage, changed):
    state, order = step_state(
        FLYING._replace(stage=stage), 200.0, ALOFT._replace(**changed), NOTHING, LIMITS
    )
    assert (state.stage, order) == (SafetyStage.DISARMED, NO_ORDER)


@pytest.mark.parametrize(
    ('changed', 'why'),
    [
        ({}, ''),
        ({'voltage': 3.2}, ''),
        ({'silence': 0.5}, ''),
        ({'voltage': 3.19}, 'the battery has 3.19 V, less than the limit of 3.20 V: charge it'),
        (
            {'voltage': math.nan},
            'the Crazyflie has not reported its battery voltage yet: try again',
        ),
        ({'silence': 0.501}, 'the Crazyflie has sent nothing for 0.5 s'),
        ({'silence': math.inf}, 'the Crazyflie has not reported its state yet: try again'),
        ({'active': False}, 'the bridge node is not active: activate it first'),
        ({'linked': False}, 'no link'),
        ({'word': 1 | 128}, 'the Crazyflie has crashed'),
    ],
)
def test_who_may_arm(changed, why):
    state, order = step_state(SafetyState(), 10.0, ON_THE_GROUND._replace(**changed), ARM, LIMITS)
    assert state.why.startswith(why)
    assert (state.stage is SafetyStage.ARMING) == (order.arm is True) == (not why)


@pytest.mark.parametrize(
    ('changed', 'asked'),
    [
        ({}, DISARM),
        ({'silence': 0.6}, NOTHING),
        ({'active': False}, NOTHING),
        ({'height': 4.1}, NOTHING),
        ({'distance': 51.0}, NOTHING),
        ({'voltage': 3.1}, NOTHING),
    ],
)
def test_ready_is_left_when_asked_to_and_by_what_would_end_a_flight(changed, asked):
    ready = SafetyState(SafetyStage.READY, since=100.0, low_since=100.0)
    told = step_state(ready, 200.0, ARMED._replace(**changed), asked, LIMITS)
    assert (told[0].stage, told[1]) == (SafetyStage.DISARMED, NO_ORDER._replace(arm=False))


def test_ready_becomes_flying_however_long_it_stood():
    ready = SafetyState(SafetyStage.READY, since=100.0)
    state = step_state(ready, 5000.0, ARMED, NOTHING, LIMITS)[0]
    assert (state.stage, state.began) == (SafetyStage.FLYING, 5000.0)


def test_the_bits_of_the_word_are_those_of_the_firmware():
    """supervisor.c, 2026.08: the order of the fields of its bit word."""
    assert [(bit.name, int(bit)) for bit in SupervisorBit] == [
        ('CAN_BE_ARMED', 1), ('ARMED', 2), ('AUTO_ARM', 4), ('CAN_FLY', 8), ('FLYING', 16),
        ('TUMBLED', 32), ('LOCKED', 64), ('CRASHED', 128), ('HIGH_LEVEL', 256),
        ('TRAJECTORY_FINISHED', 512), ('HIGH_LEVEL_DISABLED', 1024), ('DECK_FAULT', 2048),
    ]  # fmt: skip
    assert [bool(explain_fault(1 << k)) for k in range(12)] == [False] * 5 + [True] * 3 + [
        False
    ] * 3 + [True]


@pytest.mark.parametrize(
    ('block', 'name', 'least', 'most'),
    [
        ('imu', 'acc.x', -40.0, 40.0),
        ('imu', 'gyro.z', -3000.0, 3000.0),
        ('air', 'baro.pressure', 200.0, 1300.0),
        ('attitude', 'stateEstimate.yaw', -720.0, 720.0),
        ('power', 'pm.vbat', -1.0, 30.0),
    ],
)
def test_what_lies_beyond_the_reach_of_a_sensor_was_not_measured(block, name, least, most):
    values = dict.fromkeys(readings.BLOCK_VARIABLES[block], 0.0)
    if block == 'air':
        values['baro.pressure'] = 1013.25
    for value in (least, most):
        assert readings.find_value_fault(block, {**values, name: value}) == ''
    for value in (least - 0.01, most + 0.01, math.inf, -math.inf, math.nan):
        assert f'{name} is' in readings.find_value_fault(block, {**values, name: value})


def test_at_first_nothing_is_known_asked_or_sent():
    unknown = (pytest.approx(math.nan, nan_ok=True),) * 3  # voltage, height and distance
    assert SafetyInputs() == (
        False,
        False,
        0,
        math.inf,
        math.inf,
        *unknown,
        math.inf,
        False,
        0.0,
        '',
    )
    assert SafetyRequest() == (None, False)
    assert SafetyState() == ('disarmed', 0.0, 0.0, 'not armed yet', 0, -math.inf, False, math.inf)


def test_a_cell_at_its_limit_is_not_low_and_lands_at_the_very_time():
    limit, low = ALOFT._replace(voltage=3.2), ALOFT._replace(voltage=3.19)
    flying = FLYING._replace(since=0.0, began=0.0)
    assert [stage for stage, _ in run(flying, (0.0, limit, NOTHING), (5.0, limit, NOTHING))] == [
        SafetyStage.FLYING, SafetyStage.FLYING,
    ]  # fmt: skip
    assert run(flying, (0.0, low, NOTHING), (0.3, low, NOTHING))[1][0] is SafetyStage.LANDING


def test_what_is_told_again_is_told_after_exactly_a_tenth_of_a_second():
    """Times start at zero, so that differences are exact in floating point."""
    arm, hand_over = NO_ORDER._replace(arm=True), NO_ORDER._replace(hand_over=True)
    for stage, seen, again in (
        (SafetyStage.DISARMED, ARMED, NO_ORDER._replace(arm=False)),
        (SafetyStage.ARMING, ON_THE_GROUND, arm),
        (SafetyStage.LANDING, ALOFT, hand_over),
    ):
        since = -0.5 if stage is SafetyStage.LANDING else 0.0
        state = SafetyState(stage, since=since, asked_at=0.0)
        assert step_state(state, 0.1, seen, NOTHING, LIMITS)[1] == again
        assert step_state(state, 0.099, seen, NOTHING, LIMITS)[1] == NO_ORDER


def test_a_word_as_old_as_the_request_confirms_nothing():
    state = SafetyState(SafetyStage.ARMING, since=10.0, asked_at=10.0)
    for silence, stage in ((0.125, SafetyStage.ARMING), (0.124, SafetyStage.READY)):
        seen = ARMED._replace(silence=silence)
        assert step_state(state, 10.125, seen, NOTHING, LIMITS)[0].stage is stage


def test_a_hand_over_is_told_until_eight_tenths_and_a_landing_may_end_after_six():
    landing = SafetyState(SafetyStage.LANDING, since=0.0)
    told = [
        step_state(landing, now, ALOFT, NOTHING, LIMITS)[1].hand_over for now in (0.5, 0.79, 0.8)
    ]
    assert told == [True, True, False]
    stages = [step_state(landing, now, ARMED, NOTHING, LIMITS)[0].stage for now in (0.6, 0.601)]
    assert stages == [SafetyStage.LANDING, SafetyStage.DISARMED]
