"""
Faults in flight: `make faults ARGS='--side 4'`, about an hour on two idle cores.

Flies each kind of `fault_kinds.py` and `light_kinds.py` several times, at random moments, in
parallel, each flight in its own process (`fault_trial.py`, `light_trial.py`). A stopped campaign
resumes if bridge and kinds are unchanged. Stores the rows, and writes docs/hardware_faults.md.
"""

from collections.abc import Iterator
import json
from pathlib import Path
import sys
from typing import Final

import add_paths  # noqa: F401
from campaign import (
    asked,
    campaign,
    Case,
    codes,
    count_flights,
    describe_lateness,
    list_flown_files,
    read_stored,
    Row,
    STALLED,
    store,
    StoredCampaign,
    tried,
    TRIES,
    turn_about,
)
from campaign import told as printed
from campaign import version as hashed
from fault_kinds import Kind, KINDS, SLACK
from firmware_scenarios import APP
from light_kinds import AGAIN, LIGHT_KINDS, TOLD
from slow_clock import slow_down

HERE: Final = Path(__file__).resolve().parent
PAGE: Final = HERE.parents[1] / 'docs/hardware_faults.md'
RECORD: Final = HERE.parents[1] / 'test/golden/hardware_faults.json'
FIRMWARE: Final = HERE.parents[1] / 'test/golden/crazyflie_firmware.json'
HUNG: Final = 240.0  # s after which a flight hangs
EACH: Final = 20
HEAD: Final = """\
# Hardware faults in flight

`make faults` writes this page. It injects each fault at a random moment of a flight. The
flights are alternately commanded by motor duties (GT-MAB) and by setpoints (multirotor). They use
an emulated Crazyflie with the real bridge and recorder, over UDP and DDS in real time. A pilot
climbs, cruises and descends in turn and does not react to the fault. The emulated drone is held to
[the real firmware](hardware_firmware.md) (commit `{commit}`), on which the same faults were flown.

The table shows the time until the motors stop, counted from the fault, or from the request to
disarm if the flight should continue. The first time is the stated limit, the second the longest
that was measured. A tolerance of {slack:.0f} s above the limit is allowed for load on the
machine. In every flight the bag must open completely and contain the bridge's message about the
fault, and every process must end.

A late stop or a different message does not count against the bridge if the machine paused for
{stalled:.2f} s or more: the flight is repeated, at most {tries} times, and the last one counts. No
other failure is repeated.

{flights} ({codes}). {again} repeated. In
{stalls} of the counted flights the machine paused for {stalled:.2f} s or more. {late}
The rows are in `test/golden/hardware_faults.json`.

| fault | outcome of the flight | by duties | by setpoints | as stated |
|---|---|---|---|---|
"""
LIGHT_HEAD: Final = """
## Link of the light board

These faults turn no motor: without light, the pilot or navigator lands the drone. The bridge must
not publish wrong light. It must report the loss within {told:.1f} s, and publish light again
{again:.0f} s after the repair (a tolerance of {slack:.0f} s is allowed). Stamps must be correct,
and the bridge's counts of wrong and unknown frames must equal the number that was sent.

| fault | outcome of the light | longest time to the report | as stated |
|---|---|---|---|"""
ALL: Final = (*KINDS, *LIGHT_KINDS)


def version() -> str:
    """Return a hash of what the outcomes depend on: the code that flies and the fault kinds."""
    return hashed([*list_flown_files(), *HERE.glob('fault_*.py'), *HERE.glob('light_*.py')])


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
        told = [
            describe_times(stated, [row for case, row in found.items() if case.number % 2 == way])
            for way, stated in enumerate(kind.stated)
        ]
        well = sum(not row['wrong'] for row in found.values())
        yield f'| {kind.about} | {fate(kind)} | {told[0]} | {told[1]} | {well} of {len(found)} |'


def describe_times(stated: float, found: list[Row]) -> str:
    """Return the stated and the longest time; those that hung have none. [s]"""
    times = [row['took'] for row in found if row['took'] is not None]
    if not stated:
        return 'no motor turns'
    longest = f'{max(times):.1f} s' if times else '-'
    return f'{stated:.1f} s; {longest}' if found else 'not flown'


def light_rows(outcomes: dict[Case, Row]) -> Iterator[str]:
    """Yield the lines of the table of the light link."""
    for name, kind in LIGHT_KINDS.items():
        found = [row for case, row in outcomes.items() if case.kind == name]
        if not found:
            continue
        times = [row['took'] for row in found if row['took'] is not None]
        longest = f'{max(times):.1f} s' if times and kind.word else ''
        becomes = 'reported, and back after the repair' if kind.word else 'continues'
        well = sum(not row['wrong'] for row in found)
        yield f'| {kind.about} | {becomes} | {longest} | {well} of {len(found)} |'


def about(name: str) -> str:
    """Return a kind in words."""
    return (KINDS[name] if name in KINDS else LIGHT_KINDS[name]).about


def compose_page(stored: StoredCampaign) -> str:
    """Return the page: the table, and each flight that was not as stated."""
    outcomes = stored.rows
    wrong = [
        f'- {about(case.kind)}, flight {case.number}: {row["wrong"]}.\n'
        for case, row in outcomes.items()
        if row['wrong']
    ]
    told = '\nNot as stated:\n\n' + ''.join(wrong) if wrong else ''
    again = sum(row['again'] for row in outcomes.values())
    head = HEAD.format(
        slack=SLACK,
        stalled=STALLED,
        tries=TRIES - 1,
        codes=codes(outcomes),
        commit=stored.facts['firmware'],
        flights=count_flights(outcomes),
        late=describe_lateness(outcomes.values()),
        again=f'{again} were' if again else 'None was',
        stalls=sum(row.get('late', 0.0) > STALLED for row in outcomes.values()),
    )
    light = LIGHT_HEAD.format(told=TOLD, again=AGAIN, slack=SLACK)
    lines = [*rows(outcomes), light, *light_rows(outcomes), told]
    return head + '\n'.join(lines).rstrip('\n') + '\n'


def replace_light_rows(outcomes: dict[Case, Row]) -> StoredCampaign:
    """Return the stored campaign with other rows of the light link."""
    facts, stored = read_stored(RECORD)
    flights = {case: row for case, row in stored.items() if case.kind not in LIGHT_KINDS}
    return StoredCampaign(facts, flights | outcomes)


def fate(kind: Kind) -> str:
    """Return what becomes of a flight, in words."""
    if not any(kind.stated):
        return 'cannot be armed'
    return 'flies on, and lands on request' if kind.flies_on else kind.ends


def main() -> int:
    """Print the table and write the page; 1 where anything was not as stated."""
    told = asked('Faults in flight.', ALL, EACH, Path('runs') / 'faults')
    path = told.out / f'{version()}.jsonl'
    slow_down(told.slower, told.out)
    outcomes = campaign(turn_about(told.kinds, told.each), path, told.side, flown)
    status = printed([*rows(outcomes), *light_rows(outcomes)], path, outcomes)
    kinds = {case.kind for case in outcomes}
    if kinds == set(ALL):
        # The commit that the emulator is held to
        commit = json.loads(FIRMWARE.read_text())['builds'][APP]['commit']
        campaigned = StoredCampaign({'firmware': commit}, outcomes)
    elif kinds == set(LIGHT_KINDS):
        campaigned = replace_light_rows(outcomes)
    else:
        return status
    PAGE.write_text(compose_page(store(RECORD, campaigned)), encoding='utf-8')
    return status


if __name__ == '__main__':
    sys.exit(main())
