"""Summarize a mission log in numbers."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, final

from lta_energy.irradiance import IrradianceSeries
from lta_energy.mission import ASLEEP, MissionLog

FAILURE_WORDS: Final = {
    'empty': 'empty in flight',
    'away': 'landed away at half the reserve',
    'lost': 'did not find the perch',
    'escaped': 'left the room',
    'stopped': 'stopped its motors',
}


@final
@dataclass(frozen=True, slots=True)
class MissionFigures:
    """Summary of one mission; energies in J, times in s."""

    flights: int
    not_flown: int  # flights that the schedule wanted while the gas was too light
    # Number of flights that reached every beacon, and of beacons reached
    rounds: int
    visits: int
    # Time in the air, and the longest flight
    flown: float
    longest: float
    failures: Mapping[str, int]  # number of failures by kind
    # Energy balance
    harvested: float
    curtailed: float
    consumed: float
    lost: float
    stored: float
    imbalance: float  # error of the balance relative to the energy harvested or consumed [1]
    in_flight: float  # mean power drawn in flight [W]
    # Lowest true values in flight [1, V]
    lowest_charge: float | None
    lowest_voltage: float | None
    gauge_error: float  # largest error of the drone's charge estimate [1]
    asleep: float  # share of the time asleep [1]

    @property
    def failure_count(self) -> int:
        """Total number of failures."""
        return sum(self.failures.values())


def summarize_mission(diary: MissionLog, beacons: int) -> MissionFigures:
    """Summarize a mission log; `beacons` is the number of beacons in a round."""
    flights, flow = diary.flights, diary.spent
    flight_time = sum(each.duration for each in flights)
    spent = sum(each.spent.consumed for each in flights)
    # Failed flights by ending, then the counts of the log.
    failures = Counter(FAILURE_WORDS[each.ending] for each in flights if each.ending != 'home')
    failures.update({'came home in the dark': diary.dark, 'empty on the perch': diary.outages})
    apart = [abs(a - b) for a, b in zip(diary.charge, diary.told, strict=True)]
    return MissionFigures(
        flights=len(flights),
        not_flown=diary.grounded,
        rounds=sum(each.visits == beacons for each in flights),
        visits=sum(each.visits for each in flights),
        flown=flight_time,
        longest=max((each.duration for each in flights), default=0.0),
        failures={name: count for name, count in failures.items() if count},
        harvested=flow.harvested,
        curtailed=flow.curtailed,
        consumed=flow.consumed,
        lost=flow.lost,
        stored=diary.ended - diary.begun,
        imbalance=diary.imbalance,
        in_flight=spent / flight_time if flight_time else 0.0,
        lowest_charge=min((each.after for each in flights), default=None),
        lowest_voltage=min((each.lowest for each in flights), default=None),
        gauge_error=max(apart, default=0.0),
        asleep=time_share(diary, ASLEEP),
    )


def time_share(diary: MissionLog, state: int) -> float:
    """Return the share of the time that the drone spent in a state. [1]"""
    spans = zip(diary.time[:-1], diary.time[1:], diary.state[:-1], strict=True)
    # At least 1 s, so that an empty log gives 0 rather than a division by zero.
    whole = max(diary.time[-1] - diary.time[0], 1.0) if diary.time else 1.0
    return sum(end - begin for begin, end, own in spans if own == state) / whole


def flight_minutes_by_hour(diary: MissionLog, light: IrradianceSeries) -> list[float]:
    """Return the time flown in each hour of the mission. [min]"""
    hours = [0.0] * round(light.end / 3600.0)
    for flight in diary.flights:
        # A flight counts in the hour in which it starts; the last hour takes one at the very end.
        hours[min(int(flight.start / 3600.0), len(hours) - 1)] += flight.duration / 60.0
    return hours
