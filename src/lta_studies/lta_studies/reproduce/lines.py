"""The reproduction as lines of text: what page, docs and terminal share."""

from collections.abc import Mapping, Sequence
from typing import Final

from lta_config.schema.paper_file import find_measure_names, PaperClaim, PaperRow
from lta_report.formatting import MISSING
from lta_studies.reproduce.row_store import StoredRow
from lta_studies.reproduce.verdict import (
    ClaimVerdict,
    count_verdicts,
    fill_measures,
    format_quantity,
    format_rule,
    format_value,
    judge_claims,
)

CLAIM_HEADS: Final = (
    'the paper says',
    'where',
    'printed',
    'agrees if',
    'here',
    'seeds',
    'verdict',
)
SUMMARY_HEADS: Final = ('row', *ClaimVerdict)
DEFECT_HEADS: Final = ('row', 'the paper says', 'what follows', 'here')
SERIES_HEADS: Final = ('row', 'figure', 'what of it is printed', 'what follows')
MEASURE_HEADS: Final = ('measure', 'here', 'seeds')
SOURCES: Final = {
    'printed': '',
    'read': ' (read from text)',
    'comment': ' (LaTeX comment)',
    'future': '',
}
METHOD: Final = (
    'A claim agrees if what was measured keeps the rule beside it, which its file fixed before '
    'anything was run. Means over seeds have 95 % intervals in brackets (Student for means, '
    'Wilson for shares). "Cannot be tested here" says why. One GT-MAB file, one set of gains, one '
    'lamp and one room serve all rows; what a row changes is listed.'
)

DISCOVERY: Final = (
    'Discovery (`lta discover`) names a missing effect from flights: commands and motion by time. '
    "The paper's curves are pictures, and none of their data is published. What is left are "
    'printed numbers: a cause is sized on some of them and held against the others, which is how '
    'discovery confirms, too. A cause that explains one number alone is a guess, and called so.'
)

Kepts = Mapping[str, StoredRow]
Lines = list[list[str]]


def count_all_verdicts(rows: Sequence[PaperRow], stored_rows: Kepts) -> dict[ClaimVerdict, int]:
    """Return how many claims of all rows came to what."""
    return count_verdicts(
        each for row in rows for each in judge_claims(row, stored_rows[row.name].values).values()
    )


def format_title(rows: Sequence[PaperRow], stored_rows: Kepts) -> str:
    """Return what came out, in a sentence."""
    found = count_all_verdicts(rows, stored_rows)
    count = sum(found.values()) - found[ClaimVerdict.BEYOND]
    text = (
        f"Of the paper's {count} claims, {found[ClaimVerdict.AGREES]} agree, "
        f'{found[ClaimVerdict.DIFFERS]} differ and {found[ClaimVerdict.UNTESTED]} cannot be '
        f'tested here'
    )
    left = found[ClaimVerdict.LEFT_OUT]
    return f'{text}; {left} were left out of --quick.' if left else f'{text}.'


def build_summary_lines(rows: Sequence[PaperRow], stored_rows: Kepts) -> Lines:
    """Return a line a row: how many of its claims came to what."""
    lines = []
    for row in rows:
        found = count_verdicts(judge_claims(row, stored_rows[row.name].values).values())
        lines.append([f'{row.number}. {row.title}', *(str(each) for each in found.values())])
    return [
        *lines,
        ['all', *(str(each) for each in count_all_verdicts(rows, stored_rows).values())],
    ]


def build_claim_lines(row: PaperRow, stored: StoredRow) -> Lines:
    """Return a line a claim."""
    found = judge_claims(row, stored.values)
    return [
        [
            claim.says,
            claim.where + SOURCES[claim.source],
            MISSING if claim.value is None else format_quantity(claim.value),
            MISSING if claim.rule is None else format_rule(claim.rule),
            format_measurement(row, claim, stored),
            format_seeds(claim, stored),
            str(found[name]),
        ]
        for name, claim in row.claims.items()
    ]


def format_measurement(row: PaperRow, claim: PaperClaim, stored: StoredRow) -> str:
    """Return what was measured for a claim."""
    if claim.measure is None:
        return MISSING
    return format_value(row.measures[claim.measure], stored.values.get(claim.measure))


def format_seeds(claim: PaperClaim, stored: StoredRow) -> str:
    """Return of how many seeds that is."""
    value = stored.values.get(claim.measure or '')
    return MISSING if value is None else str(value.seeds)


def build_notes(row: PaperRow, stored: StoredRow) -> list[tuple[str, str, str]]:
    """Return what came out of each claim: the claim, the finding, and what would close its gap."""
    found = judge_claims(row, stored.values)
    lines = []
    for name, claim in row.claims.items():
        words = claim.untested or claim.finding
        gap = claim.gap if found[name] is ClaimVerdict.DIFFERS else ''
        told = [
            fill_measures(text, row, stored.values)
            if find_measure_names(text) <= stored.values.keys()
            else ''
            for text in (words, gap)  # --quick leaves measures out
        ]
        lines.append((claim.says, told[0], told[1]))
    return lines


def build_defect_lines(rows: Sequence[PaperRow]) -> Lines:
    """Return a line a defect of the paper, its arithmetic worked out."""
    return [
        [str(row.number), each.says, each.arithmetic, each.here]
        for row in rows
        for each in row.defects.values()
    ]


def build_series_lines(rows: Sequence[PaperRow], stored_rows: Kepts) -> Lines:
    """Return a line a figure of the paper: what its printed numbers say of what is missing."""
    return [
        [
            str(row.number),
            each.figure,
            each.printed,
            fill_text(each.said, row, stored_rows[row.name]),
        ]
        for row in rows
        for each in row.series.values()
    ]


def fill_text(text: str, row: PaperRow, stored: StoredRow) -> str:
    """Return a text with its measures in their places; where --quick left one out, nothing."""
    return (
        fill_measures(text, row, stored.values)
        if find_measure_names(text) <= stored.values.keys()
        else MISSING
    )


def build_deviation_lines(rows: Sequence[PaperRow]) -> Lines:
    """Return what rows change of vehicle, gains, lamp and room."""
    return [[f'{row.number}. {row.title}', each] for row in rows for each in row.deviations]


def build_measure_lines(row: PaperRow, stored: StoredRow) -> Lines:
    """Return a line a measure."""
    return [
        [measure.what, format_value(measure, stored.values[name]), str(stored.values[name].seeds)]
        for name, measure in row.measures.items()
        if name in stored.values
    ]
