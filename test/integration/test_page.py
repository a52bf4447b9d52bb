# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The page of a flight in a real browser: nothing to complain of, everything drawn."""

import os
import re
import struct

from lta_flight.report import write_page
from lta_flight.report.panels import FLIGHT_PANELS
from lta_report.browser import Browser
from lta_report.screenshots import open_page, SHARPNESS, write_pictures, write_video
from page_checks import collect_errors, COUNT_PANELS, list_requests
import pytest

from ..unit.report_flight import END, write_flight  # noqa: TID252 - `test` is Python's own

NAMES = [panel.name for panel in FLIGHT_PANELS]
TIMED = [panel.name for panel in FLIGHT_PANELS if panel.timed]
RANGES = """Object.fromEntries([...document.querySelectorAll('.plot')].map(
  (plot) => [plot.dataset.panel, plot._fullLayout.xaxis.range.slice()]))"""
CURSORS = """[...document.querySelectorAll('.cursor')].map((line) => {
  const plot = line.parentElement;
  return plot._fullLayout.xaxis.p2d(parseFloat(line.style.left) - plot._fullLayout._size.l);
})"""
DRONE = """(() => {
  const plot = document.querySelector('[data-panel=path]');
  const { xaxis, yaxis } = plot._fullLayout;
  const hull = plot.querySelector('.hull');
  return [xaxis.p2d(hull.getAttribute('cx') - xaxis._offset),
          yaxis.p2d(hull.getAttribute('cy') - yaxis._offset)];
})()"""


@pytest.fixture(scope='module')
def page(browser, tmp_path_factory):
    folder = tmp_path_factory.mktemp('page')
    write_page(write_flight(folder / 'bag'), folder / 'page.html')
    return folder / 'page.html'


@pytest.fixture(scope='module')
def session(browser, page):
    """Return a browser with the page open, which tests share and must leave as it was."""
    open_page(browser, page, 'light', 1280)
    return browser


def press_space(session):
    for kind in ('keyDown', 'keyUp'):
        session.call(
            'Input.dispatchKeyEvent', type=kind, key=' ', code='Space', text=' ',
            windowsVirtualKeyCode=32,
        )  # fmt: skip


@pytest.mark.parametrize(
    ('theme', 'width'), [('dark', 1280), pytest.param('light', 390, marks=pytest.mark.long)]
)
def test_every_panel_is_drawn_without_a_complaint_or_a_request(browser, page, theme, width):
    browser.events.clear()
    open_page(browser, page, theme, width)
    assert collect_errors(browser) == []
    assert list_requests(browser, page) == []
    panels = browser.evaluate(COUNT_PANELS)
    assert [panel['name'] for panel in panels] == NAMES
    for panel in panels:
        assert panel['traces'] > 0, panel
        assert panel['marks'] > 0, panel
        assert 250 < panel['width'] <= width, panel
        assert panel['height'] > 150, panel


def test_one_instant_is_marked_in_all_panels_and_on_the_path(session):
    slider = "document.getElementById('time')"
    session.evaluate(f"{slider}.value = 10; {slider}.dispatchEvent(new Event('input'))")
    assert session.evaluate(CURSORS) == pytest.approx([10.0] * len(TIMED), abs=1e-3)
    assert session.evaluate(DRONE) == pytest.approx([-0.5, 0.0], abs=0.03)
    spoken = session.evaluate(f"{slider}.getAttribute('aria-valuetext')")
    assert 'time 10.0' in spoken
    assert re.search(r'to the lamp (3\.99|4\.0\d)', spoken)


def test_pointing_at_one_panel_marks_the_instant_in_the_others(session):
    spot = session.evaluate("""(() => {
      const plot = document.querySelector('[data-panel=airspeed]');
      plot.scrollIntoView({ block: 'center', behavior: 'instant' });
      const { left, top, height } = plot.getBoundingClientRect();
      const { _size: size, xaxis } = plot._fullLayout;
      return [left + size.l + xaxis.d2p(8), top + height / 2];
    })()""")
    session.call('Input.dispatchMouseEvent', type='mouseMoved', x=spot[0], y=spot[1])
    session.wait_until(f'Math.abs({CURSORS}[0] - 8) < 0.1')
    assert session.evaluate(CURSORS) == pytest.approx([8.0] * len(TIMED), abs=0.1)


