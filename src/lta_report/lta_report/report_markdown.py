"""Write blocks of a report as Markdown, for the pages of docs/."""

from collections.abc import Iterator, Sequence
from typing import Final

from lta_report.formatting import format_markdown_table
from lta_report.report import Block, Grid, Picture, ReportSection, TextSection, TextTable

LEVEL: Final = 2  # of headings, below the title


def render_markdown(blocks: Sequence[Block], images: str = '', level: int = LEVEL) -> str:
    """
    Return blocks as Markdown.

    Folded sections and empty tables are left out. Of a grid, only the first picture is shown, with
    the commands and bags of all of them.

    `blocks`: part of a report. `images`: folder of the pictures, which `--pictures` writes.
    `level`: level of the headings.
    """
    return '\n\n'.join(part for each in blocks for part in iterate_parts(each, images, level))


def iterate_parts(block: Block, images: str, level: int) -> Iterator[str]:
    """Yield heading and paragraphs of a block."""
    match block:
        case ReportSection(folded=False):
            yield from format_heading(block.heading, level)
            for each in block.blocks:
                yield from iterate_parts(each, images, level + 1)
        case TextTable() if block.rows:
            yield from format_heading(block.heading, level)
            yield format_markdown_table(block.heads, block.rows)
            if block.note:
                yield block.note
        case TextSection():
            yield from format_heading(block.heading, level)
            if block.bullets:
                yield '\n'.join(f'- {each}' for each in block.paragraphs)
            else:
                yield from block.paragraphs
        case Picture():
            yield from format_pictures([block], images)
        case Grid():
            pictures = [each for each in block.blocks if isinstance(each, Picture)]
            yield from format_pictures(pictures, images)
            for each in block.blocks:
                if not isinstance(each, Picture):
                    yield from iterate_parts(each, images, level)
        case _:
            pass


def format_heading(heading: str, level: int) -> list[str]:
    """Return a heading; nothing if it is empty."""
    return [f'{"#" * level} {heading}'] if heading else []


def format_pictures(pictures: Sequence[Picture], images: str) -> Iterator[str]:
    """Yield the first picture with its caption, then the commands and bags of all pictures."""
    for first in pictures[:1]:
        yield f'![{first.heading}]({images}/{first.name}.png)'
        yield f'*{first.heading}. {first.caption}*'
    # Several pictures may share a command or a bag
    commands = dict.fromkeys(f'`{each.command}`' for each in pictures if each.command)
    bags = dict.fromkeys(f'`{each.bag}`' for each in pictures if each.bag)
    if commands:
        yield f'Commands for its pictures: {"; ".join(commands)}.'
    if bags:
        yield f'Bags: {", ".join(bags)}.'
