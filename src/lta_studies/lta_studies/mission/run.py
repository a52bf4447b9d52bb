# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Summarize a mission log in numbers."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from operator import attrgetter
from typing import Final, final, Literal, NamedTuple

from lta_config.schema.mission_file import DAY, LightDay, load_light_day, load_mission, MissionFile
from lta_energy.irradiance import IrradianceSeries, simulate_irradiance
from lta_energy.mission import ASLEEP, MissionLog
from lta_flight.sweep.statistics import bootstrap_mean, bootstrap_ratio, BootstrapMean
from lta_report.report import Report
from lta_report.request import argument, option, StudyRequest, StudyRun
from lta_report.results_folder import resolve_folder
from lta_report.study import hash_inputs, Study
from lta_report.study_store import StoreFormat
from lta_report.workers import report_progress
from lta_studies.mission.flyer import AWARE, build_simulation, DOZING, NAIVE
from lta_studies.mission.scene import MissionScene
from pydantic import TypeAdapter

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
    """Return the share of the time that the drone spent in a state [1]."""
    spans = zip(diary.time[:-1], diary.time[1:], diary.state[:-1], strict=True)
    # At least 1 s, so that an empty log gives 0 rather than a division by zero.
    whole = max(diary.time[-1] - diary.time[0], 1.0) if diary.time else 1.0
    return sum(end - begin for begin, end, own in spans if own == state) / whole


def flight_minutes_by_hour(diary: MissionLog, light: IrradianceSeries) -> list[float]:
    """Return the time flown in each hour of the mission [min]."""
    hours = [0.0] * round(light.end / 3600.0)
    for flight in diary.flights:
        # A flight counts in the hour in which it starts; the last hour takes one at the very end.
        hours[min(int(flight.start / 3600.0), len(hours) - 1)] += flight.duration / 60.0
    return hours


SCHEDULES: Final = (AWARE, NAIVE, DOZING)
MISSION_STORE: Final = StoreFormat('missions.jsonl', 'mission', 'mission', TypeAdapter(MissionLog))


class MissionJob(NamedTuple):
    """One mission to simulate."""

    schedule: str
    seed: int

    @property
    def key(self) -> str:
        """Name in the store."""
        return f'{self.schedule}, seed {self.seed}'


class MissionResult(NamedTuple):
    """One simulated mission: schedule, seed, log and summary."""

    schedule: str
    seed: int
    diary: MissionLog
    figures: MissionFigures


@final
class MissionStudyRequest(
    StudyRequest, command='mission', quick={'days': 1, 'seeds': 1, 'schedule': 'by light'}
):
    """
    Simulate a solar-powered mission: perch and charge, fly if energy allows, return before dark.

    A mission file defines the beacons to visit, the light in which to charge, and the reserve.
    Flights use the compiled model and controller, which a first run compiles for some minutes;
    perching is simulated in steps of 30 s. Three schedules run on the same days: ours, which uses
    the light forecast and the estimated charge, and a fixed duty cycle that either stays awake or
    sleeps between flights.

    Writes a page, mission.json (SI units), and missions.jsonl with the log of each run. To resume
    a stopped run, repeat the command with the same --out.

    Exit status 0: done. 2: bad input. 130: Ctrl-C.

    Example: lta mission greenhouse --days 2 --seeds 5
    """

    name: str = argument('Mission: a shipped name or a file.', default='greenhouse')
    days: int = option('Days to simulate.', default=1, low=1, high=365)
    seeds: int = option(
        'Number of runs, each with different weather.', default=1, low=1, high=1000
    )
    seed: int = option('Random seed.', default=1, low=0)
    schedule: Literal['all', 'by light', 'duty cycle', 'duty cycle, asleep'] = option(
        'Flight schedule. by light: fly when light and battery charge allow. duty cycle: fly at '
        'fixed times (baseline). duty cycle, asleep: the same, with sleep between flights. all: '
        'simulate all three.',
        default='all',
    )

    def run(self, run: StudyRun) -> Report:
        """Return the report of all schedules and seeds."""
        from lta_studies.mission.report import build_report

        schedules = SCHEDULES if self.schedule == 'all' else (self.schedule,)
        # Consecutive seeds, each with its own clouds
        seeds = range(self.seed, self.seed + self.seeds)
        request = load_request(self.name, self.days, seeds, schedules)
        run.open_folder(resolve_folder(None, f'mission-{request.mission.name}'))
        return build_report(request, run_missions(request, run))


