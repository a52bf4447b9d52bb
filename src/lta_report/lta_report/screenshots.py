"""Inspect a page in a browser: what it draws, its errors, and pictures of it."""

import base64
from collections.abc import Mapping
import math
from pathlib import Path
from typing import Any, Final, final, Literal, NamedTuple

from lta_config.errors import BadInput, unknown_name_error
from lta_report.browser import Browser
from lta_report.results_folder import read_asset, write_file

Theme = Literal['light', 'dark']
WIDTH: Final = 1280  # px, a laptop
SHARPNESS: Final = 2  # pixels of a picture per px of the page
# Chromium without a graphics card reads WebGL images back, and says that this is slow
DRIVER: Final = 'GL Driver Message'
TOP: Final = 'top'  # stands for header, tiles and what follows them
# Traces and drawn marks of each figure; a figure without marks is blank
COUNT_PANELS: Final = """
[...document.querySelectorAll('.plot')].map((plot) => {
  const paper = plot.querySelector('svg.main-svg');
  const box = paper ? paper.getBoundingClientRect() : { width: 0, height: 0 };
  const marks = plot.querySelectorAll(
    '.scatterlayer path, .heatmaplayer image, .contourlayer path, canvas').length;
  return { name: plot.dataset.panel, traces: plot.data ? plot.data.length : 0, marks,
           width: box.width, height: box.height };
})"""
# Position of a part from the top of the document, since the page may be scrolled
BOX: Final = """
(() => {
  const rise = window.scrollY;
  const box = (element) => element.getBoundingClientRect();
  if ('%(panel)s' === 'top') {
    const end = document.querySelector('.tiles ~ :not(noscript)');
    return { x: 0, y: 0, width: innerWidth, height: box(end).bottom + rise + 16 };
  }
  const panel = document.getElementById('panel-%(panel)s');
  if (!panel) return null;
  const { x, y, width, height } = box(panel);
  return { x, y: y + rise, width, height };
})()"""

# Plotly redraws 0.1 s after the window has changed, over several frames
SETTLED: Final = """
Promise.all([...(document.getElementById('panel-%(panel)s') ?? document).querySelectorAll('.plot')]
  .filter((plot) => plot.data && plot.offsetParent)
  .map((plot) => Plotly.Plots.resize(plot)))
  .then(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))))
  .then(() => true)"""


@final
class RenderedPicture(NamedTuple):
    """One figure of an open page: traces, drawn marks and size. [px]"""

    name: str
    traces: int
    marks: int
    width: float
    height: float


@final
class PageCheck(NamedTuple):
    """The result of opening a page: console messages, requested addresses and figures."""

    messages: list[str]
    fetched: list[str]
    panels: list[RenderedPicture]


def inspect_page(page: Path, theme: Theme = 'light', width: int = WIDTH) -> PageCheck:
    """
    Open a page in a browser and return what it shows.

    `page`: HTML file. `theme`: preferred theme of the reader, 'light' or 'dark'. `width`: width of
    the window [px]. Raise `BadInput` if there is no browser or no page.
    """
    with Browser() as browser:
        open_page(browser, page, theme, width)
        panels = [RenderedPicture(**panel) for panel in browser.evaluate(COUNT_PANELS)]
        return PageCheck(collect_errors(browser), list_requests(browser, page), panels)


def write_picture(
    page: Path, out: Path, panel: str = TOP, theme: Theme = 'light', width: int = WIDTH
) -> None:
    """
    Write one panel of a page, or its top, as PNG.

    Parameters
    ----------
    page : Path
        HTML file.
    out : Path
        PNG file to write.
    panel : str
        Name of a panel, or 'top'.
    theme, width
        As in `inspect_page`.

    Raises
    ------
    BadInput
        If there is no browser, no page or no such panel.

    """
    with Browser() as browser:
        open_page(browser, page, theme, width)
        capture_part(browser, panel, out)


