"""
Whole graphs in trouble: `make chaos` (hours), or `make chaos ARGS='--each 3 --side 1'`.

Each kind of `chaos_kinds.py` so many times, in a random phase of a flight that was started as a
user starts it (`chaos_trial.py`): by turns in lockstep, in real time, and in real time behind
emulated hardware, where the kind allows it. A campaign that was stopped goes on where it was,
while the code and the kinds stay the same. Writes its part of docs/reliability.md.
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
## Whole graphs in trouble

`make chaos` flies whole graphs as a user starts them: `lta fly` in lockstep, from lantern to
lantern without an end; `lta launch fly` in real time; and the same behind an emulated Crazyflie
and light board that was armed. In a phase of the flight that chance chooses, one thing goes wrong,
in a node, topic or parameter that chance chooses. Then

- the fault must be named within {named:.0f} s of wall time by /diagnostics and on the terminal (of
  a parameter: refused with a reason, to whoever set it);
- motors of the hardware must stand within what [hardware_faults.md](hardware_faults.md) states; a
  flight that may go on must go on, and land when asked to; no command may be more than a motor
  takes;
- the bag must open, whole unless the recorder itself was struck, and hold the words;
- no process, lock or port may be left.

Which topics are spoilt or flooded comes from `config/topics.yaml`: all that nodes of the graph
read. A time that was missed while the machine woke a sleeper {stalled:.2f} s or more too late says
nothing of the graph: such a trial was done again, {tries} times at most, and the last one counts.
Nothing else that is wrong is ever done again. {count} trials, of {wanted} that make {each} of each
({codes}); {again} done again. Times are the longest.

| fault | trials | then the flight | in /diagnostics after | on the terminal | motors turned \
for | as stated |
|---|---|---|---|---|---|---|
"""
PHASES: Final = """

By the phase in which it struck, as stated of all:

"""


def code() -> str:
    """Return a hash of what decides the outcomes: all nodes, their declarations, the trials."""
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
    return 'ends in order' if kind.ends else 'goes on'


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
    by_way = '\n\nBy how the graph was started, as stated of all:\n\n'
    return (
        head + '\n'.join(lines(outcomes)) + by_way + '\n'.join(ways) + PHASES + '\n'.join(phases)
        + told_
    )  # fmt: skip


def main() -> int:
    """Print the table and write the page; 1 where anything was not as stated."""
    given = asked('Whole graphs in trouble.', list(KINDS), EACH, Path('runs') / 'chaos')
    path = given.out / f'{code()}.jsonl'
    outcomes = campaign(turn_about(given.kinds, given.each), path, given.side, trial)
    status = told(list(lines(outcomes)), path, outcomes)
    if set(given.kinds) == set(KINDS) and outcomes:
        put('chaos', paged(outcomes, given.each))
    return status


if __name__ == '__main__':
    sys.exit(main())
