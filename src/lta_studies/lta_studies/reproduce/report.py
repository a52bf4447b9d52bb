# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Build the report of a reproduction; `tools/paper_pages.py` has the pages of docs/."""

from collections.abc import Iterator, Mapping, Sequence
import math
from typing import Any, Final

from lta_config.schema.paper_file import find_measure_names, PaperRow
from lta_report.formatting import MISSING, Tile
from lta_report.json_value import replace_nonfinite
from lta_report.report import (
    Block,
    CellColor,
    Emphasis,
    Grid,
    Picture,
    Report,
    ReportSection,
    TextSection,
    TextTable,
)
from lta_studies.reproduce.study_result import encode_values, StoredRow
from lta_studies.reproduce.verdict import (
    ClaimVerdict,
    count_verdicts,
    fill_measures,
    format_draws,
    format_quantity,
    format_rule,
    format_value,
    judge_claims,
)

StoredRows = Mapping[str, StoredRow]
CLAIM_HEADS: Final = (
    'the paper says', 'where', 'printed', 'agrees if', 'here', 'seeds', 'drawn', 'verdict',
)  # fmt: skip
COLORS: Final[Mapping[str, CellColor]] = {
    ClaimVerdict.AGREES: 'good', ClaimVerdict.DIFFERS: 'bad',
    ClaimVerdict.UNTESTED: 'soft', ClaimVerdict.LEFT_OUT: 'soft', ClaimVerdict.READING: 'soft',
    ClaimVerdict.CHANCE: 'soft', ClaimVerdict.NUMBERS: 'soft',
    ClaimVerdict.CONSTRUCTION: 'soft', ClaimVerdict.VACUOUS: 'soft',
}  # fmt: skip
# Remark after the place of a claim, by the source of its number
SOURCES: Final = {'printed': '', 'read': ' (read from text)', 'comment': ' (LaTeX comment)'}
OPEN: Final = (ClaimVerdict.READING, ClaimVerdict.CHANCE, ClaimVerdict.NUMBERS)
REPRODUCTION_ABOUT: Final = (
    'Every experiment of the paper (Huang et al. 2025), repeated in this system: what the '
    'paper says, what we get, and why they differ.'
)
JUDGING_METHOD: Final = (
    'The measures are those of the files as they are, with 95 % intervals over the seeds in '
    'brackets (Student for means, Wilson for shares). Then every number that is assumed, in the '
    'vehicle, in the cells, in the lights and in what the paper does not print of its scenes, is '
    'drawn from the range that its file gives, and measured again, each draw with a seed of its '
    'own. A reading of a claim agrees if its rule surely holds in 95 % of the draws (lower end of '
    "Wilson's interval), and differs if it surely fails in 95 % of them; a claim needs all of its "
    'readings. The rest is open, for one of three reasons: readings of the words contradict each '
    'other; single flights were flown, whose chance decides; or our numbers are not known well '
    'enough. Where the paper prints a figure of one flight, it differs only if it is outside of '
    'the interval of nine of ten flights that arrive; those that do not are counted apart. A '
    'strategy flies three times in each draw, which has the rate of these flights. Where a rate '
    'of success is claimed and each draw flies once, so few flights may go the other way '
    "that, by Markov's inequality, 95 % of the draws have the rate. Claims that hold by "
    'construction, and agreements that say nothing because anything would agree, are counted '
    'apart. For each claim that cannot be tested, the reason is given.'
)
KNOWN_BEFORE: Final = (
    'What was known when: the rules were written with the rows, on 2026-11-21, after the commands '
    'for photodiodes, strategies, platforms, mounting, cells and energy had been run; those of '
    'rows 5, 7 and 11 when their results were known. Ranges and readings were added on '
    '2026-11-26. On 2026-11-29, with all results known, verdicts came to need intervals, and '
    'claims that test our assumptions and not the paper were withdrawn; no rule was changed.'
)
UNDRAWN: Final = (
    '**These measures are of a run without draws, and in part of older code: the verdicts of this '
    'row are preliminary. lta reproduce measures it again.**'
)


