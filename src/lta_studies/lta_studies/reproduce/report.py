"""Build the report of a reproduction, and its page docs/paper.md."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
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
from lta_report.report_markdown import render_markdown
from lta_studies.reproduce.stored_row import encode_values, StoredPicture, StoredRow
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
from plotly.io import from_json

StoredRows = Mapping[str, StoredRow]
CLAIM_HEADS: Final = (
    'the paper says', 'where', 'printed', 'agrees if', 'here', 'seeds', 'drawn', 'verdict',
)  # fmt: skip
COLORS: Final[Mapping[str, CellColor]] = {
    ClaimVerdict.AGREES: 'good', ClaimVerdict.BEYOND: 'good', ClaimVerdict.DIFFERS: 'bad',
    ClaimVerdict.UNTESTED: 'soft', ClaimVerdict.LEFT_OUT: 'soft', ClaimVerdict.UNCERTAIN: 'soft',
    ClaimVerdict.CONSTRUCTION: 'soft', ClaimVerdict.VACUOUS: 'soft',
}  # fmt: skip
# Remark after the place of a claim, by the source of its number
SOURCES: Final = {
    'printed': '', 'read': ' (read from text)', 'comment': ' (LaTeX comment)', 'future': '',
}  # fmt: skip
IMAGES: Final = 'images/paper'  # written by --pictures docs/images/paper
ABOUT: Final = (
    'Every experiment of the paper (Huang et al. 2025), repeated in this system: what the '
    'paper says, what we get, and why they differ.'
)
METHOD: Final = (
    'The measures are those of the files as they are, with 95 % intervals over the seeds in '
    'brackets (Student for means, Wilson for shares). Then every number that is assumed, in the '
    'vehicle, in the cells and in what the paper does not print of its scenes, is drawn from the '
    'range that its file gives, and measured again, each draw with a seed of its own. A claim '
    'agrees if its rule holds in at least 95 % of the draws, and differs if it fails in at least '
    '95 % of them; anything between is within our uncertainty. Where the words of a claim allow '
    'several readings, all are measured, and a verdict needs all of them (--quick leaves some '
    'out, so that its verdicts are preliminary). Claims that hold by '
    'construction, and agreements that say nothing because anything would agree, are counted '
    'apart. For each claim that cannot be tested, the reason is given. All rows use the same '
    'GT-MAB file, gains, lamp and room; deviations are listed.'
)
KNOWN_BEFORE: Final = (
    'What was known when: the rules of agreement were written with the rows, on 2026-11-21. By '
    'then the commands for photodiodes, strategies, platforms, mounting, cells and energy, which '
    'measure much of the same, had been run, so that no rule was written blind; those of rows 5, '
    '7 and 11 were written when their results were known. Ranges, readings, and the claims on '
    'linear drag, on the weight of diodes, on the overshoot of DGA and on how flights fail '
    'outdoors were added on 2026-11-26, when all results without draws were known. No rule that '
    'existed was changed then; row 3 has a small perturbation since.'
)
UNDRAWN: Final = (
    '**These measures are of a run without draws, and in part of older code: the verdicts of this '
    'row are preliminary. `./lta reproduce` measures it again.**'
)
DISCOVERY: Final = (
    'Discovery (`lta discover`) finds a missing effect from the commands and the motion of '
    'recorded flights. The paper shows its curves only as pictures and does not publish '
    'their data, so only the printed numbers remain. A cause is fitted to some of these '
    'numbers and tested on the others, as discovery does with flights. A cause that '
    'explains only one number is marked as a guess.'
)
MARKDOWN_HEAD: Final = """# The paper, reproduced

`./lta reproduce` runs every experiment of the paper (Huang, Xu and Zúñiga Zamalloa, *Exploiting
Light To Enhance The Endurance and Navigation of Lighter-Than-Air Micro-Drones*, 2025) in this
system. This file is generated from the results; none of our figures is typed by hand.

<!-- not run: minutes; test_paper.py runs the quick rows -->
```sh
./lta reproduce --list            # the rows
./lta reproduce --quick           # one seed, without the long parts: under three minutes
./lta reproduce                   # all seeds; resumes where it was stopped
./lta reproduce indoors energy    # some rows
./lta reproduce --markdown > docs/paper.md
```

