"""The figures of a run as JSON, SI units."""

from collections.abc import Mapping, Sequence
from typing import Any

from lta_analysis.reproduce import lines
from lta_analysis.reproduce.kept import Kept, plain
from lta_analysis.reproduce.verdict import verdicts
from lta_config.paper_file import PaperRow


def content(rows: Sequence[PaperRow], kepts: Mapping[str, Kept]) -> dict[str, Any]:
    """Return the figures of some rows: value, ends of its interval, seeds; and the pictures."""
    return {
        'counts': {str(name): count for name, count in lines.totals(rows, kepts).items()},
        'rows': {row.name: of_row(row, kepts[row.name]) for row in rows},
    }


def of_row(row: PaperRow, kept: Kept) -> dict[str, Any]:
    """Return the figures of a row."""
    return {
        'seeds': kept.seeds,
        'seconds': round(kept.seconds, 1),
        'verdicts': {name: str(each) for name, each in verdicts(row, kept.values).items()},
        'values': plain(kept.values),
        'pictures': [
            {'name': each.name, 'heading': each.heading, 'caption': each.caption,
             'command': each.command, 'bag': each.bag}
            for each in kept.pictures
        ],
    }  # fmt: skip
