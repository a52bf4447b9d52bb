# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Strategies by name and by file."""

from dataclasses import replace
import math
from pathlib import Path

from lta_config.errors import BadInput
from lta_control.actions.tasks import TaskLimits
from lta_control.commanded_flight import CommandedFlight
from lta_control.guidance import Guidance, GuidanceInputs, ReserveReport, ReserveResponseSettings
from lta_control.mission import Mission, MissionSettings, Phase
from lta_control.motion import CascadeMeasurement
from lta_control.strategies import find_navigation_strategy, STRATEGIES
from lta_control.strategies.bearing_angle import (
    BEARING_ANGLE_STRATEGY,
    mean_bearing,
)
from lta_control.strategies.protocol import LightMeasurement, SteeringCommand
from lta_control.strategies.settings import BearingAngleSettings, StrategySettings
import pytest

EXAMPLE = Path(__file__).resolve().parents[3] / 'examples' / 'own_strategy.py'
HEAD = (
    'from lta_control.strategies.protocol import NavigationStrategy, SteeringCommand\n'
    'def start(heading):\n    return (heading,)\n'
    'def steer(settings, memory, sight):\n    return {}\n'
    "STRATEGY = NavigationStrategy('mine', start, steer)\n"
)
GOOD = 'SteeringCommand(0.1, 0.2), (0.1,)'


def test_the_example_turns_first_and_searches_on_the_side_of_the_lamp():
    strategy, settings = find_navigation_strategy(str(EXAMPLE)), StrategySettings()
    assert strategy.name == 'own_strategy'
    right = LightMeasurement(True, -0.3, 1.0, (1.0,) * 8, 0.1)
    course, memory = strategy.steer(settings, strategy.start(1.0), right)
    assert course.heading == pytest.approx(0.7)
    assert course.speed == pytest.approx(0.5 * settings.speed)  # half of the bearing at 0.6 rad
    lost, _ = strategy.steer(settings, memory, right._replace(seen=False))
    assert (lost.heading, lost.speed) == (pytest.approx(0.7 - 0.1 * settings.search_rate), 0.0)


def test_a_file_that_imports_a_strategy_is_that_strategy(tmp_path):
    path = tmp_path / 'mine.py'
    path.write_text('from lta_control.strategies.homing import HOMING_STRATEGY as STRATEGY\n')
    assert find_navigation_strategy(str(path)) == replace(
        STRATEGIES['homing'], name='mine', file=f'{path}'
    )


def test_an_edited_file_is_read_again(tmp_path):
    path = tmp_path / 'mine.py'
    path.write_text(HEAD.format(GOOD))
    sight = LightMeasurement(False, 0.0, 0.0, (0.0,) * 8, 0.1)
    steer = find_navigation_strategy(str(path)).steer
    assert steer(StrategySettings(), (0.0,), sight)[0].speed == 0.2
    path.write_text(HEAD.format('SteeringCommand(0.1, 0.25), (0.1,)'))
    steer = find_navigation_strategy(str(path)).steer
    assert steer(StrategySettings(), (0.0,), sight)[0].speed == 0.25


@pytest.mark.parametrize(
    ('text', 'said'),
    [
        ('x = (', r'cannot be run .*SyntaxError in line 1'),
        ('\nimport not_here', r'ModuleNotFoundError in line 2 \(.*not_here'),
        ('raise SystemExit', 'cannot be run'),
        ('y = 1', r"defines no strategy; .*NavigationStrategy\('mine'"),
        (HEAD.format('1'), 'returns 1 from steer'),
        (HEAD.format('(0.1, 0.2), (0.1,)'), 'returns the course'),
        (HEAD.format("SteeringCommand(float('nan'), 0.2), (0.1,)"), 'returns the course'),
        (HEAD.format('SteeringCommand(0.1, 0.2), None'), 'returns the memory None from steer'),
        (HEAD.format('settings.absent, (0.1,)'), 'fails on a trial: AttributeError in line 5'),
    ],
)
def test_what_is_no_strategy_is_refused_in_one_sentence(text, said, tmp_path):
    path = tmp_path / 'mine.py'
    path.write_text(text)
    with pytest.raises(BadInput, match=said) as refused:
        find_navigation_strategy(str(path))
    assert '\n' not in str(refused.value)


