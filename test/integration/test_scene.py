# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The 3-D view of a flight in a real browser: time and view by keyboard, dark, without WebGL."""

from lta_flight.report import write_page
from lta_report.screenshots import open_page
from page_checks import collect_errors
import pytest

from ..unit.report_flight import write_flight  # noqa: TID252 - `test` is Python's own

WITHOUT = """(() => {
  const own = HTMLCanvasElement.prototype.getContext;
  HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
    return kind.startsWith('webgl') ? null : own.call(this, kind, ...rest);
  };
})()"""
MOST = 6_000_000  # bytes of a page with a 3-D view
INK = """(() => {
  const canvas = document.querySelector('.scene canvas');
  const copy = Object.assign(document.createElement('canvas'), { width: 80, height: 40 });
  const pen = copy.getContext('2d');
  pen.drawImage(canvas, 0, 0, 80, 40);
  return pen.getImageData(0, 0, 80, 40).data.filter((_, k) => k % 4 === 3).filter(Boolean).length;
})()"""


@pytest.fixture(scope='module')
def page(tmp_path_factory):
    folder = tmp_path_factory.mktemp('scene')
    write_page(write_flight(folder / 'bag'), folder / 'report.html')
    return folder / 'report.html'


def press(session, key, shift=False):
    codes = {'ArrowLeft': 37, 'ArrowRight': 39, 'ArrowUp': 38, '+': 187, '0': 48}
    for kind in ('keyDown', 'keyUp'):
        session.call(
            'Input.dispatchKeyEvent', type=kind, key=key, modifiers=8 if shift else 0,
            windowsVirtualKeyCode=codes[key],
        )  # fmt: skip


def test_the_view_is_drawn_and_steered_by_keyboard(browser, page):
    browser.events.clear()
    open_page(browser, page, 'dark', 900)
    assert page.stat().st_size < MOST
    # Something is drawn on more than a tenth of the canvas
    assert browser.evaluate(INK) > 320
    browser.evaluate("document.querySelector('.scene').focus()")
    before = browser.evaluate('now')
    press(browser, 'ArrowRight')
    assert browser.evaluate('now') > before
    press(browser, 'ArrowLeft')
    assert browser.evaluate('now') == pytest.approx(before)
    for key, shift, part, change in (
        ('ArrowRight', True, 'azimuth', -6),
        ('ArrowUp', False, 'elevation', 4),
        ('+', False, 'zoom', 0.2),
    ):
        old = browser.evaluate(f'scene.view.{part}')
        press(browser, key, shift)
        assert browser.evaluate(f'scene.view.{part}') == pytest.approx(old + change), part
    press(browser, '0')
    assert browser.evaluate('scene.view.zoom') == 1
    browser.evaluate("document.querySelector('[data-view=follow]').click()")
    assert browser.evaluate('scene.following') is True
    assert collect_errors(browser) == []


def test_the_drone_is_where_the_track_says(browser, page):
    """The scene takes the sample nearest to the cursor."""
    open_page(browser, page, 'light', 900)
    browser.evaluate('mark(times[Math.floor(times.length / 3)])')
    here = browser.evaluate('scene.flown[0].body.position.toArray()')
    there = browser.evaluate('["x", "y", "z"].map((axis) => track[axis][at(now)])')
    assert here == pytest.approx(there, abs=0.05)


def test_without_webgl_it_says_so_and_shows_the_rest(browser, page):
    browser.events.clear()
    added = browser.call('Page.addScriptToEvaluateOnNewDocument', source=WITHOUT)
    try:
        open_page(browser, page, 'light', 900)
        assert browser.evaluate("document.querySelector('.scene-absent').checkVisibility()")
        assert not browser.evaluate("document.querySelector('.scene').checkVisibility()")
        assert browser.evaluate("document.querySelectorAll('.plot .main-svg').length") > 0
        assert collect_errors(browser) == []
    finally:
        browser.call('Page.removeScriptToEvaluateOnNewDocument', **added)
