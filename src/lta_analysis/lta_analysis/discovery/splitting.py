"""One flight, or flights without a second one to confirm by, split in time."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

from lta_analysis.discovery.bags import Role
from lta_analysis.discovery.measured import Measured, PERIOD, WARM_UP

Flights = Sequence[tuple[str, Role, Measured]]

# Where the parts of a flight end, as shares of what can be used of it.
ONE: Final[tuple[tuple[Role, float], ...]] = (('train', 0.4), ('confirm', 0.7), ('holdout', 1.0))
KEPT: Final[tuple[tuple[Role, float], ...]] = (('train', 0.55), ('confirm', 1.0))
WEAK: Final = (
    'confirms less than another flight would: what is wrong with a flight is wrong with its parts'
)


def part(flight: Measured, begin: float, end: float) -> Measured:
    """Return a flight between two times; its motors and filters settle anew. [s]"""
    inside = (flight.time >= begin - 1e-9) & (flight.time <= end + 1e-9)
    time = flight.time[inside]
    return replace(
        flight,
        time=time,
        position=flight.position[inside],
        quaternion=flight.quaternion[inside],
        readings=flight.readings[inside],
        usable=flight.usable[inside] & (time >= begin + WARM_UP),
        voltage=flight.voltage[inside],
    )


def parts(
    name: str, flight: Measured, shares: Sequence[tuple[Role, float]]
) -> list[tuple[str, Role, Measured]]:
    """Return a flight in parts, each with its role."""
    out, begin = [], float(flight.time[0])
    known = flight.time[flight.usable]
    for role, share in shares:
        end = float(known[min(int(share * len(known)), len(known) - 1)])
        end = float(flight.time[-1]) if share == 1.0 else end
        label = f'{name} {begin:.0f} to {end:.0f} s'
        out.append((label, role, part(flight, begin, end)))
        begin = end + PERIOD
    return out


def with_all_roles(flights: Flights) -> tuple[list[tuple[str, Role, Measured]], list[str]]:
    """
    Return flights of which some confirm, and a sentence where that takes a split.

    One flight alone becomes three parts, so that there is something to learn from, to confirm by
    and to show. Of several without one to confirm by, the last one does; one beside flights that
    are held out is split in two.
    """
    roles = [role for _, role, _ in flights]
    if 'confirm' in roles:
        return list(flights), []
    training = [one for one in flights if one[1] == 'train']
    rest = [one for one in flights if one[1] != 'train']
    if len(training) > 1:
        name, _, flight = training[-1]
        moved: tuple[str, Role, Measured] = (name, 'confirm', flight)
        word = f'No flight was given to confirm by: {name} does, and teaches nothing.'
        return [*training[:-1], moved, *rest], [word]
    name, _, flight = training[0]
    shares = KEPT if rest else ONE
    word = f'{name} alone teaches and confirms, split in time; that {WEAK}.'
    return [*parts(name, flight, shares), *rest], [word]
