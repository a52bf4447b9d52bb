"""The page of a vehicle in a real browser: nothing to complain of, everything drawn, to scale."""

from lta_analysis.browser import Browser, find_chromium
from lta_analysis.report.screenshots import complaints, fetched, show
from lta_analysis.vehicle.page import write_page
from lta_analysis.vehicle.sheet import sheet_of
from lta_config.errors import BadInput
from lta_config.files import known
from lta_sim.vehicle import load_vehicle
import pytest

pytestmark = pytest.mark.beside

WARNING = 'Only 0.3 g of ballast is left to take off.'
BOX = """(() => { const { x, y, width, height } = document.querySelector('%s').getBBox();
  return [x, y, width, height]; })()"""


@pytest.fixture(scope='module')
def pages(tmp_path_factory):
    folder = tmp_path_factory.mktemp('vehicles')
    try:
        find_chromium()
    except BadInput as reason:
        pytest.skip(str(reason))
    for name in known('vehicles'):
        write_page(sheet_of(load_vehicle(name)), [WARNING], name, folder / f'{name}.html')
    return folder


@pytest.fixture(scope='module')
def session(pages):
    with Browser() as running:
        yield running


@pytest.mark.parametrize('name', known('vehicles'))
@pytest.mark.parametrize(('theme', 'width'), [('dark', 1280), ('light', 390)])
def test_every_vehicle_has_a_page_without_a_complaint_or_a_request(
    session, pages, name, theme, width
):
    session.events.clear()
    page = pages / f'{name}.html'
    show(session, page, theme, width)
    assert complaints(session) == []
    assert fetched(session, page) == []
    assert session.evaluate('document.documentElement.scrollWidth') <= width
    assert session.evaluate("document.querySelectorAll('.views .rotor .disc').length") > 3
    # Nothing that is drawn leaves the paper.
    inside = """(() => { const svg = document.querySelector('.views'), view = svg.viewBox.baseVal;
      const box = svg.getBBox();
      return box.x >= -1 && box.y >= -1 && box.x + box.width <= view.width + 1
        && box.y + box.height <= view.height + 1; })()"""
    assert session.evaluate(inside)


def test_the_hull_is_drawn_to_scale(session, pages):
    show(session, pages / 'gtmab.html', 'light', 1280)
    _, _, width, height = session.evaluate(BOX % '.views .hull')
    assert height / width == pytest.approx(0.599, abs=1e-3)


def test_dark_paper_has_its_own_colours(session, pages):
    colour = "getComputedStyle(document.querySelector('.gravity .full')).fill"
    show(session, pages / 'gtmab.html', 'light', 1280)
    assert session.evaluate(colour) == 'rgb(200, 80, 10)'
    session.evaluate("document.getElementById('theme').click()")
    session.wait(f"{colour} === 'rgb(255, 154, 85)'")


def test_only_what_is_assumed_is_left_on_demand(session, pages):
    rows = """[...document.querySelectorAll('table.numbers tbody tr')].filter(
      (row) => row.checkVisibility()).length"""
    sheet = sheet_of(load_vehicle('gtmab'))
    assumed = sum('assumed' in entry.source for entry in sheet.numbers)
    assert 0 < assumed < len(sheet.numbers)
    show(session, pages / 'gtmab.html', 'light', 1280)
    assert session.evaluate(rows) == len(sheet.numbers)
    session.evaluate("document.getElementById('only').focus()")
    for kind in ('keyDown', 'keyUp'):
        session.call(
            'Input.dispatchKeyEvent', type=kind, key=' ', code='Space', text=' ',
            windowsVirtualKeyCode=32,
        )  # fmt: skip
    session.wait(f'{rows} === {assumed}')


def test_warnings_stand_on_the_page(session, pages):
    show(session, pages / 'gtmab.html', 'light', 1280)
    assert WARNING in session.evaluate('document.body.textContent')
