"""The pages on hardware are those of the stored rows, and name the firmware that was tried."""

from importlib import import_module
import json
from pathlib import Path
import sys

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path += [str(ROOT / 'test/score'), str(ROOT / 'tools')]
hardware_pages, real_firmware = import_module('hardware_pages'), import_module('real_firmware')
faults, campaign = import_module('faults'), import_module('campaign')
end_to_end, read_stored = import_module('end_to_end'), campaign.read_stored
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


def test_a_campaign_of_the_light_link_replaces_its_rows_only():
    case = campaign.Case('light lost', 0)
    row = {'wrong': 'a stamp is off'}
    facts, before = read_stored(faults.RECORD)
    replaced = faults.replace_light_rows({case: row})
    assert replaced.facts == facts
    assert replaced.rows[case] == row
    flights = {key: each for key, each in before.items() if key.kind not in faults.LIGHT_KINDS}
    assert len(replaced.rows) == len(flights) + 1
    assert flights.items() <= replaced.rows.items()


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


def test_a_flight_that_hung_counts_and_each_row_names_its_commit():
    hung = {'wrong': campaign.HANGS, 'took': None, 'timing': False, 'again': 0}
    code = {'code': '0123456789ab', 'slower': 1}
    new = {**code, 'commit': '54f31e243a0b28b67efef5ba20dbb6d9890a5478-dirty'}
    well = {'wrong': '', 'took': 1.25, 'timing': False, 'again': 0, 'late': 0.1}
    case = campaign.Case
    rows = {case('silent', 0): well | code, case('silent', 2): hung | new}
    assert campaign.codes(rows) == (
        '1 of code 0123456789ab, 1 of code 0123456789ab at commit 54f31e243a0b with changes, '
        '1 hung'
    )
    page = faults.compose_page(campaign.StoredCampaign({'firmware': COMMIT}, rows))
    (row,) = [line for line in page.splitlines() if line.startswith('| no packets, both')]
    assert row.endswith('| 0.3 s; 1.2 s | not flown | 1 of 2 |')
    assert '- no packets, both directions, flight 2: it hung.\n' in page
    only = faults.compose_page(
        campaign.StoredCampaign({'firmware': COMMIT}, {case('silent', 2): hung | new})
    )
    assert '| 0.3 s; - | not flown | 0 of 1 |' in only
    flights = end_to_end.compose_page(
        campaign.StoredCampaign(
            {'firmware': COMMIT, 'emulator': 'QEMU 7.2.22'},
            {case(end_to_end.EMULATED, 13): hung | new},
        )
    )
    assert '| 13 | - | - | - | - | - |\n' in flights
    assert '**0 of 1 flights reached the lamp' in flights