def test_a_flight_plays_at_the_speed_that_is_chosen(session):
    advanced = session.evaluate("""(() => {
      const own = [requestAnimationFrame, performance.now], frames = [];
      [window.requestAnimationFrame, performance.now] = [(show) => frames.push(show), () => 0];
      const pace = document.getElementById('pace');
      const advanced = ['4', '0.25', '1'].map((choice) => {
        pace.value = choice;
        mark(2);
        setPlaying(true);
        frames.pop()(1000);  // a frame after one second
        setPlaying(false);
        return now - 2;
      });
      [window.requestAnimationFrame, performance.now] = own;
      frames.forEach((show) => show());
      return advanced;
    })()""")
    usual = END / 15.0  # the whole flight in 15 s
    assert advanced == pytest.approx([4 * usual, usual / 4, usual], abs=1e-3)


def test_a_video_has_a_frame_for_each_instant(page, tmp_path, monkeypatch):
    # In place of ffmpeg: the frames as they come, to the file that is named last
    program = tmp_path / 'ffmpeg'
    program.write_text('#!/bin/sh\nfor out; do :; done\ncat >"$out"\n')
    program.chmod(0o755)
    monkeypatch.setenv('PATH', f'{tmp_path}:{os.environ["PATH"]}')
    write_video(page, tmp_path / 'flight.gif')
    frames = (tmp_path / 'flight.gif').read_bytes().split(b'\xff\xd8\xff')[1:]
    assert len(frames) == pytest.approx(10.0 * END, abs=1)  # a GIF has ten a second
    assert len(set(frames)) > 0.9 * len(frames)


def test_zooming_one_panel_zooms_all_panels_over_time(session):
    before = session.evaluate(RANGES)
    session.evaluate("""Plotly.relayout(document.querySelector('[data-panel=duty]'),
                        { 'xaxis.range[0]': 5, 'xaxis.range[1]': 9 }).then(() => 0)""")
    session.wait_until(f'{RANGES}.altitude[0] === 5')
    after = session.evaluate(RANGES)
    for name in NAMES:
        assert after[name] == pytest.approx([5, 9] if name in TIMED else before[name])


def test_button_changes_the_paper_of_page_and_pictures(session):
    paper = """[getComputedStyle(document.querySelector('.panel')).backgroundColor,
                document.querySelector('[data-panel=duty]')._fullLayout.paper_bgcolor]"""
    assert session.evaluate(paper) == ['rgb(255, 255, 255)', '#ffffff']
    session.evaluate("document.getElementById('theme').click()")
    session.wait_until(f"{paper}[1] === '#151b24'")
    assert session.evaluate(paper) == ['rgb(21, 27, 36)', '#151b24']
    session.evaluate("document.getElementById('theme').click()")
    session.wait_until(f"{paper}[1] === '#ffffff'")
    assert session.evaluate(paper) == ['rgb(255, 255, 255)', '#ffffff']


def test_flight_plays_from_the_keyboard(session):
    session.evaluate("document.getElementById('play').focus()")
    start = session.evaluate("Number(document.getElementById('time').value)")
    press_space(session)
    session.wait_until(f"Number(document.getElementById('time').value) > {start} + 0.3")
    assert session.evaluate("document.getElementById('play').ariaLabel") == 'Pause'
    press_space(session)
    assert session.evaluate("document.getElementById('play').ariaLabel") == 'Play the flight'


def size(png):
    """Return width and height of a PNG, which must be one."""
    data = png.read_bytes()
    assert data.startswith(b'\x89PNG\r\n\x1a\n')
    return struct.unpack('>II', data[16:24])


@pytest.mark.long
def test_pictures_of_the_whole_top_and_of_every_panel(page, tmp_path):
    written = write_pictures(page, tmp_path / 'pictures')
    assert [path.stem for path in written] == ['top', *NAMES]
    sizes = {path.stem: size(path) for path in written}
    assert sizes['top'][0] == 1280 * SHARPNESS
    assert all(width > 500 * SHARPNESS for width, _ in sizes.values())
    assert all(height > 300 * SHARPNESS for _, height in sizes.values())


def test_complaints_and_requests_are_seen_and_the_browser_ends(tmp_path):
    bad = tmp_path / 'bad.html'
    bad.write_text(
        '<script>document.documentElement.dataset.drawn = "1"; console.warn("odd");'
        'fetch("http://127.0.0.1:9/x").catch(() => 0); nothing.at.all;</script>'
    )
    with Browser() as session:
        open_page(session, bad, 'light', 1280)
        messages = collect_errors(session)
        assert 'odd' in messages
        assert any('nothing is not defined' in message for message in messages)
        assert list_requests(session, bad) == ['http://127.0.0.1:9/x']
    with pytest.raises(ProcessLookupError):
        os.kill(session._process.pid, 0)