def test_a_text_that_is_not_utf_8_is_refused(tmp_path):
    path = tmp_path / 'mine.py'
    path.write_bytes(b'# coding: latin-1\n# \xfc\n' + HEAD.format(GOOD).encode())
    with pytest.raises(BadInput, match='cannot be run as a strategy: UnicodeDecodeError'):
        find_navigation_strategy(str(path))


@pytest.mark.parametrize(
    ('answer', 'commanded', 'said'),
    [
        ('1 / 0', False, r'ZeroDivisionError in line 6 \(division by zero\)'),
        ('1 / 0', True, r'ZeroDivisionError in line 6 \(division by zero\)'),
        ('exit()', False, 'SystemExit in line 6'),
        ('None', True, 'TypeError'),
        ("SteeringCommand(float('nan'), 0.2), (0.1,)", False, 'ValueError .* heading of nan rad'),
    ],
)
def test_a_failure_in_flight_is_one_sentence(answer, commanded, said, tmp_path):
    """The trial's light has a bearing of 0.5 at most."""
    head, end, _ = HEAD.partition('    return {}')
    body = f'    if sight.bearing > 1.0:\n        return {answer}\n    return {GOOD}'
    path = tmp_path / 'mine.py'
    path.write_text(head + body + HEAD.removeprefix(head + end))
    strategy = find_navigation_strategy(str(path))
    guidance = CommandedFlight(TaskLimits(), 0.3) if commanded else Guidance(None, ())
    guidance.mission = Mission()._replace(phase=Phase.SEEK, memory=(0.0,), turns=9)
    measured = CascadeMeasurement(0.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    inputs = GuidanceInputs(
        MissionSettings(), ReserveResponseSettings(), strategy, 0,
        LightMeasurement(True, 0.5, 0.0, (1.0,) * 8, 0.1), measured,
        ReserveReport(0, False, False),
    )  # fmt: skip
    assert guidance.choose_setpoint(inputs).speed in {0.0, 0.2}
    guidance.mission = guidance.mission._replace(phase=Phase.SEEK)
    with pytest.raises(BadInput, match=rf"'{path}' fails in flight: {said}.*; correct it\.$"):
        guidance.choose_setpoint(inputs._replace(sight=inputs.sight._replace(bearing=1.5)))


SETTINGS = StrategySettings(speed=0.4, search_rate=0.2)
SEEN = LightMeasurement(seen=True, bearing=-0.5, heading=2.0, amplitudes=(1.0,) * 8, interval=0.1)


def test_bag_is_known():
    assert find_navigation_strategy('bag') is BEARING_ANGLE_STRATEGY
    assert (BEARING_ANGLE_STRATEGY.arrives, BEARING_ANGLE_STRATEGY.ranges) == (False, False)


def test_bag_heads_for_the_lamp():
    course, memory = BEARING_ANGLE_STRATEGY.steer(SETTINGS, (9.0,), SEEN)
    assert course == SteeringCommand(1.5, 0.4)
    assert memory == (1.5,)


def test_bag_heads_along_the_mean_of_the_paper_on_request():
    """Cosine diodes of an even ring: their weighted mean is exact, `lta_vlc.lamp`."""
    lamp = 0.7
    seen = tuple(max(math.cos(lamp - math.tau * k / 8), 0.0) for k in range(8))
    settings = StrategySettings(bag=BearingAngleSettings(mean=True))
    course, _ = BEARING_ANGLE_STRATEGY.steer(settings, (9.0,), SEEN._replace(amplitudes=seen))
    assert course.heading == pytest.approx(2.0 + lamp)
    assert mean_bearing(seen) == pytest.approx(lamp)