def write_pictures(page: Path, folder: Path, theme: Theme = 'light') -> list[Path]:
    """
    Write the top of a page and each of its panels as PNG, and return the files.

    Raise `BadInput` if there is no browser or no page.
    """
    folder.mkdir(parents=True, exist_ok=True)
    with Browser() as browser:
        open_page(browser, page, theme, WIDTH)
        names = [TOP, *(panel['name'] for panel in browser.evaluate(COUNT_PANELS))]
        for name in names:
            capture_part(browser, name, folder / f'{name}.png')
    return [folder / f'{name}.png' for name in names]


def open_page(browser: Browser, page: Path, theme: Theme, width: int) -> None:
    """Open a page and wait until it is drawn."""
    if not page.is_file():
        raise BadInput(f"HTML page '{page}' does not exist; check the path.")
    # The page follows the reader's theme
    preference = [{'name': 'prefers-color-scheme', 'value': theme}]
    browser.call('Emulation.setEmulatedMedia', features=preference)
    resize_window(browser, width, 900)
    browser.call('Page.navigate', url=page.resolve().as_uri())
    # Set by page.js once all figures are drawn
    browser.wait_until('document.documentElement.dataset.drawn')


def resize_window(browser: Browser, width: int, height: int) -> None:
    """Set the size of the window. [px]"""
    browser.call(
        'Emulation.setDeviceMetricsOverride',
        width=width,
        height=height,
        deviceScaleFactor=SHARPNESS,
        mobile=False,
    )


def capture_part(browser: Browser, panel: str, out: Path) -> None:
    """Write one part of the open page as PNG."""
    box = locate_part(browser, panel)
    # Chromium would enlarge the window itself for the picture, without waiting for the redraw
    resize_window(browser, browser.evaluate('innerWidth'), max(math.ceil(box['height']), 1))
    if browser.evaluate(SETTLED % {'panel': panel}) is not True:
        raise BadInput(
            f"Chromium did not draw the part '{panel}' of the HTML page; open the page in a "
            'browser and look for errors there.'
        )
    # The replay bar sticks to the bottom of the window and would cover the panel
    browser.evaluate("document.getElementById('bar')?.style.setProperty('visibility', 'hidden')")
    box = locate_part(browser, panel)
    browser.evaluate(f'scrollTo(0, {box["y"]})')
    shot = browser.call('Page.captureScreenshot', format='png', clip={**box, 'scale': 1})
    write_file(base64.b64decode(shot['data']), out)


def locate_part(browser: Browser, panel: str) -> Mapping[str, float]:
    """Return the position and size of a part of the open page. [px]"""
    box: Mapping[str, float] | None = browser.evaluate(BOX % {'panel': panel})
    if box is None:
        names = [item['name'] for item in browser.evaluate(COUNT_PANELS)]
        raise unknown_name_error('panel', panel, [TOP, *names])
    return box


def find_overlapping_labels(browser: Browser) -> list[str]:
    """Return the labels of the open page that overprint others or are cut off, in words."""
    labels: list[str] = browser.evaluate(read_asset('overlaps.js'))
    return labels


def collect_errors(browser: Browser) -> list[str]:
    """Return console messages and uncaught errors of the page."""
    messages = []
    for method, event in browser.events:
        if method == 'Runtime.consoleAPICalled':
            messages.append(' '.join(str(part.get('value', part)) for part in event['args']))
        elif method == 'Runtime.exceptionThrown':
            messages.append(format_exception(event['exceptionDetails']))
        elif method == 'Log.entryAdded' and DRIVER not in event['entry']['text']:
            messages.append(event['entry']['text'])
    return messages


def format_exception(details: Mapping[str, Any]) -> str:
    """Return an uncaught error as text."""
    return str(details.get('exception', {}).get('description', details['text']))


def list_requests(browser: Browser, page: Path) -> list[str]:
    """Return every requested address except the page itself and embedded data."""
    urls = [
        event['request']['url']
        for method, event in browser.events
        if method == 'Network.requestWillBeSent'
    ]
    return [url for url in urls if url != page.resolve().as_uri() and not url.startswith('data:')]
