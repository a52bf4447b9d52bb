# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Take pictures of a page and its figures in a browser."""

import base64
from collections.abc import Mapping
from importlib import import_module
import json
import math
from pathlib import Path
import shutil
import subprocess
import tempfile
from typing import Final, Literal

from lta_config.errors import BadInput, unknown_name_error
from lta_report.browser import Browser
from lta_report.results_folder import write_file
import numpy as np

Theme = Literal['light', 'dark']
PAGE_WIDTH: Final = 1280  # px, a laptop
SHARPNESS: Final = 2  # pixels of a picture per px of the page
TOP_PICTURE: Final = 'top'  # stands for header, tiles and what follows them
LIST_PANELS: Final = "[...document.querySelectorAll('.plot')].map((plot) => plot.dataset.panel)"
# Position of a part from the top of the document, since the page may be scrolled
FIND_BOX: Final = """
(() => {
  const rise = window.scrollY;
  const box = (element) => element.getBoundingClientRect();
  if ('%(panel)s' === 'top') {
    const end = document.querySelector('.tiles ~ :not(noscript)');
    return { x: 0, y: 0, width: innerWidth, height: box(end).bottom + rise + 16 };
  }
  const panel = document.getElementById('panel-%(panel)s');
  if (!panel) return null;
  panel.style.alignSelf = 'start';  // not as high as a taller neighbour
  const { x, y, width, height } = box(panel);
  return { x, y: y + rise, width, height };
})()"""

# Plotly redraws 0.1 s after the window has changed, over several frames
SETTLED_SCRIPT: Final = """
Promise.all([...(document.getElementById('panel-%(panel)s') ?? document).querySelectorAll('.plot')]
  .filter((plot) => plot.data && plot.offsetParent)
  .map((plot) => Plotly.Plots.resize(plot)))
  .then(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))))
  .then(() => true)"""


def write_picture(
    page: Path,
    out: Path,
    panel: str = TOP_PICTURE,
    theme: Theme = 'light',
    width: int = PAGE_WIDTH,
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
    theme : str
        Preferred theme of the reader, 'light' or 'dark'.
    width : int
        Width of the window. [px]

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
        open_page(browser, page, theme, PAGE_WIDTH)
        names = [TOP_PICTURE, *browser.evaluate(LIST_PANELS)]
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
    """Set the size of the window [px]."""
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
    if browser.evaluate(SETTLED_SCRIPT % {'panel': panel}) is not True:
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
    """Return the position and size of a part of the open page [px]."""
    box: Mapping[str, float] | None = browser.evaluate(FIND_BOX % {'panel': panel})
    if box is None:
        raise unknown_name_error('panel', panel, [TOP_PICTURE, *browser.evaluate(LIST_PANELS)])
    return box


VIDEO_SIZE: Final = (640, 360)  # px
LONGEST_VIDEO: Final = 60.0  # s of a video; a longer flight is shown faster
# Frames per second, and what ffmpeg makes of them
VIDEO_FORMATS: Final = {
    '.mp4': (25.0, ('-c:v', 'libx264', '-crf', '20', '-pix_fmt', 'yuv420p')),
    '.gif': (
        10.0,
        ('-vf', 'split[a][b];[a]palettegen=max_colors=64[p];[b][p]paletteuse=dither=none'),
    ),
}
NO_FFMPEG: Final = (
    'A video needs ffmpeg, which is not installed; install it (Debian or Ubuntu: sudo apt install '
    'ffmpeg) or run "pip install imageio-ffmpeg", in a source tree ".venv/bin/pip install -r '
    'requirements-video.txt".'
)
# The view gets the size of the film, whatever the page gives it
PREPARE: Final = """
(() => {
  if (!scene) return null;
  window.film = Object.assign(document.createElement('canvas'), { width: %d, height: %d });
  scene.renderer.setPixelRatio(1);
  scene.renderer.setSize(film.width, film.height, false);
  scene.camera.aspect = film.width / film.height;
  scene.camera.updateProjectionMatrix();
  return [times[0], times[times.length - 1]];
})()"""
FRAME_SCRIPT: Final = """
(() => {
  const pen = film.getContext('2d'), style = getComputedStyle(document.documentElement);
  scene.show(%(time)f);
  scene.render();
  pen.fillStyle = style.getPropertyValue('--paper');
  pen.fillRect(0, 0, film.width, film.height);
  pen.drawImage(scene.renderer.domElement, 0, 0);
  pen.fillStyle = style.getPropertyValue('--ink');
  pen.font = '600 20px ' + getComputedStyle(document.body).fontFamily;
  pen.fillText(%(text)s, 16, film.height - 16);
  return film.toDataURL('image/jpeg', 0.95).split(',')[1];
})()"""


def check_video_output(out: Path) -> str:
    """
    Return the path of ffmpeg for a video, before any work.

    Raise `BadInput` if it is not installed, or if `out` is neither MP4 nor GIF.
    """
    if out.suffix not in VIDEO_FORMATS:
        raise BadInput(f"The video '{out}' must end in {' or '.join(VIDEO_FORMATS)}.")
    if (program := shutil.which('ffmpeg')) is not None:
        return program
    try:
        return str(import_module('imageio_ffmpeg').get_ffmpeg_exe())
    except (ImportError, RuntimeError) as error:
        raise BadInput(NO_FFMPEG) from error


def write_video(page: Path, out: Path) -> None:
    """
    Film the 3-D view of a page from the first time to the last, at most for a minute.

    `page`: HTML file. `out`: MP4 or GIF file to write. Raise `BadInput` if Chromium or ffmpeg is
    missing or fails, or the page has no 3-D view.
    """
    program = check_video_output(out)
    rate, coding = VIDEO_FORMATS[out.suffix]
    out.parent.mkdir(parents=True, exist_ok=True)
    with Browser() as browser, tempfile.TemporaryDirectory(dir=out.parent) as folder:
        open_page(browser, page, 'light', PAGE_WIDTH)
        span: tuple[float, float] | None = browser.evaluate(PREPARE % VIDEO_SIZE)
        if span is None:
            raise BadInput(f"'{page}' has no 3-D view to film: the true motion is not known.")
        pace = max(1.0, (span[1] - span[0]) / LONGEST_VIDEO)
        film = Path(folder, out.name)
        words = [program, '-loglevel', 'error', '-f', 'mjpeg', '-framerate', f'{rate}', '-i', '-']
        with subprocess.Popen(
            [*words, *coding, film], stdin=subprocess.PIPE, stderr=subprocess.PIPE
        ) as encoder:
            frames = bytearray()
            for time in np.arange(span[0], span[1], pace / rate):
                text = f'{time:.1f} s' + (f'   {pace:.1f} x real time' if pace > 1.0 else '')
                shot = browser.evaluate(FRAME_SCRIPT % {'time': time, 'text': json.dumps(text)})
                frames += base64.b64decode(shot)
            _, errors = encoder.communicate(bytes(frames))
        if encoder.returncode:
            raise BadInput(f'ffmpeg could not write the video: {errors.decode().strip()}')
        film.replace(out)