@final
@dataclass(frozen=True, slots=True)
class MissionRequest:
    """Options of a mission study."""

    mission: MissionFile
    day: LightDay  # light over a day
    scenes: MissionScene  # vehicle and scene
    days: int  # number of days
    seeds: Sequence[int]  # random seeds of clouds, meters and flights
    schedules: Sequence[str]  # some of `SCHEDULES`

    def simulate_light(self, seed: int) -> IrradianceSeries:
        """Simulate the light for a seed."""
        return simulate_irradiance(self.day, self.days, seed)

    @property
    def digest(self) -> str:
        """Hash of everything that the results depend on, except seeds and schedules."""
        parts = (self.mission, self.day, self.scenes.vehicle.file, self.scenes.scenario)
        # Seeds and schedules are in the keys instead, so more can be added to a folder.
        return hash_inputs(*(each.model_dump_json() for each in parts), self.days)[:16]

    def simulate(self, job: MissionJob) -> MissionLog:
        """Simulate one mission; workers call this."""
        simulation, _ = build_simulation(
            self.mission, self.day, self.scenes, job.schedule, self.days, job.seed
        )
        return simulation.run(lambda now: report_progress(now / (DAY * self.days)))


def load_request(
    name: str, days: int, seeds: Sequence[int], schedules: Sequence[str]
) -> MissionRequest:
    """Load a mission; raise `BadInput` if it cannot be flown."""
    mission = load_mission(name)
    return MissionRequest(
        mission, load_light_day(mission.light), MissionScene(mission), days, seeds, schedules
    )


def run_missions(request: MissionRequest, run: StudyRun) -> list[MissionResult]:
    """
    Simulate the missions that are not stored in the folder; return the results of all.

    Each is stored when it is complete. Raise `BadInput` if the folder belongs to something else,
    or a simulation failed.
    """
    jobs = [MissionJob(schedule, seed) for seed in request.seeds for schedule in request.schedules]
    study = Study(request.simulate, attrgetter('key'), MISSION_STORE, 'missions')
    logs = run.run_study(study, request.digest, jobs)
    beacons = len(request.mission.round)
    return [
        MissionResult(*job, log, summarize_mission(log, beacons))
        for job, log in zip(jobs, logs, strict=True)
    ]


def filter_by_schedule(results: Sequence[MissionResult], schedule: str) -> list[MissionResult]:
    """Return the results of one schedule, in the order of the seeds."""
    return [each for each in results if each.schedule == schedule]


def mean_daily_minutes(results: Sequence[MissionResult], days: int) -> BootstrapMean:
    """Return the minutes flown per day, with the interval over seeds."""
    return bootstrap_mean([each.figures.flown / 60.0 / days for each in results])


def find_best_rival(results: Sequence[MissionResult]) -> str | None:
    """Return the schedule, other than the light-aware one, that flies most; None without any."""
    others = {each.schedule: 0.0 for each in results if each.schedule != AWARE}
    for name in others:
        others[name] = sum(each.figures.flown for each in filter_by_schedule(results, name))
    return max(others, key=others.__getitem__, default=None)


def ratio_to_rival(results: Sequence[MissionResult], rival: str) -> BootstrapMean | None:
    """Return the ratio of flown time, light-aware to another schedule, over the same seeds."""
    ours, naive = filter_by_schedule(results, AWARE), filter_by_schedule(results, rival)
    # The ratio does not exist for a schedule that never flew.
    if not (ours and naive and all(each.figures.flown for each in naive)):
        return None
    return bootstrap_ratio(
        [each.figures.flown for each in ours], [each.figures.flown for each in naive]
    )
