"""The figures of a run as JSON, SI units."""

from collections.abc import Mapping, Sequence
from typing import Any

from lta_config.schema.paper_file import PaperRow
from lta_studies.reproduce import lines
from lta_studies.reproduce.kept import Kept, plain
from lta_studies.reproduce.verdict import verdicts


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
