# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Every kind of page in a real browser: one look, offline, by keyboard, on dark and light."""

import json
from pathlib import Path
import sys

from lta_bag.reader import read_bag
from lta_bag.writer import BagWriter
from lta_cli import app
from lta_data.bag.recorded_flight import open_flight
from lta_flight.replay.replay_request import ReplayRequest
from lta_flight.replay.report import build_report
from lta_flight.replay.run import ReplayRun
from lta_flight.replay.verdict import compare_with_recording
from lta_flight.report import write_page
from lta_report.report_page import write_report
from lta_report.screenshots import capture_part, open_page, resize_window
from lta_studies.tune import compare, helium_limit
from lta_studies.tune.compare import LampFlightResult
from page_checks import collect_errors, find_overlapping_labels, list_requests
import pytest
from stamped_bytes import shift_stamp
import yaml

from ..unit.report_flight import write_flight  # noqa: TID252 - `test` is Python's own

SWEEP = {
    'schema': 1, 'name': 'short', 'about': 'Short flights.', 'vehicle': 'gtmab',
    'scenario': 'lamp_room', 'strategy': 'bag', 'gains': 'gtmab', 'seeds': {'count': 2},
    'set': {'scenario.goal.time_limit': '0.2 s'},
    'vary': {'vehicle.trim.heaviness': ['1 g', '2 g']},
}  # fmt: skip
LAMP = Path(__file__).resolve().parents[1] / 'replay/lamp.mcap'
PAPER_WIDTH = 718  # px of A4 with margins of 1 cm at 96 a inch
CONTRAST = """(() => {
  const parts = (colour) => colour.match(/[\\d.]+/g).map(Number);
  const light = (c) => { const v = c / 255; return v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4; };
  const luminance = ([r, g, b]) => 0.2126 * light(r) + 0.7152 * light(g) + 0.0722 * light(b);
  const behind = (element) => {
    for (let e = element; e; e = e.parentElement) {
      const found = parts(getComputedStyle(e).backgroundColor);
      if (found.length < 4 || found[3] > 0.99) return found;
    }
    return [255, 255, 255];
  };
  const poor = [];
  for (const element of document.querySelectorAll('header *, main *')) {
    const own = [...element.childNodes].some((n) => n.nodeType === 3 && n.textContent.trim());
    if (!own || !element.checkVisibility() || element.closest('.plot, svg, script, .hidden')) continue;
    const [a, b] = [luminance(parts(getComputedStyle(element).color)), luminance(behind(element))];
    const ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
    if (ratio < 4.5) poor.push(element.className + ' ' + element.textContent.slice(0, 30) + ' ' + ratio.toFixed(2));
  }
  return poor;
})()"""  # noqa: E501
NAMELESS = """[...document.querySelectorAll('button, input, select, a, summary, [role=img]')]
  .filter((e) => !(e.ariaLabel || e.textContent.trim() || e.labels?.length))
  .map((e) => e.outerHTML)"""
HEADINGS = "[...document.querySelectorAll('h1, h2, h3')].map((e) => e.tagName)"
HEADS = "[...document.querySelectorAll('th')].filter((e) => !e.scope).length"
FOCUS = 'document.activeElement.id || document.activeElement.className'


def flight(folder, call):
    write_page(write_flight(folder / 'bag'), folder / 'report.html')


def plot(folder, call):
    bag = write_flight(folder / 'bag')
    call(
        'bag', 'plot', bag, 'odom', 'motors', 'light/peaks/snr*', '--html', folder / 'report.html'
    )


def vehicle(folder, call):
    call('vehicle', 'show', 'gtmab', '--out', folder / 'out')
    (folder / 'out' / 'report.html').rename(folder / 'report.html')


def sweep(folder, call):
    (folder / 'short.yaml').write_text(yaml.safe_dump(SWEEP))
    call('sweep', folder / 'short.yaml', '--workers', '1', '--out', folder / 'out')
    (folder / 'out' / 'report.html').rename(folder / 'report.html')


def tune(folder, call):
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(helium_limit, 'TRIED_LOSSES', 1)
        patched.setattr(helium_limit, 'HALVINGS', 0)
        patched.setattr(compare, 'fly_to_lamp', lambda *_: LampFlightResult(True, 0.3))
        words = ('--budget=2', '--draws=2', '--cases=1', '--workers=1', '--number=climb.kp')
        call('tune', 'gtmab', '--most=0 g', *words, '--out', folder / 'out')
    (folder / 'out' / 'report.html').rename(folder / 'report.html')


def replay(folder, call):
    """A replay that asks for each speed half a second earlier than was recorded."""
    stored = read_bag(LAMP)
    velocity = '/lta1/setpoint/velocity'
    kept = [message for message in stored.iterate_messages() if message[0] != velocity]
    speeds = [(at, data) for _, at, data in stored.iterate_messages([velocity])]
    with BagWriter(folder / 'bag', {}) as writer:
        for topic in stored.topics.values():
            writer.add_topic(topic.name, topic.type_name, [])
        for name, at, data in kept:
            writer.write(name, data, at)
        for at, data in speeds[5:]:
            writer.write(velocity, shift_stamp(data, -500_000_000), at - 500_000_000)
    order = ReplayRequest(LAMP, ('demodulator', 'navigator'))
    found = compare_with_recording(
        open_flight(LAMP), open_flight(folder / 'bag'), order.node_selection.answers
    )
    assert found.word == 'different'
    played = ReplayRun(folder / 'bag', None)
    write_report(build_report(played, found, order, stored.provenance), folder)


