"""Progress without a terminal: a line now and then, with the time left."""

import io
from types import SimpleNamespace

from lta_report import progress_bar
from lta_report.progress_bar import ProgressBar
from rich.console import Console


def test_without_a_terminal_a_line_each_minute_says_how_far_it_is(capsys, monkeypatch):
    clock = SimpleNamespace(now=0.0)
    monkeypatch.setattr(progress_bar.time, 'monotonic', lambda: clock.now)
    with ProgressBar(Console(file=io.StringIO()), begin='wind', total=4.0) as bar:
        clock.now = 59.0
        bar.update_bar(advance=1)
        assert capsys.readouterr().err == ''
        clock.now = 90.0
        bar.update_bar(description='turns')
        # A quarter took 1.5 minutes, so three quarters take 4.5
        assert capsys.readouterr().err == 'turns: 25 %, about 4.5 min left ...\n'
        bar.update_bar(advance=1)
        assert capsys.readouterr().err == ''


def test_an_unknown_amount_of_work_has_only_its_name(capsys, monkeypatch):
    monkeypatch.setattr(progress_bar, 'EVERY', 0.0)
    with ProgressBar(Console(file=io.StringIO()), begin='reading') as bar:
        bar.update_bar()
    assert capsys.readouterr().err == 'reading ...\n'