The command also writes a page with every picture, table and figure, and records the plotted
flights as bags in its folder. Pictures that show no flight (vehicle files, cells, light blocks,
bearings on a bench) only have a command. A row is a file in `config/paper`: what the paper says
and where, what is measured, and the rule for agreement. The ranges of what is assumed are in the
files of vehicle and cells (`range`), those of scenes in the row."""


def build_report(rows: Sequence[PaperRow], stored_rows: StoredRows) -> Report:
    """Return the report of a reproduction."""
    return Report(
        command='reproduce',
        subject='the paper',
        headline=format_headline(rows, stored_rows),
        introduction=ABOUT,
        tiles=build_tiles(rows, stored_rows),
        blocks=(
            build_summary_table(rows, stored_rows),
            TextSection('How claims are judged', (METHOD, KNOWN_BEFORE)),
            *(block for row in rows for block in iterate_row_blocks(row, stored_rows[row.name])),
            ReportSection(
                "What discovery concludes from the paper's figures",
                (
                    TextSection('', (DISCOVERY,), marked=True),
                    build_paper_figure_table(rows, stored_rows),
                ),
            ),
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


def format_markdown_page(report: Report) -> str:
    """Return the text of docs/paper.md."""
    # The headline and the method introduce the summary, which needs no heading then
    summary, _, *rest = report.blocks
    assert isinstance(summary, TextTable)
    text = render_markdown([replace(summary, heading=''), *rest], IMAGES)
    return f'{MARKDOWN_HEAD}\n\n**{report.headline}** {METHOD}\n\n{KNOWN_BEFORE}\n\n{text}\n'


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
    # Results beyond the paper are not claims of the paper.
    count = sum(counts.values()) - counts[ClaimVerdict.BEYOND]
    agreeing = sum(
        counts[each]
        for each in (ClaimVerdict.AGREES, ClaimVerdict.CONSTRUCTION, ClaimVerdict.VACUOUS)
    )
    text = (
        f"Of the paper's {count} claims, {agreeing} agree ({counts[ClaimVerdict.CONSTRUCTION]} by "
        f'construction, {counts[ClaimVerdict.VACUOUS]} where anything would), '
        f'{counts[ClaimVerdict.DIFFERS]} differ, {counts[ClaimVerdict.UNCERTAIN]} are within our '
        f'uncertainty and {counts[ClaimVerdict.UNTESTED]} cannot be tested'
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
    claims = f'of {sum(counts.values()) - counts[ClaimVerdict.BEYOND]} claims'
    notes = {ClaimVerdict.BEYOND: 'future work of the paper'}
    tiles = [
        Tile(str(verdict), str(count), '', notes.get(verdict, claims))
        for verdict, count in counts.items()
        if count
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
        yield Grid([build_picture(row, each) for each in stored.pictures])


def build_picture(row: PaperRow, stored: StoredPicture) -> Picture:
    """Return a stored picture."""
    return Picture(
        f'{row.name}-{stored.name}', stored.heading, stored.caption, from_json(stored.figure),
        height=380, command=stored.command, bag=stored.bag,
    )  # fmt: skip


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
        open_ = verdicts[name] in (ClaimVerdict.DIFFERS, ClaimVerdict.UNCERTAIN)
        gap = fill_measures_or_blank(claim.gap, row, stored) if open_ else ''
        texts = [finding, f'By construction: {by}' if by else '', f'**{gap}**' if gap else '']
        if any(texts):
            lines.append(' '.join(filter(None, [f'*{claim.says}*', *texts])))
    return lines


def fill_measures_or_blank(text: str, row: PaperRow, stored: StoredRow) -> str:
    """Fill in the measures of a text; '' if --quick left one out."""
    has_values = find_measure_names(text) <= stored.values.keys()
    return fill_measures(text, row, stored.values) if has_values else ''


def build_paper_figure_table(rows: Sequence[PaperRow], stored_rows: StoredRows) -> TextTable:
    """Return one table row per figure of the paper: its printed numbers and the conclusion."""
    lines = [
        [
            str(row.number),
            each.figure,
            each.printed,
            fill_measures_or_blank(each.said, row, stored_rows[row.name]) or MISSING,
        ]
        for row in rows
        for each in row.series.values()
    ]
    return TextTable('', ('row', 'figure', 'printed numbers', 'conclusion'), lines, printed=False)


def build_defect_table(rows: Sequence[PaperRow]) -> TextTable:
    """Return one table row per defect of the paper, with its arithmetic."""
    lines = [
        [str(row.number), each.says, each.arithmetic, each.here]
        for row in rows
        for each in row.defects.values()
    ]
    heads = ('row', 'the paper says', 'arithmetic', 'here')
    return TextTable('Inconsistencies in the paper', heads, lines, printed=False)


def to_json(rows: Sequence[PaperRow], stored_rows: StoredRows) -> dict[str, Any]:
    """Return the measured values (with interval and seeds) and pictures of the rows. [SI]"""
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
             'command': each.command, 'bag': each.bag}
            for each in stored.pictures
        ],
    }  # fmt: skip
