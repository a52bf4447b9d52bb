"""Progress without a terminal: a line now and then, with the time left."""

import io
from types import SimpleNamespace

from lta_report import progress_bar
from lta_report.progress_bar import ProgressBar
from rich.console import Console
from waiting import wait_until


def test_a_line_says_how_far_it_is(capsys, monkeypatch):
    clock = SimpleNamespace(now=0.0)
    monkeypatch.setattr(progress_bar.time, 'monotonic', lambda: clock.now)
    with ProgressBar(Console(file=io.StringIO()), begin='wind', total=4.0) as bar:
        assert capsys.readouterr().err == ''
        bar.update_bar(advance=1, description='turns')
        clock.now = 90.0
        bar.write_line()
    # A quarter took 1.5 minutes, so three quarters take 4.5
    assert capsys.readouterr().err == 'turns: 25 %, about 4.5 min left ...\n'


def test_a_long_step_without_an_update_is_not_silent(capsys, monkeypatch):
    monkeypatch.setattr(progress_bar, 'EVERY', 0.01)
    said = []
    with ProgressBar(Console(file=io.StringIO()), begin='reading'):
        wait_until(
            lambda: said.append(capsys.readouterr().err) or 'reading ...' in ''.join(said),
            'a line',
        )
