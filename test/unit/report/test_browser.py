"""How long a browser is waited for: by what it says, without a browser and without waiting."""

import re

from lta_config.errors import BadInput
from lta_report import browser
from lta_report.browser import Browser
import pytest


class Clock:
    """A clock that a sleep moves on by five seconds."""

    now = 0.0

    def monotonic(self):
        return self.now

    def sleep(self, _):
        self.now += 5.0


@pytest.fixture
def page(monkeypatch):
    """Return a function: a browser whose page is drawn at a time, with or without an error. [s]"""
    clock = Clock()
    monkeypatch.setattr(browser, 'time', clock)

    def page(drawn, failed=False):
        opened = object.__new__(Browser)
        opened.events = [('Runtime.exceptionThrown', {})]  # of the page before

        def evaluate(_):
            if failed and clock.now == 5.0:
                opened.events.append(('Runtime.exceptionThrown', {}))
            return clock.now >= drawn

        opened.evaluate = evaluate
        return opened

    return page


def test_a_page_that_a_busy_machine_draws_slowly_is_waited_for(page):
    page(200.0).wait_until('drawn')


@pytest.mark.parametrize(
    ('failed', 'sentence'),
    [
        (
            False,
            'HTML page within 305 s, perhaps because the machine is busy; try again, or open the ',
        ),
        (
            True,
            'HTML page within 35 s, because a script in it failed; try again, or open the page',
        ),
    ],
)
def test_a_page_that_is_never_drawn_is_given_up_with_the_reason(page, failed, sentence):
    with pytest.raises(BadInput, match=re.escape(sentence)):
        page(1e9, failed).wait_until('drawn')
