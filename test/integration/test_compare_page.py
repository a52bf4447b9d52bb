"""The page of a comparison in a real browser: nothing to complain of, any channel to pick."""

from lta_data.bag import open_flight
from lta_data.compare.comparison import compare_flights, ComparisonRequest
from lta_data.compare.report import build_report
from lta_report.report_page import write_report
from lta_report.screenshots import (
    open_page,
)
import pytest

from ..unit.data.compare.compare_flight import write_motion  # noqa: TID252 - `test` is Python's own

Z = 'odom/pose.pose.position.z'


@pytest.fixture(scope='module')
def page(browser, tmp_path_factory):
    folder = tmp_path_factory.mktemp('compare')
    bags = [
        write_motion(folder / 'a', noise=0.01, seed=1, until=30.0),
        write_motion(
            folder / 'b', noise=0.01, seed=2, until=30.0, rate=30.0, offset=0.1234, turn=0.5,
            frame='tracker', step=(15.0, 0.3), drop=(20.0, 23.0),
        ),
    ]  # fmt: skip
    found = compare_flights(*map(open_flight, bags), ComparisonRequest())
    return write_report(build_report(found), folder)


def test_a_channel_that_is_picked_is_drawn_over_time_and_by_frequency(browser, page):
    drawn = """(() => {
      const [time, frequency] = ['channel', 'spectrum'].map(
        (name) => document.querySelector(`[data-panel=${name}]`));
      return { title: time.layout.yaxis.title.text, least: Math.min(...time._fullData[0].y),
               part: time.layout.shapes[1].x0, coherence: frequency._fullData[3].y.length,
               picked: document.documentElement.dataset.channel ?? null };
    })()"""
    open_page(browser, page, 'dark', 1280)
    first = browser.evaluate(drawn)
    assert first['title'] == 'A, B [m]'
    assert first['part'] == pytest.approx(15.0, abs=0.05)
    select = "document.getElementById('channel')"
    yaw = 'odom/pose.pose.orientation.yaw'
    browser.evaluate(f"{select}.value = '{yaw}'; {select}.dispatchEvent(new Event('change'))")
    browser.wait_until(f"{drawn}.title === 'A, B [°]'")
    picked = browser.evaluate(drawn)
    assert picked['picked'] == yaw
    assert picked['coherence'] > 10
    button = f'document.querySelector(\'.pick[data-channel="{Z}"]\')'
    browser.evaluate(f'{button}.focus()')
    for kind in ('keyDown', 'keyUp'):
        browser.call(
            'Input.dispatchKeyEvent', type=kind, key='Enter', code='Enter', text='\r',
            windowsVirtualKeyCode=13,
        )  # fmt: skip
    browser.wait_until(f"{drawn}.title === 'A, B [m]'")
    assert browser.evaluate(f'{select}.value') == Z
    assert browser.evaluate(drawn)['least'] == pytest.approx(first['least'])
