# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Bring what pages link to outside docs/ into the site: examples, and the pages at the root.

A hook of MkDocs, which knows docs/ alone. Links of the sources are those that hold in the
repository; in the site the root and docs/ are one folder.
"""

from pathlib import Path
import re

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

ROOT = Path(__file__).resolve().parents[1]
PAGES = ('CONTRIBUTING.md', 'CHANGELOG.md')
OUTSIDE = re.compile(r'(?<=\]\()(?:\.\./)+((?:examples|config|src|test)/[^)#\s]+)')


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the pages of the root, and every file that a page links to outside docs/."""
    linked = {
        name
        for page in ROOT.glob('docs/**/*.md')
        for name in OUTSIDE.findall(page.read_text(encoding='utf-8'))
    }
    for name in (*PAGES, *sorted(linked)):
        files.append(File.generated(config, name, abs_src_path=str(ROOT / name)))
    return files


def on_page_markdown(markdown: str, page: Page, **_: object) -> str:
    """Return a page with its links as they are in the site."""
    if page.file.src_uri in PAGES:
        return markdown.replace('](docs/', '](').replace('](README.md', '](index.md')
    up = '../' * page.file.src_uri.count('/')
    text = OUTSIDE.sub(lambda found: up + found[1], markdown)
    return re.sub(r'(?<=\]\()(?:\.\./)+(?=(?:CONTRIBUTING|CHANGELOG)\.md)', up, text)
