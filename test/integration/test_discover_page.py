"""The page of a study in a real browser: nothing to complain of, everything drawn, any flight."""

from dataclasses import replace

from lta_discovery.page.page import write_page
from lta_discovery.replay.linearized_flight import unchanged_vehicle_point
from lta_discovery.study import ThreeModelComparison
from lta_discovery.unmodeled.unexplained_force import Remainder
from lta_report.screenshots import collect_errors, COUNT_PANELS, list_requests, open_page
import pytest

from ..unit.discovery.hidden_cases import CASES  # noqa: TID252 - `test` is Python's own
from ..unit.discovery.hidden_flight import nominal  # noqa: TID252
from ..unit.discovery.hidden_study import DRAG, study  # noqa: TID252
from .test_pages import CONTRAST, HEADS, NAMELESS

pytestmark = pytest.mark.long

REMAINS = (Remainder('surge', 0.0072, 18.25, ('surge speed',), 0.81),)
PANELS = {'heat', 'conditions', 'above', 'overtime', 'white', 'power', 'latent', 'follows'}
DRAWN = "document.querySelector('[data-panel=%s]').data"


@pytest.fixture(scope='module')
def page(browser, tmp_path_factory):
    found = study(nominal(), CASES[DRAG])
    shown = tuple(
        ThreeModelComparison(
            one,
            *(unchanged_vehicle_point(each, one.flight.knobs, one.flight.replay.cut) for each in
              (found.nominal, found.nominal, found.learned)),
        )
        for one in found.flights
    )  # fmt: skip
    finding = replace(found.finding, remains=REMAINS, verdict='named+unexplained')
    given = replace(found, finding=finding, shown=shown)
    return write_page(given, tmp_path_factory.mktemp('study'))


@pytest.mark.parametrize(('theme', 'width'), [('light', 390), ('dark', 1280)])
def test_all_is_drawn_without_a_complaint_or_a_request(browser, page, theme, width):
    browser.events.clear()
    open_page(browser, page, theme, width)
    assert collect_errors(browser) == []
    assert list_requests(browser, page) == []
    assert browser.evaluate('document.documentElement.scrollWidth') <= width
    assert browser.evaluate(CONTRAST) == []
    assert browser.evaluate(NAMELESS) == []
    assert browser.evaluate(HEADS) == 0
    panels = {panel['name']: panel for panel in browser.evaluate(COUNT_PANELS)}
    assert set(panels) == PANELS
    assert all(panel['marks'] > 0 for panel in panels.values())


def pick(browser, number):
    browser.evaluate(
        f"(() => {{ const select = document.getElementById('flight'); select.value = '{number}';"
        "select.dispatchEvent(new Event('change')); })()"
    )
    browser.wait_until(f"document.documentElement.dataset.flight === '{number}'")
    return browser.evaluate(f'Array.from({DRAWN % "above"}[0].x).slice(0, 40)')


def test_any_flight_can_be_looked_at(browser, page):
    open_page(browser, page, 'light', 1280)
    first = browser.evaluate(f'Array.from({DRAWN % "above"}[0].x).slice(0, 40)')
    assert pick(browser, 1) != first
    # How far a prediction is off starts small in every piece and is never negative.
    away = browser.evaluate(f'Array.from({DRAWN % "overtime"}[6].y).filter(Number.isFinite)')
    assert 0.0 <= min(away) < 0.02 < max(away)
    assert pick(browser, 0) == first
    assert collect_errors(browser) == []
