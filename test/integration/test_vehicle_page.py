# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The page of a vehicle in a real browser: nothing to complain of, everything drawn, to scale."""

from lta_config.files import list_shipped_names
from lta_model.vehicle import load_vehicle
from lta_report.report_page import render_report
from lta_report.results_folder import write_file
from lta_report.screenshots import open_page
from lta_vehicle.figures.sheet import build_sheet
from lta_vehicle.views.report import build_report
from page_checks import collect_errors, list_requests
import pytest

WARNING = 'Only 0.3 g of ballast is left to take off.'
BOX = """(() => { const { x, y, width, height } = document.querySelector('%s').getBBox();
  return [x, y, width, height]; })()"""


@pytest.fixture(scope='module')
def pages(browser, tmp_path_factory):
    folder = tmp_path_factory.mktemp('vehicles')
    for name in list_shipped_names('vehicles'):
        report = build_report(build_sheet(load_vehicle(name)), [WARNING], name)
        write_file(render_report(report), folder / f'{name}.html')
    return folder


@pytest.mark.parametrize('name', list_shipped_names('vehicles'))
@pytest.mark.parametrize(('theme', 'width'), [('dark', 1280), ('light', 390)])
def test_every_vehicle_has_a_page_without_a_complaint_or_a_request(
    browser, pages, name, theme, width
):
    browser.events.clear()
    page = pages / f'{name}.html'
    open_page(browser, page, theme, width)
    assert collect_errors(browser) == []
    assert list_requests(browser, page) == []
    assert browser.evaluate('document.documentElement.scrollWidth') <= width
    assert browser.evaluate("document.querySelectorAll('.views .rotor .disc').length") > 3
    # Nothing that is drawn leaves the paper.
    inside = """(() => { const svg = document.querySelector('.views'), view = svg.viewBox.baseVal;
      const box = svg.getBBox();
      return box.x >= -1 && box.y >= -1 && box.x + box.width <= view.width + 1
        && box.y + box.height <= view.height + 1; })()"""
    assert browser.evaluate(inside)


def test_the_hull_is_drawn_to_scale(browser, pages):
    open_page(browser, pages / 'gtmab.html', 'light', 1280)
    _, _, width, height = browser.evaluate(BOX % '.views .hull')
    assert height / width == pytest.approx(0.599, abs=1e-3)


def test_dark_paper_has_its_own_colours(browser, pages):
    colour = "getComputedStyle(document.querySelector('.gravity .full')).fill"
    open_page(browser, pages / 'gtmab.html', 'light', 1280)
    assert browser.evaluate(colour) == 'rgb(200, 80, 10)'
    browser.evaluate("document.getElementById('theme').click()")
    browser.wait_until(f"{colour} === 'rgb(255, 154, 85)'")


def test_only_what_is_assumed_is_left_on_demand(browser, pages):
    rows = """[...document.querySelectorAll('.filter + .panel tbody tr')].filter(
      (row) => row.checkVisibility()).length"""
    sheet = build_sheet(load_vehicle('gtmab'))
    assumed = sum('assumed' in entry.source for entry in sheet.numbers)
    assert 0 < assumed < len(sheet.numbers)
    open_page(browser, pages / 'gtmab.html', 'light', 1280)
    assert browser.evaluate(rows) == len(sheet.numbers)
    browser.evaluate("document.getElementById('only').focus()")
    for kind in ('keyDown', 'keyUp'):
        browser.call(
            'Input.dispatchKeyEvent', type=kind, key=' ', code='Space', text=' ',
            windowsVirtualKeyCode=32,
        )  # fmt: skip
    browser.wait_until(f'{rows} === {assumed}')
