# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Progress without a terminal: a line now and then, with the time left."""

import io
from types import SimpleNamespace

from lta_report import progress_bar
from lta_report.progress_bar import ProgressBar
from lta_report.study import StudyProgress
import pytest
from rich.console import Console
from waiting import wait_until


@pytest.fixture
def clock(monkeypatch):
    clock = SimpleNamespace(now=0.0)
    monkeypatch.setattr(progress_bar.time, 'monotonic', lambda: clock.now)
    return clock


def test_a_line_says_how_far_it_is(capsys, clock):
    with ProgressBar(Console(file=io.StringIO()), begin='wind', total=4.0) as bar:
        assert capsys.readouterr().err == ''
        clock.now = 90.0
        bar.update_bar(advance=1, description='turns')
        bar.write_line()
        clock.now = 150.0
        bar.write_line()
    # A quarter took 1.5 minutes, so three quarters take 4.5
    assert capsys.readouterr().err == (
        'turns: 25 %, about 4.5 min left ...\nturns: 25 %, about 3.5 min left ...\n'
    )


def test_a_step_that_lasts_long_does_not_make_the_rest_longer(capsys, clock):
    """A tenth is done in 6 s; then a compilation lasts for minutes."""
    with ProgressBar(Console(file=io.StringIO()), begin='missions', total=1.0) as bar:
        clock.now = 6.0
        bar.update_bar(completed=0.1)
        for clock.now in (10.0, 14.0, 58.0):  # just before 60 s, the pace would say 2 s
            bar.write_line()
    said = 'missions: 10 %, about 0.8 min left ...\n' + 2 * 'missions: 10 % ...\n'
    assert capsys.readouterr().err == said


def test_a_first_step_that_compiles_tells_no_pace(capsys, clock):
    """A hundredth took ten seconds of compiling, so a pace would promise a quarter of an hour."""
    with ProgressBar(Console(file=io.StringIO()), begin='flying', total=1.0) as bar:
        clock.now = 10.0
        bar.update_bar(completed=0.01)
        bar.write_line()
    assert capsys.readouterr().err == 'flying: 1 % ...\n'


def test_what_came_before_the_whole_was_known_says_nothing_about_the_pace(capsys, clock):
    """Flights were simulated for five minutes; then a fifth of the study takes one."""
    with ProgressBar(Console(file=io.StringIO()), begin='simulating', total=None) as bar:
        clock.now = 300.0
        bar.update_bar(description='reading', total=1.0, completed=0.0)
        clock.now = 360.0
        bar.update_bar(description='fitting', completed=0.2)
        bar.write_line()
    assert capsys.readouterr().err == 'fitting: 20 %, about 4.0 min left ...\n'


def test_what_was_done_before_says_nothing_about_the_pace(capsys, clock):
    """Of ten items eight are stored; the ninth takes a minute, and so does the tenth."""
    progress = StudyProgress(Console(file=io.StringIO()), 10, unit='flights')
    progress.skip_items(8)
    with progress:
        clock.now = 60.0
        progress.count_item()
        progress.write_line()
    assert capsys.readouterr().err == 'flights: 90 %, about 1.0 min left ...\n'


def test_a_terminal_shows_the_share_of_a_first_item_and_the_time_that_has_passed(monkeypatch):
    monkeypatch.setenv('TERM', 'xterm')  # one called dumb shows no bar
    shown = io.StringIO()
    progress = StudyProgress(
        Console(file=shown, force_terminal=True, color_system=None, width=120), 4
    )
    with progress:
        progress.show_part(0.5)
    assert ' 0/4 12 % after 0:00:00 ' in shown.getvalue()


def test_a_long_step_without_an_update_is_not_silent(capsys, monkeypatch):
    monkeypatch.setattr(progress_bar, 'LINE_PERIOD', 0.01)
    said = []
    with ProgressBar(Console(file=io.StringIO()), begin='reading'):
        wait_until(
            lambda: said.append(capsys.readouterr().err) or 'reading ...' in ''.join(said),
            'a line',
        )
