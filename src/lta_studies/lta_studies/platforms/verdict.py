"""Build the headline and the ablation table of a comparison."""

from collections.abc import Sequence
from html import escape

from lta_config.schema.comparison_file import ComparisonFile
from lta_studies.platforms.pictures import format_entry_name
from lta_studies.platforms.run import ABLATION, CONTESTANT, PlatformResult
from lta_studies.platforms.summary import ComparisonCell, select_flights


def format_headline(comparison: ComparisonFile, rows: Sequence[PlatformResult]) -> str:
    """Return the headline."""
    lost = []
    for name, contestant in comparison.contestants.items():
        found = [row for row in rows if (row.job.kind, row.job.name) == (CONTESTANT, name)]
        if not found or not all(row.held for row in found):
            lost.append(contestant.title)
    count = len(comparison.contestants)
    if not lost:
        who = f'All {count} contestants hold' if count > 1 else 'The one contestant holds'
        return f'{who} every manoeuvre.'
    if len(lost) == count:
        return 'No contestant holds every manoeuvre.'
    return (
        f'{count - len(lost)} of {count} contestants hold every manoeuvre; {join_names(lost)} not.'
    )


def join_names(names: Sequence[str]) -> str:
    """Join names to the subject of 'does' or 'do'."""
    # 'A does', 'A and B do', 'A, B and C do'
    *others, last = names
    return f'{", ".join(others)} and {last} do' if others else f'{last} does'


def render_ablation_table(comparison: ComparisonFile, rows: Sequence[PlatformResult]) -> str:
    """Return the table of ablations: flights held before and after the change."""
    # One column for every manoeuvre that any ablation flies
    flown = list(
        dict.fromkeys(each for part in comparison.ablations.values() for each in part.manoeuvres)
    )
    lines = []
    for name, ablation in comparison.ablations.items():
        cells = []
        for each in flown:
            pair = (
                select_flights(rows, CONTESTANT, ablation.of, each),
                select_flights(rows, ABLATION, name, each),
            )
            cells.append(f'<td>{format_before_after(*pair)}</td>')
        title = comparison.contestants[ablation.of].title
        what = (format_entry_name(comparison, name), title, ablation.why)
        first = ''.join(f'<td>{escape(text)}</td>' for text in what)
        lines.append(f'<tr>{first}{"".join(cells)}</tr>')
    if not lines:
        return ''
    heads = ''.join(
        f'<th scope="col">{each}</th>' for each in ('entry', 'based on', 'change', *flown)
    )
    return (
        f'<div class="wide"><table class="results changes"><thead><tr>{heads}</tr></thead><tbody>'
        f'{"".join(lines)}</tbody></table></div><p class="note">Flights held before and after '
        'the change; bold where the change reverses the majority.</p>'
    )


def format_before_after(base: ComparisonCell, changed: ComparisonCell) -> str:
    """Format the flights held before and after a change, bold if the majority reverses."""
    if not base.rows or not changed.rows:
        return '\N{EN DASH}'
    held = [sum(row.held for row in part.rows) for part in (base, changed)]
    counts = [len(part.rows) for part in (base, changed)]
    # Whether the majority of flights held
    most = [2 * few > all_of for few, all_of in zip(held, counts, strict=True)]
    ends = [f'{few}/{all_of}' for few, all_of in zip(held, counts, strict=True)]
    text = ' \N{RIGHTWARDS ARROW} '.join(ends)
    return f'<b>{text}</b>' if most[0] != most[1] else text
