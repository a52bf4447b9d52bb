"""
Compare the last `make bench` with the figures that are stored in git: `make bench-compare`.

Only ratios carry over from machine to machine, so a figure without a peer is not compared. What is
worse by more than a fifth ends it with status 1; better or worse, `--keep` makes the last run the
reference, and writes the table of docs/validation.md. What one of the two has not is listed and no
fault: peers are optional.
"""

from argparse import ArgumentParser
from collections.abc import Mapping
from dataclasses import dataclass
import json
from pathlib import Path
import sys

from bench import RESULTS
from rich.console import Console
from rich.table import Table
from speed_table import PAGE, update_page

REFERENCE = Path(__file__).resolve().parent / 'reference.json'
WORSE = 0.2  # share of a ratio

Key = tuple[str, str]  # figure and peer


@dataclass(frozen=True, slots=True)
class Ratio:
    """LTA's figure over a peer's."""

    value: float
    unit: str  # of the figure itself, which tells whether more is better: a rate, or a cost

    def loss(self, before: 'Ratio') -> float:
        """Return by what share this is worse than it was; below zero where it is better."""
        rate = self.unit.endswith('/s')
        return (before.value / self.value if rate else self.value / before.value) - 1.0


def ratios(path: Path) -> dict[Key, Ratio]:
    """Return the ratios of a file that `make bench` or `--keep` wrote."""
    return {
        (row['name'], row['peer']): Ratio(row['ratio'], row['unit'])
        for row in json.loads(path.read_text(encoding='utf-8'))['rows']
        if row['ratio'] is not None
    }


def show(now: Mapping[Key, Ratio], before: Mapping[Key, Ratio]) -> list[Key]:
    """Print the comparison; return what is worse."""
    table = Table(box=None, pad_edge=False)
    for heading in ('name', 'peer', 'reference', 'now', 'worse by'):
        table.add_column(heading, justify='left' if heading in ('name', 'peer') else 'right')
    both = [key for key in before if key in now]
    worse = [key for key in both if now[key].loss(before[key]) > WORSE]
    for key in both:
        loss = f'{100.0 * now[key].loss(before[key]):+.0f} %'
        style = 'red' if key in worse else ''
        table.add_row(*key, f'{before[key].value:.4g}', f'{now[key].value:.4g}', loss, style=style)
    console = Console(width=None if sys.stdout.isatty() else 120)
    console.print(table)
    alone = [name for name, _ in before.keys() ^ now.keys()]
    if alone:
        console.print(f'Only in one of the two: {", ".join(sorted(set(alone)))}.', highlight=False)
    return worse


def keep() -> None:
    """Make the last run the reference; figures that it has not measured stay as they were."""
    run = json.loads(RESULTS.read_text(encoding='utf-8'))
    before = json.loads(REFERENCE.read_text(encoding='utf-8')) if REFERENCE.is_file() else {}
    circumstances = {name: run[name] for name in ('date', 'cores', 'load')}
    # By name alone: the best peer of a figure may be another one than last time
    rows = {row['name']: row for row in before.get('rows', ())}
    for row in run['rows']:
        digits = {key: round_figure(row[key]) for key in ('value', 'ratio')}
        rows[row['name']] = row | digits | circumstances
    content = {'rows': [rows[name] for name in sorted(rows)]}
    REFERENCE.write_text(json.dumps(content, indent=1) + '\n', encoding='utf-8')
    update_page(PAGE, REFERENCE)


def round_figure(value: float | None) -> float | None:
    """Return a figure with four digits."""
    return None if value is None else float(f'{value:.4g}')


def main(words: list[str] | None = None) -> int:
    """Compare, or keep; return the exit status."""
    parser = ArgumentParser(description='Compare the last "make bench" with the kept ratios.')
    parser.add_argument('--keep', action='store_true', help='make the last run the reference')
    kept = parser.parse_args(words).keep
    for path, remedy in ((RESULTS, 'make bench'), (REFERENCE, 'make bench-compare ARGS=--keep')):
        if not path.is_file() and not (kept and path == REFERENCE):
            sys.stderr.write(f'There is no {path}; run "{remedy}" first.\n')
            return 2
    if kept:
        keep()
        sys.stdout.write(f'{REFERENCE}\n')
        return 0
    worse = show(ratios(RESULTS), ratios(REFERENCE))
    for name, peer in worse:
        sys.stderr.write(f'{name} is worse beside {peer} by more than {WORSE:.0%}.\n')
    return int(bool(worse))


if __name__ == '__main__':
    sys.exit(main())