def build_report(rows: Sequence[PaperRow], stored_rows: StoredRows) -> Report:
    """Return the report of a reproduction."""
    return Report(
        command='reproduce',
        subject='the paper',
        headline=format_headline(rows, stored_rows),
        introduction=REPRODUCTION_ABOUT,
        tiles=build_tiles(rows, stored_rows),
        blocks=(
            build_summary_table(rows, stored_rows),
            TextSection('How claims are judged', (JUDGING_METHOD, KNOWN_BEFORE)),
            *(block for row in rows for block in iterate_row_blocks(row, stored_rows[row.name])),
            build_defect_table(rows),
            TextTable(
                'Deviations from the shared vehicle, gains, lamp and room',
                ('row', 'deviation'),
                [[format_title(row), each] for row in rows for each in row.deviations],
                printed=False,
            ),
        ),
        data=to_json(rows, stored_rows),
        facts={'rows': str(len(rows))},
        json_name='paper.json',
    )


def count_all_verdicts(
    rows: Sequence[PaperRow], stored_rows: StoredRows
) -> dict[ClaimVerdict, int]:
    """Count the verdicts of all claims."""
    return count_verdicts(
        each for row in rows for each in judge_claims(row, stored_rows[row.name]).values()
    )


def format_headline(rows: Sequence[PaperRow], stored_rows: StoredRows) -> str:
    """Return the headline with the counts of the verdicts."""
    counts = count_all_verdicts(rows, stored_rows)
    count = sum(counts.values())
    agreeing = sum(
        counts[each]
        for each in (ClaimVerdict.AGREES, ClaimVerdict.CONSTRUCTION, ClaimVerdict.VACUOUS)
    )
    open_ = [counts[each] for each in OPEN]
    text = (
        f"Of the paper's {count} claims, {agreeing} agree ({counts[ClaimVerdict.CONSTRUCTION]} by "
        f'construction, {counts[ClaimVerdict.VACUOUS]} where anything would), '
        f'{counts[ClaimVerdict.DIFFERS]} differ, {sum(open_)} are open (how the paper is read '
        f'{open_[0]}, chance of single flights {open_[1]}, our numbers {open_[2]}) and '
        f'{counts[ClaimVerdict.UNTESTED]} cannot be tested'
    )
    left = counts[ClaimVerdict.LEFT_OUT]
    text += f'; {left} were not measured in this run.' if left else '.'
    undrawn = [str(row.number) for row in rows if is_undrawn(row, stored_rows[row.name])]
    if not undrawn:
        return text
    if len(undrawn) == 1:
        return f'{text} Row {undrawn[0]} was not drawn yet: its verdicts are preliminary.'
    return f'{text} Rows {", ".join(undrawn)} were not drawn yet: their verdicts are preliminary.'


def is_undrawn(row: PaperRow, stored: StoredRow) -> bool:
    """Return whether a row that is drawn by its file was stored without draws."""
    return bool(row.draws.full) and not stored.draws


def build_tiles(rows: Sequence[PaperRow], stored_rows: StoredRows) -> list[Tile]:
    """Return a tile for each verdict, and one for the defects."""
    counts = count_all_verdicts(rows, stored_rows)
    claims = f'of {sum(counts.values())} claims'
    tiles = [
        Tile(str(verdict), str(count), '', claims) for verdict, count in counts.items() if count
    ]
    count = sum(len(row.defects) for row in rows)
    return [*tiles, Tile('defects of the paper', str(count), '', 'with their arithmetic below')]


def build_summary_table(rows: Sequence[PaperRow], stored_rows: StoredRows) -> TextTable:
    """Return one table row per study with the counts of its verdicts."""
    counts = {
        format_title(row): count_verdicts(judge_claims(row, stored_rows[row.name]).values())
        for row in rows
    }
    lines = [[name, *map(str, row_counts.values())] for name, row_counts in counts.items()]
    total = map(str, count_all_verdicts(rows, stored_rows).values())
    lines.append([Emphasis('all'), *map(Emphasis, total)])
    return TextTable('Claims of the paper', ('row', *ClaimVerdict), lines)


def format_title(row: PaperRow) -> str:
    """Return number and title of a row."""
    return f'{row.number}. {row.title}'


