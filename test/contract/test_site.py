"""`make docs`: every page stands in one of the four kinds, and the site fetches nothing."""

from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).resolve().parents[2]
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
