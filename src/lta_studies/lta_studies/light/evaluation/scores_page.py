"""Write docs/navigation_scores.md with all results of the evaluation."""

from lta_studies.light.evaluation import tables
from lta_studies.light.evaluation.findings import EvaluationFindings
from lta_studies.light.evaluation.page import METHOD
from lta_studies.light.evaluation.sets import find_flight_set, INDOORS, SETS, WINDS
from lta_studies.light.evaluation.tables import format_markdown_table


def format_scores_page(findings: EvaluationFindings) -> str:
    """Return the page as Markdown."""
    some = '' if len(findings.cells) == len(SETS) else f' --sets {" ".join(findings.cells)}'
    command = f'lta light evaluate --seeds {findings.seeds}{some} --markdown'
    parts = [
        '# Scores of navigation',
        f'Written by `{command}`: {findings.flight_count_text}. What the sets are and how to read '
        f'them: '
        '[navigation.md](navigation.md).',
        '![Path, time and success of each strategy](images/evaluate.png)',
        '## Compared with the paper',
        format_markdown_table(
            tables.PAPER_HEADS, tables.build_paper_rows(findings.cells.get(INDOORS, []))
        ).rstrip(),
        *(
            format_markdown_table(
                tables.OUTDOOR_HEADS, tables.build_wind_rows(findings.cells[name])
            ).rstrip()
            for name in findings.cells
            if name == WINDS
        ),
        *findings.cautions,
        '## What causes the order of path lengths',
        findings.statement,
    ]
    if findings.ablations:
        parts.append(
            format_markdown_table(
                tables.ORDER_HEADS, tables.build_path_order_rows(findings.ablations)
            ).rstrip()
        )
    wanted = tables.build_target_rows(findings.cells, findings.own_strategy)
    if wanted:
        parts += [
            '## Targets of our strategy',
            format_markdown_table(tables.TARGET_HEADS, wanted).rstrip(),
        ]
    parts += ['## Every figure', METHOD]
    for name, cells in findings.cells.items():
        part = find_flight_set(name)
        head = f'### {part.title}\n\n{part.about} Sweep `{part.file}`.'
        parts += [
            head,
            format_markdown_table(tables.HEADS, tables.build_set_rows(name, cells)).rstrip(),
        ]
    return '\n\n'.join(parts) + '\n'
