# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What the pages for people say is there, and the figures in them are those of the code."""

from importlib import import_module
import json
from pathlib import Path
from pkgutil import resolve_name
import re
import sys

from campaigns.firmware import list_record, RECORD
import lta_analysis
from lta_data.bag import RecordedFlight
from lta_graph.ros.node import REPORT_PERIOD, REPORTED_WAIT
from pandas import DataFrame
import pytest
import yaml

ROOT = Path(__file__).resolve().parents[2]
PAGES = [ROOT / 'README.md', ROOT / 'CONTRIBUTING.md', *sorted(ROOT.glob('docs/**/*.md'))]
LINK = re.compile(r'\]\(<?([^)\s>]+)>?(?:\s+"[^"]*")?\)|\b(?:src|href)="([^"]+)"')
MODULE = re.compile(r'`(lta_[a-z]+(?:\.\w+)+)(?:\(\))?`')
SCRIPT = re.compile(r'`((?:\w+/)*\w+\.py)`')
PYTHON = [path for folder in ('campaigns', 'config', 'examples', 'src', 'test', 'tools')
          for path in ROOT.glob(f'{folder}/**/*.py')]  # fmt: skip
NAMED = {'flight': RecordedFlight, 'odom': DataFrame, 'lta_analysis': lta_analysis}
ATTRIBUTE = re.compile(rf'`[^`\n]*?\b({"|".join(NAMED)})\.(\w+)\(')
HEADING = re.compile(r'^#+\s+(.*)$', re.MULTILINE)


def anchors(page):
    """Return the names of a page's headings as hosts of Markdown make them."""
    titles = HEADING.findall(page.read_text(encoding='utf-8'))
    return {re.sub(r'[^\w\- ]', '', title.lower()).replace(' ', '-') for title in titles}


def links(page):
    """Return the relative links and images of a page."""
    found = [''.join(pair) for pair in LINK.findall(page.read_text(encoding='utf-8'))]
    return [link for link in found if not re.match(r'[a-z]+:', link)]


@pytest.mark.parametrize('page', PAGES, ids=lambda page: page.name)
def test_every_relative_link_and_image_is_there(page):
    for link in links(page):
        path, _, anchor = link.partition('#')
        target = (page.parent / path).resolve() if path else page
        assert target.exists(), link
        assert target.is_relative_to(ROOT), link
        assert not anchor or anchor in anchors(target), link


@pytest.mark.parametrize('page', PAGES, ids=lambda page: page.name)
def test_every_module_and_file_of_python_that_a_page_names_is_there(page):
    text = page.read_text(encoding='utf-8')
    for name in MODULE.findall(text):
        resolve_name(name)
    files = [path.as_posix() for path in PYTHON]
    for name in SCRIPT.findall(text):
        assert any(file.endswith(f'/{name}') for file in files) or 'NAME' in name, name


@pytest.mark.parametrize('page', PAGES, ids=lambda page: page.name)
def test_every_attribute_of_a_recording_that_a_page_names_is_there(page):
    for name, attribute in ATTRIBUTE.findall(page.read_text(encoding='utf-8')):
        assert hasattr(NAMED[name], attribute), f'{name}.{attribute}'


def test_a_page_has_links_to_look_at():
    assert 'docs/architecture.md' in links(ROOT / 'README.md')


def test_rates_of_health_are_those_of_the_nodes():
    text = ' '.join((ROOT / 'docs/inside.md').read_text(encoding='utf-8').split())
    assert f'reports in `/diagnostics` every {REPORT_PERIOD} s of wall time' in text
    assert f'one that waits longer than {REPORTED_WAIT} s names its missing inputs' in text


def test_every_picture_has_the_command_that_draws_it():
    drawn = re.findall(r'^draw (\w+)', (ROOT / 'tools/pictures.sh').read_text(), re.MULTILINE)
    there = {path.stem for path in (ROOT / 'docs/images').glob('*.png')}
    # Composed by hand: planes of a page, and the table of `make campaign sphere`
    assert there - set(drawn) == {'cfd_slices', 'cfd_sphere'}
    assert set(drawn) <= there


KINDS = ['Tutorials', 'How to', 'Reference', 'Explanation']
SITE = yaml.safe_load((ROOT / 'mkdocs.yml').read_text(encoding='utf-8'))


def pages(nav):
    """Yield the files of a part of the navigation, in order."""
    for entry in nav:
        for inner in entry.values() if isinstance(entry, dict) else [entry]:
            yield from pages(inner) if isinstance(inner, list) else [inner]


def test_the_kinds_are_the_four():
    titles = [title for entry in SITE['nav'] for title in entry]
    assert titles == ['Start', *KINDS]


def test_every_page_stands_in_the_navigation_once():
    """A new page gets one line in mkdocs.yml, below its kind."""
    listed = list(pages(SITE['nav']))
    there = [str(path.relative_to(ROOT / 'docs')) for path in ROOT.glob('docs/**/*.md')]
    assert sorted(listed) == sorted([*there, 'CONTRIBUTING.md', 'CHANGELOG.md'])


def test_nothing_is_fetched_from_elsewhere():
    assert SITE['theme']['font'] is False
    assert SITE['plugins'] == ['search']
    assert not {'extra_css', 'extra_javascript', 'extra'} & SITE.keys()


@pytest.mark.parametrize('name', ['mkdocs', 'mkdocs-material'])
def test_what_builds_the_site_is_pinned_and_apart(name):
    lines = (ROOT / 'requirements-docs.txt').read_text(encoding='utf-8').splitlines()
    assert all('==' in line for line in lines if not line.startswith('#'))
    assert any(line.startswith(f'{name}==') for line in lines)
    tests = (ROOT / 'requirements-test.txt').read_text(encoding='utf-8')
    assert name not in tests.split()


sys.path.append(str(ROOT / 'tools'))
COMMIT = import_module('firmware').FIRMWARE.commit


def test_the_tables_of_the_firmware_are_those_that_were_recorded():
    page = (ROOT / 'docs/hardware_firmware.md').read_text(encoding='utf-8')
    recorded = '\n'.join(list_record(json.loads(RECORD.read_text())))
    assert recorded in page, 'run make campaign firmware'


def test_every_page_names_the_commit_of_the_firmware():
    for page in (ROOT / 'docs').glob('hardware*.md'):
        assert COMMIT[:12] in page.read_text(encoding='utf-8'), page
