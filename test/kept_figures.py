"""Rows of the paper from the figures that a run kept: docs/paper.md is held to them."""

from lta_studies.reproduce.stored_row import (
    decode_draws,
    decode_values,
    StoredPicture,
    StoredRow,
)


def kepts_in(found):
    """Return rows from their figures; the pictures without what is drawn."""
    return {
        name: StoredRow(
            decode_values(each['values']),
            [StoredPicture(**picture, figure='{}') for picture in each['pictures']],
            (),
            each['seeds'],
            each['seconds'],
            decode_draws(each.get('draws', {})),
        )
        for name, each in found['rows'].items()
    }
