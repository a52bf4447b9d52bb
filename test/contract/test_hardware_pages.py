"""The pages on hardware are those of the stored rows, and name the firmware that was tried."""

from importlib import import_module
import json
from pathlib import Path
import sys

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path += [str(ROOT / 'test/score'), str(ROOT / 'tools')]
hardware_pages, real_firmware = import_module('hardware_pages'), import_module('real_firmware')
faults, read_stored = import_module('faults'), import_module('campaign').read_stored
PAGES = hardware_pages.PAGES
COMMIT = import_module('firmware').FIRMWARE.commit
BY_HAND = {'hardware.md'}


@pytest.mark.parametrize('page', PAGES, ids=lambda page: page.stem)
def test_a_page_is_that_of_the_stored_rows_or_called_stale(page):
    text = page.read_text(encoding='utf-8')
    if hardware_pages.is_stored(page):
        assert text == PAGES[page](), 'run make reference'
    else:
        assert '\n**Stale:** ' in text


def test_the_part_on_the_light_link_is_that_of_its_rows():
    if not hardware_pages.is_stored(faults.PAGE):
        stored = read_stored(faults.LIGHT_RECORD)
        text = faults.PAGE.read_text(encoding='utf-8')
        assert text.endswith('\n' + faults.compose_light_part(stored))


def test_the_tables_of_the_firmware_are_those_that_were_recorded():
    record = json.loads(real_firmware.RECORD.read_text())
    lines = real_firmware.PAGE.read_text(encoding='utf-8').splitlines()
    rows = [*real_firmware.ratio_rows(record), *real_firmware.scenario_rows(record)]
    assert rows
    assert set(rows) <= set(lines), 'run make real-firmware'
    assert real_firmware.PICTURE.read_text() == real_firmware.draw(record['builds'])


def test_every_page_names_the_commit_of_the_firmware():
    pages = set((ROOT / 'docs').glob('hardware*.md'))
    assert {page.name for page in pages} == {page.name for page in PAGES} | BY_HAND
    assert all(COMMIT[:12] in page.read_text(encoding='utf-8') for page in pages)


def test_the_sentence_on_damaged_frames_is_that_of_the_stored_counts():
    page = ' '.join((ROOT / 'docs/hardware.md').read_text(encoding='utf-8').split())
    assert import_module('mutated_frames').compose_sentence() in page
