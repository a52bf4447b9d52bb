"""What the pages for people say is there, and the figures in them are those of the code."""

from pathlib import Path
from pkgutil import resolve_name
import re

import lta_analysis
from lta_data.bag import RecordedFlight
from lta_graph.ros.node import REPORT_PERIOD, REPORTED_WAIT
from pandas import DataFrame
import pytest

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
    drawn = re.findall(r'^draw \w+ (\w+)', (ROOT / 'tools/pictures.sh').read_text(), re.MULTILINE)
    there = {path.stem for path in (ROOT / 'docs/images').glob('*.png')}
    # Composed of a page's planes by hand
    assert there - set(drawn) == {'cfd_slices'}
    assert set(drawn) <= there
