"""
Inject faults into whole graphs: `make chaos` (hours), or `make chaos ARGS='--each 3 --side 1'`.

Runs each kind of `chaos_kinds.py` several times, in a random phase of a flight that is started as
a user starts it (`chaos_trial.py`): by turns in lockstep, in real time, and in real time with
emulated hardware, if the kind allows it. A stopped campaign resumes if code and kinds are
unchanged. Writes its part of docs/reliability.md.
"""

from collections.abc import Callable, Iterator
from pathlib import Path
import sys
from typing import Final

from campaign import (
    asked,
    campaign,
    Case,
    codes,
    Row,
    STALLED,
    told,
    tried,
    TRIES,
    turn_about,
    version,
)
from chaos_kinds import Kind, KINDS
from reliability import put

HERE: Final = Path(__file__).resolve().parent
TRIAL: Final = HERE / 'chaos_trial.py'
PACKAGES, CONFIG = (HERE.parents[1] / name for name in ('src', 'config'))
EACH: Final = 12
HUNG: Final = 240.0  # s after which a trial hangs
NAMED: Final = 1.0  # s
WAYS: Final = {
    'lockstep': 'lockstep',
    'realtime': 'real time',
    'hardware': 'emulated hardware',
}
HEAD: Final = """\
## Faults in whole graphs

`make chaos` flies whole graphs as a user starts them: `lta fly` in lockstep, from lantern to
lantern without an end; `lta launch fly` in real time; and the same with an emulated Crazyflie and
light board, armed. In a random phase of the flight, it injects one fault into a random node, topic
or parameter. The requirements are:

- /diagnostics and the terminal name the fault within {named:.0f} s of wall time (an invalid
  parameter is refused with a reason, in the answer to the request);
- motors of the hardware stop within the times in [hardware_faults.md](hardware_faults.md); a
  flight that may continue does so and lands on request; no command exceeds the range of a motor;
- the bag opens, completely unless the recorder itself had the fault, and contains the messages;
- no process, lock or port remains.

The topics for invalid messages and floods come from `config/topics.yaml`: all that nodes of the
graph read. A late report or stop does not count against the graph if the machine paused for
{stalled:.2f} s or more: the trial is repeated, at most {tries} times, and the last one counts. No
other failure is repeated. {count} trials, of {wanted} for {each} of each kind ({codes}); {again}
were repeated. Times are the longest of each kind.

| fault | trials | the flight then | in /diagnostics after | on the terminal after | motors \
turned for | as stated |
|---|---|---|---|---|---|---|
"""
PHASES: Final = """

As stated, by the phase of the fault:

"""


def code() -> str:
    """Return a hash of what the outcomes depend on: nodes, their declarations and the trials."""
    declared = [path for kind in ('*.py', '*.yaml', '*.xml') for path in CONFIG.rglob(kind)]
    trials = [*HERE.glob('chaos_*.py'), HERE / 'endless.py', HERE / 'outcome.py']
    return version([*PACKAGES.rglob('*.py'), *declared, *trials])


def trial(case: Case) -> Row:
    """Return the outcome of one trial."""
    return tried(case, TRIAL, HUNG)


def longest(rows: list[Row], name: str) -> str:
    """Return the longest of some times, in words."""
    times = [row[name] for row in rows if row.get(name) is not None]
    return f'{max(times):.2f} s' if times else ''


def well(rows: list[Row]) -> str:
    """Return how many were as stated."""
    return f'{sum(not row["wrong"] for row in rows)} of {len(rows)}'


def becomes(kind: Kind) -> str:
    """Return what becomes of a flight, in words."""
    return 'shuts down in order' if kind.ends else 'continues'


def lines(outcomes: dict[Case, Row]) -> Iterator[str]:
    """Yield the lines of the table."""
    for name, kind in KINDS.items():
        rows = [row for case, row in outcomes.items() if case.kind == name]
        if rows:
            told_, said, took = (longest(rows, column) for column in ('told', 'said', 'took'))
            yield (
                f'| {kind.about} | {len(rows)} | {becomes(kind)} | {told_} | {said} | {took} | '
                f'{well(rows)} |'
            )


def crossed(outcomes: dict[Case, Row], column: Callable[[Row], str]) -> Iterator[str]:
    """Yield the lines of a table of the faults by something of a row."""
    columns = sorted({column(row) for row in outcomes.values()} - {''})
    yield '| fault | ' + ' | '.join(columns) + ' |'
    yield '|---|' + '---|' * len(columns)
    for name, kind in KINDS.items():
        rows = [row for case, row in outcomes.items() if case.kind == name]
        if rows:
            cells = [[row for row in rows if column(row) == one] for one in columns]
            yield (
                f'| {kind.about} | '
                + ' | '.join(well(cell) if cell else '' for cell in cells)
                + ' |'
            )


def paged(outcomes: dict[Case, Row], each: int) -> str:
    """Return the part of the page."""
    head = HEAD.format(
        named=NAMED,
        stalled=STALLED,
        tries=TRIES - 1,
        count=len(outcomes),
        codes=codes(outcomes),
        wanted=each * len(KINDS),
        each=each,
        again=sum(row.get('again', 0) for row in outcomes.values()),
    )
    ways = crossed(outcomes, lambda row: WAYS.get(row.get('way', ''), ''))
    phases = crossed(outcomes, lambda row: row.get('phase', ''))
    wrong = [
        f'- {KINDS[case.kind].about}, trial {case.number} ({WAYS.get(row.get("way", ""), "")}, '
        f'{row.get("target", "")}, {row.get("phase", "")}): {row["wrong"]}'.replace('\n', ' ')
        for case, row in outcomes.items()
        if row['wrong']
    ]
    told_ = '\n\nNot as stated:\n\n' + '\n'.join(wrong) if wrong else '\n\nAll were as stated.'
    by_way = '\n\nAs stated, by the way to start the graph:\n\n'
    return (
        head + '\n'.join(lines(outcomes)) + by_way + '\n'.join(ways) + PHASES + '\n'.join(phases)
        + told_
    )  # fmt: skip


def main() -> int:
    """Print the table and write the page; 1 where anything was not as stated."""
    given = asked('Faults in whole graphs.', list(KINDS), EACH, Path('runs') / 'chaos')
    path = given.out / f'{code()}.jsonl'
    outcomes = campaign(turn_about(given.kinds, given.each), path, given.side, trial)
    status = told(list(lines(outcomes)), path, outcomes)
    if set(given.kinds) == set(KINDS) and outcomes:
        put('chaos', paged(outcomes, given.each))
    return status


if __name__ == '__main__':
    sys.exit(main())
