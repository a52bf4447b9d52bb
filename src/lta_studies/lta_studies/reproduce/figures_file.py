"""Build the JSON output of a reproduction, in SI units."""

from collections.abc import Mapping, Sequence
from typing import Any

from lta_config.schema.paper_file import PaperRow
from lta_studies.reproduce import lines
from lta_studies.reproduce.stored_row import encode_values, StoredRow
from lta_studies.reproduce.verdict import judge_claims


def encode_figures(
    rows: Sequence[PaperRow], stored_rows: Mapping[str, StoredRow]
) -> dict[str, Any]:
    """Return the measured values (with interval and seeds) and pictures of the rows."""
    return {
        'counts': {
            str(name): count for name, count in lines.count_all_verdicts(rows, stored_rows).items()
        },
        'rows': {row.name: encode_row(row, stored_rows[row.name]) for row in rows},
    }


def encode_row(row: PaperRow, stored: StoredRow) -> dict[str, Any]:
    """Return the JSON object of a row."""
    return {
        'seeds': stored.seeds,
        'seconds': round(stored.seconds, 1),
        'verdicts': {name: str(each) for name, each in judge_claims(row, stored.values).items()},
        'values': encode_values(stored.values),
        'pictures': [
            {'name': each.name, 'heading': each.heading, 'caption': each.caption,
             'command': each.command, 'bag': each.bag}
            for each in stored.pictures
        ],
    }  # fmt: skip
