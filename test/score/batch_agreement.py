"""
Compare flights in batches with single flights, case by case: shares that arrive, and paths.

Takes two results folders of `lta light evaluate`, one of single flights and one with `--device`.
The pilot, which never flies in a batch, is left out.
"""

import argparse
from collections import defaultdict
import json
from pathlib import Path
import sys
from typing import Any, Final, NamedTuple

from scipy.stats import fisher_exact, mannwhitneyu

LEVEL: Final = 0.05
FEWEST: Final = 3  # arrivals of either kind for a comparison of paths


class Flights(NamedTuple):
    """The flights of one case and strategy."""

    count: int
    paths: list[float]  # of those that reached the lamp [m]


def read_cases(folder: Path) -> dict[str, Flights]:
    """Return the flights of an evaluation by set, values and strategy."""
    rows: dict[str, list[dict[str, Any]]] = defaultdict(list)
    for log in sorted(folder.glob('flights/*/flights.jsonl')):
        for row in map(json.loads, log.read_text(encoding='utf-8').splitlines()):
            # The first line of a log describes it
            if 'outcome' in row and row['values']['strategy'] != 'pilot':
                rows[f'{log.parent.name} {json.dumps(row["values"], sort_keys=True)}'].append(row)
    return {
        case: Flights(
            len(found),
            [row['figures']['path_length'] for row in found if row['outcome'] == 'reached'],
        )
        for case, found in rows.items()
    }


def compare_shares(one: Flights, other: Flights) -> float:
    """Return the p-value of equal shares of arrivals."""
    table = [[len(each.paths), each.count - len(each.paths)] for each in (one, other)]
    return float(fisher_exact(table)[1])


def main() -> int:
    """Print what differs, and how many comparisons were made."""
    parser = argparse.ArgumentParser(description='Compare batches with single flights.')
    parser.add_argument('single', type=Path)
    parser.add_argument('batches', type=Path)
    words = parser.parse_args()
    single, batches = read_cases(words.single), read_cases(words.batches)
    both = [case for case in single if case in batches]
    shares = {case: compare_shares(single[case], batches[case]) for case in both}
    paths = {
        case: float(mannwhitneyu(single[case].paths, batches[case].paths).pvalue)
        for case in both
        if min(len(single[case].paths), len(batches[case].paths)) >= FEWEST
    }
    for what, test, found in (
        ('shares of arrivals', "Fisher's exact test", shares),
        ('paths', 'Mann-Whitney', paths),
    ):
        differs = [case for case, p in found.items() if p < LEVEL]
        sys.stdout.write(
            f'{len(differs)} of {len(found)} {what} differ ({test}, p < {LEVEL:g}).\n'
        )
        sys.stdout.writelines(f'  {case}: p = {found[case]:.3f}\n' for case in differs)
    return 0 if both else 2


if __name__ == '__main__':
    sys.exit(main())