def iterate_row_blocks(row: PaperRow, stored: StoredRow) -> Iterator[Block]:
    """Yield the section of a row, then its pictures."""
    findings = list_claim_findings(row, stored)
    measured = [
        [measure.what, format_value(measure, stored.values[name]), str(stored.values[name].seeds)]
        for name, measure in row.measures.items()
        if name in stored.values
    ]
    # The time is rounded up, so that no row takes 0 s.
    title = f'All measurements ({len(stored.values)} figures, {math.ceil(stored.seconds)} s)'
    yield ReportSection(
        format_title(row),
        (
            TextSection('', (row.scenario,), marked=True),
            *([TextSection('', (UNDRAWN,), marked=True)] if is_undrawn(row, stored) else []),
            build_claim_table(row, stored),
            *([TextSection('', findings, bullets=True, marked=True)] if findings else []),
            ReportSection(
                title,
                (TextTable('', ('measure', 'here', 'seeds'), measured), *stored.tables),
                folded=True,
            ),
        ),
    )
    if stored.pictures:
        yield Grid([
            Picture(
                f'{row.name}-{each.name}', each.heading, each.caption, each.figure, height=380,
                command=each.command,
            )
            for each in stored.pictures
        ])  # fmt: skip


def build_claim_table(row: PaperRow, stored: StoredRow) -> TextTable:
    """Return one table row per claim."""
    verdicts = judge_claims(row, stored)
    lines = []
    for name, claim in row.claims.items():
        value = stored.values.get(claim.measure or '')
        lines.append([
            claim.says,
            claim.where + SOURCES[claim.source],
            MISSING if claim.value is None else format_quantity(claim.value),
            MISSING if claim.rule is None else format_rule(claim.rule),
            format_value(row.measures[claim.measure], value) if claim.measure else MISSING,
            MISSING if value is None else str(value.seeds),
            format_draws(row, name, stored),
            str(verdicts[name]),
        ])  # fmt: skip
    return TextTable('', CLAIM_HEADS, lines, printed=False, colors=COLORS)


def list_claim_findings(row: PaperRow, stored: StoredRow) -> list[str]:
    """Return the claims that do not simply agree: finding, and what would close the gap."""
    verdicts = judge_claims(row, stored)
    lines = []
    for name, claim in row.claims.items():
        # Why it cannot be tested, else what was found
        finding = fill_measures_or_blank(claim.untested or claim.finding, row, stored)
        by = fill_measures_or_blank(claim.construction, row, stored)
        open_ = verdicts[name] in (ClaimVerdict.DIFFERS, *OPEN)
        gap = fill_measures_or_blank(claim.gap, row, stored) if open_ else ''
        texts = [finding, f'By construction: {by}' if by else '', f'**{gap}**' if gap else '']
        if any(texts):
            lines.append(' '.join(filter(None, [f'*{claim.says}*', *texts])))
    return lines


def fill_measures_or_blank(text: str, row: PaperRow, stored: StoredRow) -> str:
    """Fill in the measures of a text; '' if --quick left one out."""
    has_values = find_measure_names(text) <= stored.values.keys()
    return fill_measures(text, row, stored.values) if has_values else ''


def build_defect_table(rows: Sequence[PaperRow]) -> TextTable:
    """Return one table row per defect of the paper, with its arithmetic."""
    lines = [
        [str(row.number), each.says, each.follows, each.here]
        for row in rows
        for each in row.defects.values()
    ]
    heads = ('row', 'the paper says', 'arithmetic', 'here')
    return TextTable('Inconsistencies in the paper', heads, lines, printed=False)


def to_json(rows: Sequence[PaperRow], stored_rows: StoredRows) -> dict[str, Any]:
    """Return the measured values (with interval and seeds) and pictures of the rows [SI]."""
    return {
        'counts': {
            str(name): count for name, count in count_all_verdicts(rows, stored_rows).items()
        },
        'rows': {row.name: _row_to_json(row, stored_rows[row.name]) for row in rows},
    }


def _row_to_json(row: PaperRow, stored: StoredRow) -> dict[str, Any]:
    return {
        'seeds': stored.seeds,
        'seconds': round(stored.seconds, 1),
        'verdicts': {name: str(each) for name, each in judge_claims(row, stored).items()},
        'values': encode_values(stored.values),
        'draws': replace_nonfinite(stored.draws),
        'pictures': [
            {'name': each.name, 'heading': each.heading, 'caption': each.caption,
             'command': each.command}
            for each in stored.pictures
        ],
    }  # fmt: skip
