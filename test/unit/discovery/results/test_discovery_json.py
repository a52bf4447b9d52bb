"""discovery.json has its keys, and nothing that JSON does not know."""

from dataclasses import replace
import json

from lta_discovery.finding import (
    ChannelErrors,
    Discrepancy,
    NamedEffect,
    ParameterEstimate,
    SearchCandidate,
    StudyResult,
)
from lta_discovery.flights.noisy_intervals import ExcludedInterval
from lta_discovery.results.discovery_json import common_horizon, to_dict
from lta_discovery.results.terminal import format_prediction_errors, print_finding
from lta_discovery.unmodeled.draught import DraughtEstimate
from lta_discovery.unmodeled.unexplained_force import Remainder
import pytest
from rich.console import Console

NAN = float('nan')


def _gap(channel, at, before, after, unit='m'):
    return ChannelErrors(channel, unit, at, before, 0.5 * before, after, 9.0, 0.001,
                         1.0 - after / before, (0.2, 0.4), 17, added_ci95=(0.1, 0.3))  # fmt: skip


FINDING = StudyResult(
    'named+unexplained',
    (
        NamedEffect(
            'motor_lag', ('motor_lag',),
            (ParameterEstimate('up', 's', 0.072, 0.12, (0.11, 0.13)),
             ParameterEstimate('down', 's', 0.072, 0.12, (0.11, 0.13))),
            41.0, ('command_delay.delay',),
        ),
    ),
    ((SearchCandidate('motor_lag', 22.0, 19.0, 17.0, 0.3, True),),),
    (
        Discrepancy('A', 'x', 2.0, 40.0, 'always', 9.0),
        Discrepancy('A', 'surge', 2.0, 40.0, 'speed above 0.3 m/s', 7.0),
    ),
    (
        _gap('position', 3.0, 0.2, 0.1), _gap('position', 5.0, 0.4, 0.1),
        _gap('attitude', 3.0, 0.1, 0.05, 'rad'), _gap('attitude', 5.0, 0.2, 0.05, 'rad'),
        _gap('pressure', 3.0, 2.0, 2.0, 'Pa'),
    ),
    True,
    (Remainder('yaw', 4e-4, 10.0, ('yaw rate',), 0.6),),
    ('A word.',),
    7,
    {'train': ('A',), 'confirm': ('B',), 'holdout': ('C',)},
    'gtmab',
    {'lta': '0.1.0'},
)  # fmt: skip


def test_the_keys_are_those_that_programs_rely_on():
    told = to_dict(FINDING, [ExcludedInterval('A', 'imu', 3.0, 4.0, 'Stuck.')])
    assert {'verdict', 'effects', 'where', 'gap', 'warnings', 'seed', 'versions'} <= set(told)
    assert told['verdict'] == 'named+unexplained'
    assert told['unexplained'] == []
    (effect,) = told['effects']
    assert effect['name'] == 'motor_lag'
    assert effect['confusable_with'] == ['command_delay.delay']
    assert effect['log_evidence'] == 41.0
    assert effect['parameters']['up'] == {
        'value': 0.12, 'unit': 's', 'ci95': [0.11, 0.13], 'before': 0.072,
    }  # fmt: skip
    assert set(told['where'][0]) == {
        'flight', 'channel', 'from_s', 'to_s', 'condition', 'ratio_to_noise',
    }  # fmt: skip
    assert told['left_out'] == [
        {'flight': 'A', 'channel': 'imu', 'from_s': 3.0, 'to_s': 4.0, 'reason': 'Stuck.'}
    ]


def test_a_draught_is_told_to_programs_and_people():
    assert to_dict(FINDING)['draught'] is None
    aired = replace(FINDING, draught=DraughtEstimate(1.1e-3, 2.6e-3))
    assert to_dict(aired)['draught'] == {'force': 1.1e-3, 'speed': 2.6e-3}
    console = Console(width=110, record=True, file=None, quiet=False)
    with console.capture() as heard:
        print_finding(aired, console)
    assert 'A draught: a random horizontal force of 1.1 mN, as' in heard.get()


def test_the_gap_is_of_the_position_at_the_longest_horizon_that_most_have():
    gap = to_dict(FINDING)['gap']
    assert gap['horizon_s'] == 3.0  # of 5 s there is no pressure
    assert (gap['before'], gap['tuned'], gap['after']) == (0.2, 0.1, 0.1)
    assert gap['shrink'] == pytest.approx(0.5)
    assert gap['shrink_ci95'] == [0.2, 0.4]
    assert (gap['coast'], gap['noise_floor'], gap['held_out']) == (9.0, 0.001, True)
    assert set(gap['per_channel']) == {'position', 'attitude', 'pressure'}
    assert common_horizon([one for one in FINDING.gaps if one.channel != 'pressure']) == 5.0


def test_what_is_no_number_is_null():
    place = FINDING.where[0]._replace(ratio_to_noise=NAN)
    broken = replace(FINDING, where=(place,), gaps=(_gap('position', 3.0, NAN, NAN),))
    text = json.dumps(to_dict(broken), allow_nan=False)
    assert json.loads(text)['gap']['before'] is None
    assert json.loads(text)['where'][0]['ratio_to_noise'] is None


def test_a_study_without_gaps_has_the_same_keys():
    bare = replace(FINDING, gaps=(), effects=(), where=(), remains=(), verdict='none')
    told = to_dict(bare)
    assert set(told['gap']) == set(to_dict(FINDING)['gap'])
    assert told['gap']['horizon_s'] is None


def test_the_terminal_tells_effects_gap_and_where():
    console = Console(width=110, record=True, file=None, quiet=False)
    with console.capture() as heard:
        print_finding(replace(FINDING, unexplained=('a hum',)), console)
    said = heard.get()
    for words in ('motor_lag', '0.110 to 0.130', 'command_delay.delay',
                  '50 % less than with the vehicle file (95 % interval 20 to 40 %)',
                  'speed above 0.3 m/s', 'Unexplained: a hum.', 'A word.'):  # fmt: skip
        assert words in said
    assert said.index('surge  ') < said.index('position x')


def test_an_error_that_grew_is_told_as_more():
    grown = replace(FINDING.gaps[1], shrink=-0.3, shrink_ci95=(-0.6, 0.2))
    (first, *_) = format_prediction_errors(replace(FINDING, gaps=(grown,)))
    assert '30 % more than with the vehicle file (95 % interval ' in str(first)
    assert ' to 60 %)' in str(first)