def run_quickly(*words):
    """Return what makes the page of a command that writes it into its folder of results."""

    def make(folder, call):
        call(*words, '--out', folder / 'out')
        (folder / 'out' / 'report.html').rename(folder / 'report.html')

    return make


PAGES = {
    'budget': run_quickly('energy', 'budget', '--quick'),
    'cfd': run_quickly('cfd', 'run', '--quick'),
    'tests_plan': run_quickly('tests', 'plan', 'gtmab'),
    'mission': run_quickly('mission', '--seeds', '1', '--workers', '1'),
    'wind': run_quickly('wind', 'gtmab', 'skye'),
    'light_plan': run_quickly('light', 'plan', '--cell', '2', '--lamps', '3'),
    'light_link': run_quickly('light', 'link', '--scenario', 'lamp_room', '--distance', '3',
                              '--distance', '7', '--blocks', '2'),
    'cells': run_quickly('cells'),
    'breakeven': run_quickly('energy', 'breakeven'),
}  # fmt: skip
PAGES |= {made.__name__: made for made in (flight, plot, vehicle, sweep, tune, replay)}


def typed(*words):
    """Run the command in this process."""
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(sys, 'argv', ['lta', *map(str, words)])
        assert app.run_command_line() == 0


# What takes long to make; the report that all share is looked at on the other pages.
LONG = (
    'budget',
    'cfd',
    'tests_plan',
    'mission',
    'sweep',
    'wind',
    'light_link',
    'tune',
    'breakeven',
)

LARGEST = ('flight', 'replay')  # pages of those that every run checks


@pytest.fixture(
    scope='module',
    params=[pytest.param(name, marks=pytest.mark.long if name in LONG else ()) for name in PAGES],
)
def page(request, browser, tmp_path_factory):
    folder = tmp_path_factory.mktemp(request.param)
    PAGES[request.param](folder, typed)
    return folder / 'report.html'


@pytest.fixture(scope='module')
def opened(browser):
    """Return a function that opens a page as a reader prefers it, unless it is open already."""
    last = []

    def opened(*asked):
        if last != [asked]:
            browser.events.clear()
            open_page(browser, *asked)
            last[:] = [asked]
        return last  # emptied by who leaves the page otherwise than it was opened

    return opened


def shows_all(browser, page, width, picture):
    """Check an open page for complaints, requests, labels, width and contrast; photograph it."""
    assert collect_errors(browser) == []
    assert find_overlapping_labels(browser) == []
    assert list_requests(browser, page) == []
    assert browser.evaluate('document.documentElement.scrollWidth') <= width
    assert browser.evaluate(CONTRAST) == []
    capture_part(browser, 'top', picture)
    assert picture.stat().st_size > 10_000


# The other pages have the same layout; short runs check them at laptop width only, below.
@pytest.mark.parametrize(
    'page',
    [pytest.param(name, marks=() if name in LARGEST else pytest.mark.long) for name in PAGES],
    indirect=True,
)
def test_on_a_phone_it_shows_all_without_a_complaint_or_a_request(browser, opened, page, tmp_path):
    opened(page, 'light', 390)
    shows_all(browser, page, 390, tmp_path / 'top.png')


def test_it_shows_all_without_a_complaint_or_a_request(browser, opened, page, tmp_path):
    opened(page, 'dark', 1280)
    shows_all(browser, page, 1280, tmp_path / 'top.png')


def press(session, key, code):
    for kind in ('keyDown', 'keyUp'):
        session.call(
            'Input.dispatchKeyEvent', type=kind, key=key, code=key, windowsVirtualKeyCode=code,
            text='\r' if key == 'Enter' and kind == 'keyDown' else '',
        )  # fmt: skip


def test_it_is_used_by_keyboard_and_read_aloud(browser, opened, page):
    shown = opened(page, 'dark', 1280)
    asked = shown.pop()
    press(browser, 'Tab', 9)
    assert browser.evaluate(FOCUS) == 'skip'
    press(browser, 'Tab', 9)
    assert browser.evaluate(FOCUS) == 'theme'
    for theme, pressed in (('light', 'false'), ('dark', 'true')):
        press(browser, 'Enter', 13)
        browser.wait_until(f"document.documentElement.dataset.theme === '{theme}'")
        assert browser.evaluate("document.getElementById('theme').ariaPressed") == pressed
    assert browser.evaluate('document.documentElement.lang') == 'en'
    assert browser.evaluate(NAMELESS) == []
    assert browser.evaluate(HEADS) == 0
    headings = browser.evaluate(HEADINGS)
    assert headings[0] == 'H1'
    assert headings.count('H1') == 1
    target = browser.evaluate("document.querySelector('.skip').getAttribute('href').slice(1)")
    assert browser.evaluate(f'document.getElementById({json.dumps(target)}).tagName') == 'MAIN'
    shown.append(asked)


def test_it_prints_on_white_paper_within_its_margins(browser, opened, page):
    opened(page, 'dark', 1280).clear()
    resize_window(browser, PAPER_WIDTH, 900)
    browser.call('Emulation.setEmulatedMedia', media='print')
    browser.evaluate("dispatchEvent(new Event('beforeprint'))")
    browser.wait_until("document.documentElement.dataset.theme === 'light'")
    assert not browser.evaluate("document.getElementById('theme').checkVisibility()")
    assert browser.evaluate('getComputedStyle(document.body).backgroundImage') == 'none'
    browser.wait_until(f'document.documentElement.scrollWidth <= {PAPER_WIDTH}')  # pictures follow
    printed = browser.call('Page.printToPDF', paperWidth=8.27, paperHeight=11.69)
    assert len(printed['data']) > 20_000
    browser.call('Emulation.setEmulatedMedia', media='')
