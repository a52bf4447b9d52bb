# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Rows of the paper from the figures that a run kept: docs/paper.md is held to them."""

import math

from lta_studies.reproduce.study_result import DrawSummary, MeasuredValue, StoredRow, StudyPicture
from plotly.graph_objects import Figure


def restored(kind, content):
    """Return a named tuple from its JSON list, with null as NaN."""
    return kind(*(math.nan if each is None else each for each in content))


def kepts_in(found):
    """Return rows from their figures; the pictures without what is drawn."""
    return {
        name: StoredRow(
            {key: restored(MeasuredValue, value) for key, value in each['values'].items()},
            [StudyPicture(**picture, figure=Figure()) for picture in each['pictures']],
            (),
            each['seeds'],
            each['seconds'],
            {
                claim: {key: restored(DrawSummary, one) for key, one in measures.items()}
                for claim, measures in each.get('draws', {}).items()
            },
        )
        for name, each in found['rows'].items()
    }
