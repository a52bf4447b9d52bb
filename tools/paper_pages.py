# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Write the pages of docs/ on the paper: main claims, all rows, and its inconsistencies.

`python -m tools.paper_pages`, in the built workspace after `./lta reproduce`: rows that runs/paper
does not hold are studied first.
"""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Final

from lta_config.schema.paper_file import PaperRow
from lta_flight.sweep.statistics import wilson_interval
from lta_report.formatting import format_markdown_table, MISSING
from lta_report.request import StudyRun
from lta_studies.reproduce.report import (
    build_defect_table,
    fill_measures_or_blank,
    format_headline,
    format_title,
    KNOWN_BEFORE,
    OPEN,
    StoredRows,
)
from lta_studies.reproduce.run import reproduce_rows, ReproductionRequest, select_rows
from lta_studies.reproduce.study_result import MeasuredValue, StoredRow
from lta_studies.reproduce.verdict import (
    ClaimVerdict,
    find_summary,
    format_quantity,
    format_value,
    judge_claims,
)
from rich.console import Console

IMAGES: Final = 'images/paper'  # written by --pictures docs/images/paper
HEADLINE_HEADS: Final = ('the paper says', 'printed', 'here', 'draws that agree', 'verdict', 'row')
ROW_HEADS: Final = (
    'the paper says',
    'here',
    'seeds',
    'draws that agree',
    'verdict',
    'what would close the gap',
)
FIRST_PAGE: Final = """# The paper, reproduced

`./lta reproduce` runs every experiment of the paper (Huang, Xu and Zúñiga Zamalloa, *Exploiting
Light To Enhance The Endurance and Navigation of Lighter-Than-Air Micro-Drones*, 2025) in this
system. Its main claims, with our results:

{table}

*Here*: our value, in brackets where nine of ten draws from the ranges of all assumed numbers lie,
or the 95 % interval of a share of flights. *Draws that agree*: by reading of the words, in the
order of the row's file. A verdict needs Wilson's interval above 95 % of the draws, or below 5 %;
*open* says what leaves a claim open.

**{headline}**

