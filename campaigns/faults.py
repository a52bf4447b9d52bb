"""
Inject faults into flights of emulated hardware.

Each kind of `fault_kinds.py` comes at a random moment of a flight, by turns of one that is
commanded by duties (GT-MAB, even numbers) and by setpoints (multirotor, odd numbers).
"""

from argparse import Namespace
from collections.abc import Iterator, Sequence
from typing import Final

from campaigns.fault_kinds import FaultKind, KINDS
from campaigns.fault_trial import Trial
from campaigns.graph_trial import try_flight
from campaigns.harness import Campaign, Case, count_right, Row, Rows


def run(case: Case, options: Namespace) -> Row:
    """Return the row of a trial."""
    return try_flight(lambda folder, peer: Trial(*case, folder, peer).fly())


def list_table(rows: Rows, options: Namespace) -> Iterator[str]:
    """Yield the table of flights."""
    yield '| fault | outcome of the flight | by duties | by setpoints | as stated |'
    yield '|---|---|---|---|---|'
    for name, kind in KINDS.items():
        some = {case: row for case, row in rows.items() if case.kind == name}
        if some:
            times = [
                format_times(stated, [row for case, row in some.items() if case.number % 2 == way])
                for way, stated in enumerate(kind.stated)
            ]
            cells = (kind.about, describe_end(kind), *times, count_right(list(some.values())))
            yield f'| {" | ".join(cells)} |'


def format_times(stated: float, rows: Sequence[Row]) -> str:
    """Return the stated and the longest time; those that hung have none. [s]"""
    times = [row['took'] for row in rows if row.get('took') is not None]
    longest = f'{max(times):.1f} s' if times else '-'
    return f'{stated:.1f} s; {longest}' if stated else longest


def describe_end(kind: FaultKind) -> str:
    """Return what becomes of a flight, in words."""
    if not any(kind.stated):
        return 'cannot be armed'
    return 'flies on, and lands on request' if kind.flies_on else kind.ends


CAMPAIGN: Final = Campaign(
    lambda options: list(KINDS), run, list_table, each=20, page='hardware_faults.md',
    alone=True, side=0, patience=240.0,
)  # fmt: skip
