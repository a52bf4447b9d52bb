"""Write docs/navigation_scores.md with all results of the evaluation."""

from lta_report.formatting import format_markdown_table
from lta_report.report import TextTable
from lta_studies.light.evaluation import tables
from lta_studies.light.evaluation.report import (
    describe_cautions,
    describe_flights,
    describe_paper_order,
    find_ablations,
    METHOD,
)
from lta_studies.light.evaluation.run import EvaluationStatus
from lta_studies.light.evaluation.sets import find_flight_set, INDOORS, SETS, WINDS


def format_scores_page(status: EvaluationStatus) -> str:
    """Return the page as Markdown."""
    sets = status.cells
    some = '' if len(sets) == len(SETS) else f' --sets {" ".join(sets)}'
    device = '' if status.order.device is None else f' --device {status.order.device}'
    command = f'lta light evaluate --seeds {status.order.seeds}{some}{device} --markdown'
    ablations = find_ablations(status)
    statement = describe_paper_order(status, ablations)
    targets = tables.build_target_table(sets)
    parts = [
        '# Scores of navigation',
        f'Written by `{command}`: {describe_flights(status)}. What the sets are and how to read '
        'them: [navigation.md](navigation.md).',
        '![Path, time and success of each strategy](images/evaluate.png)',
        '## Compared with the paper',
        format_table(tables.build_paper_table(sets.get(INDOORS, []))),
        *([format_table(tables.build_wind_table(sets[WINDS]))] if WINDS in sets else []),
        *describe_cautions(status),
        '## What causes the order of path lengths',
        statement,
        *([format_table(tables.build_order_table(ablations, statement))] if ablations else []),
        *(['## Targets of our strategy', format_table(targets)] if targets.rows else []),
        '## Every figure',
        METHOD,
    ]
    for name, cells in sets.items():
        part = find_flight_set(name)
        parts += [
            f'### {part.title}\n\n{part.about} Sweep `{part.file}`.',
            format_table(tables.build_set_table(name, cells)),
        ]
    return '\n\n'.join(parts) + '\n'


def format_table(table: TextTable) -> str:
    """Return a table in Markdown, without its heading."""
    return format_markdown_table(table.heads, table.rows)
