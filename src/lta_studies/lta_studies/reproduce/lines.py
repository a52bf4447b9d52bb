"""Build the texts and table rows that page, docs and terminal share."""

from collections.abc import Mapping, Sequence
from typing import Final

from lta_config.schema.paper_file import find_measure_names, PaperClaim, PaperRow
from lta_report.formatting import MISSING
from lta_studies.reproduce.stored_row import StoredRow
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
DEFECT_HEADS: Final = ('row', 'the paper says', 'arithmetic', 'here')
SERIES_HEADS: Final = ('row', 'figure', 'printed numbers', 'conclusion')
MEASURE_HEADS: Final = ('measure', 'here', 'seeds')
# Remark after the place of a claim, by the source of its number
SOURCES: Final = {
    'printed': '',
    'read': ' (read from text)',
    'comment': ' (LaTeX comment)',
    'future': '',
}
METHOD: Final = (
    'A claim agrees if the measured value satisfies the rule in its row; the rules were '
    'fixed in files before any run. Means over seeds have 95 % intervals in brackets '
    '(Student for means, Wilson for shares). For each claim that "cannot be tested here", '
    'the reason is given. All rows use the same GT-MAB file, gains, lamp and room; '
    'deviations are listed.'
)

DISCOVERY: Final = (
    'Discovery (`lta discover`) finds a missing effect from the commands and the motion of '
    'recorded flights. The paper shows its curves only as pictures and does not publish '
    'their data, so only the printed numbers remain. A cause is fitted to some of these '
    'numbers and tested on the others, as discovery does with flights. A cause that '
    'explains only one number is marked as a guess.'
)

Kepts = Mapping[str, StoredRow]
Lines = list[list[str]]


def count_all_verdicts(rows: Sequence[PaperRow], stored_rows: Kepts) -> dict[ClaimVerdict, int]:
    """Count the verdicts of all claims."""
    return count_verdicts(
        each for row in rows for each in judge_claims(row, stored_rows[row.name].values).values()
    )


def format_headline(rows: Sequence[PaperRow], stored_rows: Kepts) -> str:
    """Return the headline with the counts of the verdicts."""
    found = count_all_verdicts(rows, stored_rows)
    # Results beyond the paper are not claims of the paper.
    count = sum(found.values()) - found[ClaimVerdict.BEYOND]
    text = (
        f"Of the paper's {count} claims, {found[ClaimVerdict.AGREES]} agree, "
        f'{found[ClaimVerdict.DIFFERS]} differ and {found[ClaimVerdict.UNTESTED]} cannot be '
        f'tested here'
    )
    left = found[ClaimVerdict.LEFT_OUT]
    return f'{text}; --quick leaves out {left}.' if left else f'{text}.'


def build_summary_rows(rows: Sequence[PaperRow], stored_rows: Kepts) -> Lines:
    """Return one table row per study with the counts of its verdicts."""
    lines = []
    for row in rows:
        found = count_verdicts(judge_claims(row, stored_rows[row.name].values).values())
        lines.append([f'{row.number}. {row.title}', *(str(each) for each in found.values())])
    return [
        *lines,
        ['all', *(str(each) for each in count_all_verdicts(rows, stored_rows).values())],
    ]


def build_claim_rows(row: PaperRow, stored: StoredRow) -> Lines:
    """Return one table row per claim."""
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
    """Format the measured value of a claim."""
    if claim.measure is None:
        return MISSING
    return format_value(row.measures[claim.measure], stored.values.get(claim.measure))


def format_seeds(claim: PaperClaim, stored: StoredRow) -> str:
    """Format the number of seeds of a claim's value."""
    value = stored.values.get(claim.measure or '')
    return MISSING if value is None else str(value.seeds)


def list_claim_findings(row: PaperRow, stored: StoredRow) -> list[tuple[str, str, str]]:
    """Return each claim with its finding and what would close its gap."""
    found = judge_claims(row, stored.values)
    lines = []
    for name, claim in row.claims.items():
        # Why it cannot be tested, else what was found
        words = claim.untested or claim.finding
        # Only a difference has a gap to close.
        gap = claim.gap if found[name] is ClaimVerdict.DIFFERS else ''
        texts = [
            fill_measures(text, row, stored.values)
            if find_measure_names(text) <= stored.values.keys()
            else ''
            for text in (words, gap)  # --quick leaves measures out
        ]
        lines.append((claim.says, texts[0], texts[1]))
    return lines


def build_defect_rows(rows: Sequence[PaperRow]) -> Lines:
    """Return one table row per defect of the paper, with its arithmetic."""
    return [
        [str(row.number), each.says, each.arithmetic, each.here]
        for row in rows
        for each in row.defects.values()
    ]


def build_paper_figure_rows(rows: Sequence[PaperRow], stored_rows: Kepts) -> Lines:
    """Return one table row per figure of the paper: its printed numbers and the conclusion."""
    return [
        [
            str(row.number),
            each.figure,
            each.printed,
            fill_measures_or_dash(each.said, row, stored_rows[row.name]),
        ]
        for row in rows
        for each in row.series.values()
    ]


def fill_measures_or_dash(text: str, row: PaperRow, stored: StoredRow) -> str:
    """Fill in the measures of a text; a dash if --quick left one out."""
    return (
        fill_measures(text, row, stored.values)
        if find_measure_names(text) <= stored.values.keys()
        else MISSING
    )


def build_deviation_rows(rows: Sequence[PaperRow]) -> Lines:
    """Return the deviations of each row from the shared vehicle, gains, lamp and room."""
    return [[f'{row.number}. {row.title}', each] for row in rows for each in row.deviations]


def build_measure_rows(row: PaperRow, stored: StoredRow) -> Lines:
    """Return one table row per measure."""
    return [
        [measure.what, format_value(measure, stored.values[name]), str(stored.values[name].seeds)]
        for name, measure in row.measures.items()
        if name in stored.values
    ]
