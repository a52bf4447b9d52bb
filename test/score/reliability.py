"""docs/reliability.md, of which each command writes its own part."""

from pathlib import Path
from typing import Final

PAGE: Final = Path(__file__).resolve().parents[2] / 'docs/reliability.md'
TITLE: Final = '# Reliability\n'
PARTS: Final = ('chaos', 'soak')  # in the order of the page


def put(part: str, text: str) -> None:
    """
    Write one part of the page; leave the others, and what people wrote above them, as they are.

    `part`: of `PARTS`. `text`: markdown that begins with a heading of the second level.
    """
    page = PAGE.read_text(encoding='utf-8') if PAGE.exists() else TITLE
    marked = [page.index(mark(name)) for name in PARTS if mark(name) in page]
    above = page[: min(marked, default=len(page))].rstrip('\n')
    found = {name: between(page, name) for name in PARTS} | {part: text.strip('\n')}
    blocks = [
        f'\n{mark(name)}\n\n{found[name]}\n\n{mark(name)}\n' for name in PARTS if found[name]
    ]
    PAGE.write_text(above + '\n' + ''.join(blocks), encoding='utf-8')


def between(page: str, part: str) -> str:
    """Return what stands between the marks of a part, empty where there are none."""
    pieces = page.split(mark(part))
    return pieces[1].strip('\n') if len(pieces) == 3 else ''


def mark(part: str) -> str:
    """Return what stands before and behind a part."""
    return f'<!-- written by make {part} -->'
