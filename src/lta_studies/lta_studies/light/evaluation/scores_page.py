"""Write docs/navigation_scores.md with the main results of the evaluation."""

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
from lta_studies.light.evaluation.sets import INDOORS, SETS


def format_scores_page(status: EvaluationStatus) -> str:
    """Return the page as Markdown."""
    sets = status.cells
    some = '' if len(sets) == len(SETS) else f' --sets {" ".join(sets)}'
    device = '' if status.order.device is None else f' --device {status.order.device}'
    command = f'lta light evaluate --seeds {status.order.seeds}{some}{device} --markdown'
    ablations = find_ablations(status)
    parts = [
        '# Scores of navigation',
        f'Written by `{command}`: {describe_flights(status)}; its page has every figure. What the '
        'sets are and how to read them: [navigation.md](navigation.md).',
        '![Path, time and success of each strategy](images/evaluate.png)',
        format_table(tables.build_paper_table(sets.get(INDOORS, []))),
        METHOD,
        *describe_cautions(status),
        describe_paper_order(status, ablations),
    ]
    return '\n\n'.join(parts) + '\n'


def format_table(table: TextTable) -> str:
    """Return a table in Markdown, without its heading."""
    return format_markdown_table(table.heads, table.rows)
