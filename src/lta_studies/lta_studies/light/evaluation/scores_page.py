"""docs/navigation_scores.md: every figure of the evaluation, and the command that repeats it."""

from lta_studies.light.evaluation import tables
from lta_studies.light.evaluation.findings import Findings
from lta_studies.light.evaluation.page import METHOD
from lta_studies.light.evaluation.sets import flight_set, INDOORS, SETS, WINDS
from lta_studies.light.evaluation.tables import markdown


def page(found: Findings) -> str:
    """Return the whole page as Markdown."""
    some = '' if len(found.cells) == len(SETS) else f' --sets {" ".join(found.cells)}'
    command = f'lta light evaluate --seeds {found.seeds}{some} --markdown'
    parts = [
        '# Scores of navigation',
        f'Written by `{command}`: {found.count}. What the sets are and how to read them: '
        '[navigation.md](navigation.md).',
        '![Path, time and success of each strategy](images/evaluate.png)',
        '## Beside the paper',
        markdown(tables.PAPER_HEADS, tables.beside_paper(found.cells.get(INDOORS, []))).rstrip(),
        *(
            markdown(tables.OUTDOOR_HEADS, tables.outdoors(found.cells[name])).rstrip()
            for name in found.cells
            if name == WINDS
        ),
        *found.cautions,
        '## What makes the order',
        found.statement,
    ]
    if found.ablations:
        parts.append(markdown(tables.ORDER_HEADS, tables.order_lines(found.ablations)).rstrip())
    wanted = tables.targets(found.cells, found.ours)
    if wanted:
        parts += [
            '## What our strategy was to reach',
            markdown(tables.TARGET_HEADS, wanted).rstrip(),
        ]
    parts += ['## Every figure', METHOD]
    for name, cells in found.cells.items():
        part = flight_set(name)
        head = f'### {part.title}\n\n{part.about} Sweep `{part.file}`.'
        parts += [head, markdown(tables.HEADS, tables.lines(name, cells)).rstrip()]
    return '\n\n'.join(parts) + '\n'
