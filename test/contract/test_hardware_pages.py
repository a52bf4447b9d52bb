"""The pages on hardware have what was recorded of the firmware, and name its version."""

from importlib import import_module
import json
from pathlib import Path
import sys

from campaigns.firmware import list_record, RECORD

ROOT = Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / 'tools'))
COMMIT = import_module('firmware').FIRMWARE.commit


def test_the_tables_of_the_firmware_are_those_that_were_recorded():
    page = (ROOT / 'docs/hardware_firmware.md').read_text(encoding='utf-8')
    recorded = '\n'.join(list_record(json.loads(RECORD.read_text())))
    assert recorded in page, 'run make campaign firmware'


def test_every_page_names_the_commit_of_the_firmware():
    for page in (ROOT / 'docs').glob('hardware*.md'):
        assert COMMIT[:12] in page.read_text(encoding='utf-8'), page
