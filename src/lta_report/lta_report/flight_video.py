"""Film the 3-D view of a page as MP4 or GIF, by Chromium and ffmpeg, without a screen."""

import base64
from importlib import import_module
import json
from pathlib import Path
import shutil
import subprocess
import tempfile
from typing import Final

from lta_config.errors import BadInput
from lta_report.browser import Browser
from lta_report.screenshots import open_page, PAGE_WIDTH
import numpy as np

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
