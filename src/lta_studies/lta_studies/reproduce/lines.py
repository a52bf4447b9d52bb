"""The reproduction as lines of text: what page, docs and terminal share."""

from collections.abc import Mapping, Sequence
from typing import Final

from lta_config.schema.paper_file import Claim, names, PaperRow
from lta_report.formatting import MISSING
from lta_studies.reproduce.kept import Kept
from lta_studies.reproduce.verdict import (
    counted,
    filled,
    quantity,
    rule_words,
    told,
    Verdict,
    verdicts,
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
SUMMARY_HEADS: Final = ('row', *Verdict)
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

Kepts = Mapping[str, Kept]
Lines = list[list[str]]


def totals(rows: Sequence[PaperRow], kepts: Kepts) -> dict[Verdict, int]:
    """Return how many claims of all rows came to what."""
    return counted(each for row in rows for each in verdicts(row, kepts[row.name].values).values())


def title(rows: Sequence[PaperRow], kepts: Kepts) -> str:
    """Return what came out, in a sentence."""
    found = totals(rows, kepts)
    count = sum(found.values()) - found[Verdict.BEYOND]
    text = (
        f"Of the paper's {count} claims, {found[Verdict.AGREES]} agree, "
        f'{found[Verdict.DIFFERS]} differ and {found[Verdict.UNTESTED]} cannot be tested here'
    )
    left = found[Verdict.LEFT_OUT]
    return f'{text}; {left} were left out of --quick.' if left else f'{text}.'


def summary(rows: Sequence[PaperRow], kepts: Kepts) -> Lines:
    """Return a line a row: how many of its claims came to what."""
    lines = []
    for row in rows:
        found = counted(verdicts(row, kepts[row.name].values).values())
        lines.append([f'{row.number}. {row.title}', *(str(each) for each in found.values())])
    return [*lines, ['all', *(str(each) for each in totals(rows, kepts).values())]]


def claims(row: PaperRow, kept: Kept) -> Lines:
    """Return a line a claim."""
    found = verdicts(row, kept.values)
    return [
        [
            claim.says,
            claim.where + SOURCES[claim.source],
            MISSING if claim.value is None else quantity(claim.value),
            MISSING if claim.rule is None else rule_words(claim.rule),
            here(row, claim, kept),
            seeds(claim, kept),
            str(found[name]),
        ]
        for name, claim in row.claims.items()
    ]


def here(row: PaperRow, claim: Claim, kept: Kept) -> str:
    """Return what was measured for a claim."""
    if claim.measure is None:
        return MISSING
    return told(row.measures[claim.measure], kept.values.get(claim.measure))


def seeds(claim: Claim, kept: Kept) -> str:
    """Return of how many seeds that is."""
    value = kept.values.get(claim.measure or '')
    return MISSING if value is None else str(value.seeds)


def notes(row: PaperRow, kept: Kept) -> list[tuple[str, str, str]]:
    """Return what came out of each claim: the claim, the finding, and what would close its gap."""
    found = verdicts(row, kept.values)
    lines = []
    for name, claim in row.claims.items():
        words = claim.untested or claim.finding
        gap = claim.gap if found[name] is Verdict.DIFFERS else ''
        told = [
            filled(text, row, kept.values) if names(text) <= kept.values.keys() else ''
            for text in (words, gap)  # --quick leaves measures out
        ]
        lines.append((claim.says, told[0], told[1]))
    return lines


def defects(rows: Sequence[PaperRow]) -> Lines:
    """Return a line a defect of the paper, its arithmetic worked out."""
    return [
        [str(row.number), each.says, each.arithmetic, each.here]
        for row in rows
        for each in row.defects.values()
    ]


def series(rows: Sequence[PaperRow], kepts: Kepts) -> Lines:
    """Return a line a figure of the paper: what its printed numbers say of what is missing."""
    return [
        [str(row.number), each.figure, each.printed, told_of(each.said, row, kepts[row.name])]
        for row in rows
        for each in row.series.values()
    ]


def told_of(text: str, row: PaperRow, kept: Kept) -> str:
    """Return a text with its measures in their places; where --quick left one out, nothing."""
    return filled(text, row, kept.values) if names(text) <= kept.values.keys() else MISSING


def deviations(rows: Sequence[PaperRow]) -> Lines:
    """Return what rows change of vehicle, gains, lamp and room."""
    return [[f'{row.number}. {row.title}', each] for row in rows for each in row.deviations]


def measures(row: PaperRow, kept: Kept) -> Lines:
    """Return a line a measure."""
    return [
        [measure.what, told(measure, kept.values[name]), str(kept.values[name].seeds)]
        for name, measure in row.measures.items()
        if name in kept.values
    ]
