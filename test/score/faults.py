"""
Faults in flight: `make faults ARGS='--side 4'`, about an hour on two idle cores.

Each kind of `fault_kinds.py` and `light_kinds.py` so many times, at a random moment, side by side,
each flight in a process of its own (`fault_trial.py`, `light_trial.py`). A campaign that was
stopped goes on where it was, while bridge and kinds stay the same. Writes docs/hardware_faults.md.
"""

from collections.abc import Iterator
from pathlib import Path
import sys
from typing import Final

from campaign import asked, campaign, Case, codes, Row, STALLED, tried, TRIES, turn_about
from campaign import told as printed
from campaign import version as hashed
from fault_kinds import Kind, KINDS, SLACK
from light_kinds import AGAIN, LIGHT_KINDS, TOLD
import lta_bridge

HERE: Final = Path(__file__).resolve().parent
PAGE: Final = HERE.parents[1] / 'docs/hardware_faults.md'
HUNG: Final = 240.0  # s after which a flight hangs
EACH: Final = 20
HEAD: Final = (
    '# Faults in flight\n\n'
    '`make faults` wrote this page: each fault at random moments of flights, by '
    'turns by duties (GT-MAB) and by setpoints (the multirotor), on an emulated Crazyflie under '
    'the real bridge and recorder, over UDP and DDS in real time.\nA pilot climbs, cruises and '
    'descends by turns and knows of nothing. The time is from the fault, or from the request to '
    'disarm where the flight is to go on, to motors that stand.\nStated first, then the longest '
    'that was seen; {slack:.0f} s more counts as stated, for a machine with other work. In every '
    "flight the bag must open whole and hold the\nbridge's own word of the fault, and every "
    'process must end.\n\nA time that was missed, or another word that was said, while the '
    'machine woke a sleeper {stalled:.2f} s or more too late says nothing of the bridge: that '
    'flight was flown again,\n{tries} times at most, and the last one counts, whatever became of '
    'it. Nothing else that is wrong is ever flown again. {codes}, of the '
    '{wanted} that make {each} of each;\n{again} flown again; in {stalls} of those that count the '
    'machine stood still for so long.\n\n'
    '| fault | what becomes of the flight | by duties | by setpoints | as stated |\n'
    '|---|---|---|---|---|\n'
)
LIGHT_HEAD: Final = (
    '\n## On the link of the light board\n\n'
    'Nothing there turns a motor; a drone without light is brought down by whoever commands it. '
    'No wrong light may be published, the loss must be told within {told:.1f} s and light must '
    'come {again:.0f} s\nafter the cure ({slack:.0f} s more counts as stated), stamps must be '
    "true, and the bridge's own counts of wrong and unknown frames must be those that were sent."
    '\n\n'
    '| fault | what becomes of the light | longest until told | as stated |\n|---|---|---|---|'
)
ALL: Final = (*KINDS, *LIGHT_KINDS)
NO_TIME: Final = {False: 'no motor turns', True: 'not flown'}


def version() -> str:
    """Return a hash of what decides the outcomes: bridge, emulator and kinds."""
    return hashed(
        [
            *Path(lta_bridge.__file__).parent.rglob('*.py'),
            *HERE.glob('fault_*.py'),
            *HERE.glob('light_*.py'),
        ]
    )


def flown(case: Case) -> Row:
    """Return the outcome of one flight."""
    trial = 'light_trial.py' if case.kind in LIGHT_KINDS else 'fault_trial.py'
    return tried(case, HERE / trial, HUNG)


def rows(outcomes: dict[Case, Row]) -> Iterator[str]:
    """Yield the lines of the table."""
    for name, kind in KINDS.items():
        found = {case: row for case, row in outcomes.items() if case.kind == name}
        if not found:
            continue
        times = [
            [
                row['took']
                for case, row in found.items()
                if case.number % 2 == way and row['took'] is not None
            ]
            for way in range(2)
        ]
        told = [
            f'{stated:.1f} s; {max(seen):.1f} s' if stated and seen else NO_TIME[bool(stated)]
            for stated, seen in zip(kind.stated, times, strict=True)
        ]
        well = sum(not row['wrong'] for row in found.values())
        yield f'| {kind.about} | {fate(kind)} | {told[0]} | {told[1]} | {well} of {len(found)} |'


def light_rows(outcomes: dict[Case, Row]) -> Iterator[str]:
    """Yield the lines of the table of the light link."""
    for name, kind in LIGHT_KINDS.items():
        found = [row for case, row in outcomes.items() if case.kind == name]
        if not found:
            continue
        times = [row['took'] for row in found if row['took'] is not None]
        longest = f'{max(times):.1f} s' if times and kind.word else ''
        becomes = 'told, and back once cured' if kind.word else 'goes on'
        well = sum(not row['wrong'] for row in found)
        yield f'| {kind.about} | {becomes} | {longest} | {well} of {len(found)} |'


def about(name: str) -> str:
    """Return a kind in words."""
    return (KINDS[name] if name in KINDS else LIGHT_KINDS[name]).about


def paged(outcomes: dict[Case, Row]) -> str:
    """Return the page: the table, and each flight that was not as stated."""
    wrong = [
        f'- {about(case.kind)}, flight {case.number}: {row["wrong"]}.\n'
        for case, row in outcomes.items()
        if row['wrong']
    ]
    told = '\nNot as stated:\n\n' + ''.join(wrong) if wrong else ''
    head = HEAD.format(
        slack=SLACK,
        stalled=STALLED,
        tries=TRIES - 1,
        codes=codes(outcomes),
        wanted=EACH * len(ALL),
        each=EACH,
        again=sum(row['again'] for row in outcomes.values()),
        stalls=sum(row.get('late', 0.0) > STALLED for row in outcomes.values()),
    )
    light = LIGHT_HEAD.format(told=TOLD, again=AGAIN, slack=SLACK)
    lines = [*rows(outcomes), light, *light_rows(outcomes), told]
    return head + '\n'.join(lines).rstrip('\n') + '\n'


def fate(kind: Kind) -> str:
    """Return what becomes of a flight, in words."""
    if not any(kind.stated):
        return 'it is never armed'
    return 'flies on, and lands when asked to' if kind.flies_on else kind.ends


def main() -> int:
    """Print the table and write the page; 1 where anything was not as stated."""
    told = asked('Faults in flight.', ALL, EACH, Path('runs') / 'faults')
    path = told.out / f'{version()}.jsonl'
    outcomes = campaign(turn_about(told.kinds, told.each), path, told.side, flown)
    status = printed([*rows(outcomes), *light_rows(outcomes)], path, outcomes)
    if set(told.kinds) == set(ALL):
        PAGE.write_text(paged(outcomes), encoding='utf-8')
    return status


if __name__ == '__main__':
    sys.exit(main())