![Path, time and arrivals of BAG, DGA and DES beside the paper's](images/paper/indoors-bars.png)

- [The paper, row by row](paper_rows.md): every claim that measurements decide or leave open, and
  what would close the gap
- [The paper's inconsistencies](paper_inconsistencies.md), with their arithmetic

<!-- not run: minutes; test_paper.py runs the quick rows -->
```sh
./lta reproduce --list            # the rows
./lta reproduce --quick           # one seed, without the long parts: under three minutes
./lta reproduce                   # all seeds; resumes where it was stopped
./lta reproduce indoors energy    # some rows
```

The command also writes a page with every picture, table and figure, and the commands that repeat
them. A row is a file in `config/paper`: what the paper says and where, what is measured, and the
rule for agreement. None of our figures on these pages is typed by hand.
"""
SHOWN: Final = (ClaimVerdict.AGREES, ClaimVerdict.DIFFERS, *OPEN)
ROWS_PAGE: Final = """# The paper, row by row

Behind [the answers](paper.md): every claim that our measurements decide or leave open. The page of
`./lta reproduce` adds the claims that cannot be tested, each with the reason, those that agree
whatever is measured, how claims are judged, places in the paper, rules, seeds, readings and all
measures.

{known}

{rows}
"""
DEFECTS_PAGE: Final = """# The paper's inconsistencies

Where [the paper](paper.md) contradicts itself or physics, with the arithmetic. The page of
`./lta reproduce` adds what was done here about each. Written by `python -m tools.paper_pages`.

## {heading}

{table}
"""


def build_pages(rows: Sequence[PaperRow], stored_rows: StoredRows) -> dict[str, str]:
    """Return the texts of the pages, by file name."""
    defects = build_defect_table(rows)
    return {
        'paper.md': FIRST_PAGE.format(
            table=format_markdown_table(
                HEADLINE_HEADS,
                [line for row in rows for line in list_headlines(row, stored_rows[row.name])],
            ),
            headline=format_headline(rows, stored_rows),
        ),
        'paper_rows.md': ROWS_PAGE.format(
            known=KNOWN_BEFORE,
            rows='\n\n'.join(
                part for row in rows for part in iterate_row_parts(row, stored_rows[row.name])
            ),
        ),
        'paper_inconsistencies.md': DEFECTS_PAGE.format(
            heading=defects.heading,
            table=format_markdown_table(defects.heads[:3], [row[:3] for row in defects.rows]),
        ),
    }


def list_headlines(row: PaperRow, stored: StoredRow) -> list[list[str]]:
    """Return the lines of a row on the first page."""
    verdicts = judge_claims(row, stored)
    return [
        [
            claim.headline,
            MISSING if claim.value is None else format_quantity(claim.value),
            format_measured(row, name, stored),
            format_shares(row, name, stored),
            str(verdicts[name]),
            str(row.number),
        ]
        for name, claim in row.claims.items()
        if claim.headline
    ]


def iterate_row_parts(row: PaperRow, stored: StoredRow) -> Iterator[str]:
    """Yield heading, scene, table and first picture of a row."""
    verdicts = judge_claims(row, stored)
    yield f'## {format_title(row)}'
    yield row.scenario
    lines = []
    for name, claim in row.claims.items():
        if verdicts[name] in SHOWN:
            gap = '' if verdicts[name] is ClaimVerdict.AGREES else claim.gap
            note = fill_measures_or_blank(gap, row, stored) or MISSING
            value = stored.values.get(claim.measure or '')
            seeds = MISSING if value is None else str(value.seeds)
            lines.append([
                claim.says, format_measured(row, name, stored), seeds,
                format_shares(row, name, stored), str(verdicts[name]), note,
            ])  # fmt: skip
    if lines:
        yield format_markdown_table(ROW_HEADS, lines)
    untested = sum(each is ClaimVerdict.UNTESTED for each in verdicts.values())
    if untested:
        yield f'{untested} of its {len(verdicts)} claims cannot be tested.'
    for picture in stored.pictures[:1]:
        yield f'![{picture.heading}]({IMAGES}/{row.name}-{picture.name}.png)'


def format_measured(row: PaperRow, name: str, stored: StoredRow) -> str:
    """Format our value of a claim's first reading, with nine of ten draws or its interval."""
    claim = row.claims[name]
    if claim.measure is None or claim.measure not in stored.values:
        return MISSING
    measure, value = row.measures[claim.measure], stored.values[claim.measure]
    summary = find_summary(name, claim.measure, stored)
    if summary is None or isinstance(summary.middle, str):
        return format_value(measure, value)
    if claim.flights == 'rate':
        # The draws are outcomes of single flights: the share of those that arrived
        assert claim.rule is not None
        share = summary.share if claim.rule.least is not None else 1.0 - summary.share
        return format_value(
            measure,
            MeasuredValue(*wilson_interval(round(share * summary.drawn), summary.drawn)),
        )
    return format_value(measure, value._replace(low=summary.low, high=summary.high))


def format_shares(row: PaperRow, name: str, stored: StoredRow) -> str:
    """Format the share of draws that agrees, of each reading; a dash if there are none."""
    measures = row.claims[name].measures.values()
    summaries = [find_summary(name, measure, stored) for measure in measures]
    shares = [f'{100.0 * each.share:.0f}' for each in summaries if each is not None]
    return f'{", ".join(shares)} %' if shares else MISSING


def main() -> None:
    """Write the pages from the results of a full run."""
    rows = select_rows([])
    run = StudyRun(Console(stderr=True), Path('runs/paper').absolute())
    stored = reproduce_rows(ReproductionRequest(), rows, run)
    for name, text in build_pages(rows, stored).items():
        (Path('docs') / name).write_text(text, encoding='utf-8')


if __name__ == '__main__':
    main()
