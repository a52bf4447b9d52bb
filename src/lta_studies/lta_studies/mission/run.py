"""Simulate a mission under several schedules and seeds on all cores; resumes if stopped."""

from collections.abc import Callable, Sequence
from concurrent.futures import as_completed, CancelledError, ThreadPoolExecutor
from dataclasses import dataclass
import hashlib
import json
import os
from pathlib import Path
from threading import Event
from typing import Final, final, NamedTuple

from lta_config.errors import BadInput
from lta_config.schema.light_day_file import DAY, LightDay, load_light_day
from lta_config.schema.mission_file import load_mission, MissionFile
from lta_energy.irradiance import IrradianceSeries, simulate_irradiance
from lta_energy.mission_log import MissionLog
from lta_report.results_folder import write_json
from lta_studies.light.evaluation.intervals import bootstrap_mean, bootstrap_ratio, BootstrapMean
from lta_studies.mission.figures import from_json, MissionFigures, summarize_mission, to_json
from lta_studies.mission.flyer import MissionFlyer
from lta_studies.mission.scene import MissionScene
from lta_studies.mission.simulate_mission import AWARE, build_simulation, DOZING, NAIVE

SCHEDULES: Final = (AWARE, NAIVE, DOZING)
KEPT: Final = 'lives_of.json'  # identifies the mission of a results folder


class MissionResult(NamedTuple):
    """One simulated mission: schedule, seed, log and summary."""

    schedule: str
    seed: int
    diary: MissionLog
    figures: MissionFigures


@final
@dataclass(frozen=True, slots=True)
class MissionRequest:
    """
    Options of a mission study.

    Parameters
    ----------
    mission : MissionFile
        The mission.
    day : LightDay
        Light over a day.
    scenes : MissionScene
        Vehicle and scene.
    days : int
        Number of days.
    seeds : sequence of int
        Random seeds of clouds, meters and flights.
    schedules : sequence of str
        Some of `SCHEDULES`.

    """

    mission: MissionFile
    day: LightDay
    scenes: MissionScene
    days: int
    seeds: Sequence[int]
    schedules: Sequence[str]

    def simulate_light(self, seed: int) -> IrradianceSeries:
        """Simulate the light for a seed."""
        return simulate_irradiance(self.day, self.days, seed)

    @property
    def digest(self) -> str:
        """Hash of everything that the results depend on, except seeds and schedules."""
        parts = [
            each.model_dump_json()
            for each in (self.mission, self.day, self.scenes.vehicle.file, self.scenes.scenario)
        ]
        # Seeds and schedules name the result files instead, so more can be added to a folder.
        return hashlib.sha256('\n'.join([*parts, str(self.days)]).encode()).hexdigest()[:16]


def load_request(
    name: str, days: int, seeds: Sequence[int], schedules: Sequence[str]
) -> MissionRequest:
    """Load a mission; raise `BadInput` if it cannot be flown."""
    mission = load_mission(name)
    return MissionRequest(
        mission, load_light_day(mission.light), MissionScene(mission), days, seeds, schedules
    )


def run_missions(
    request: MissionRequest, folder: Path, on_progress: Callable[[float], None]
) -> list[MissionResult]:
    """
    Simulate all missions; load those that an earlier run left in the folder.

    Ctrl-C or an error cancels the running simulations at their next progress report.

    Parameters
    ----------
    request : MissionRequest
        Options.
    folder : Path
        Folder for the results; each is written when it is complete.
    on_progress : callable
        Called with the simulated seconds since its last call.

    """
    claim_results_folder(request, folder)
    jobs = [(schedule, seed) for seed in request.seeds for schedule in request.schedules]
    # Threads suffice: the compiled kernel releases the GIL (`nogil`).
    cores = len(os.sched_getaffinity(0))
    found: dict[tuple[str, int], MissionLog] = {}
    stopping = Event()

    def report_progress(gone: float) -> None:
        # A thread cannot be killed; it stops at its next progress report.
        if stopping.is_set():
            raise CancelledError
        on_progress(gone)

    if not all(result_path(folder, *job).exists() for job in jobs):
        # Compile in the main thread: Ctrl-C cannot stop the compiler in another one.
        compile_flight(request)
    with ThreadPoolExecutor(cores) as pool:
        running = {
            pool.submit(load_or_simulate, request, folder, *job, report_progress): job
            for job in jobs
        }
        try:
            for done in as_completed(running):
                found[running[done]] = done.result()
        except BaseException:
            stopping.set()  # leaving the pool waits for its threads even with wait=False
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    beacons = len(request.mission.round)
    return [
        MissionResult(*job, found[job], summarize_mission(found[job], beacons)) for job in jobs
    ]


def claim_results_folder(request: MissionRequest, folder: Path) -> None:
    """Mark a results folder with its mission; raise `BadInput` if it belongs to another."""
    note = folder / KEPT
    if note.exists():
        stored = json.loads(note.read_text(encoding='utf-8')).get('digest')
        if stored != request.digest:
            raise BadInput(
                f"'{folder}' holds another mission's results; choose another folder with --out."
            )
        return
    if folder.exists() and any(folder.iterdir()):
        raise BadInput(f"'{folder}' is not empty; choose another folder with --out.")
    folder.mkdir(parents=True, exist_ok=True)
    write_json({'name': request.mission.name, 'digest': request.digest}, note)


def result_path(folder: Path, schedule: str, seed: int) -> Path:
    """Return the file of a result."""
    # 'duty cycle, asleep' becomes 'duty_cycle_asleep'.
    return folder / f'{schedule.replace(",", "").replace(" ", "_")}_{seed}.json'


def compile_flight(request: MissionRequest) -> None:
    """Compile the flight kernel."""
    light = request.simulate_light(request.seeds[0])
    MissionFlyer(request.mission, request.scenes, light, request.seeds[0]).compile_kernel()


def load_or_simulate(
    request: MissionRequest,
    folder: Path,
    schedule: str,
    seed: int,
    on_progress: Callable[[float], None],
) -> MissionLog:
    """Return one mission log, from its file if it exists."""
    path = result_path(folder, schedule, seed)
    if path.exists():
        # A loaded result counts as a whole mission in the progress bar. [s]
        on_progress(DAY * request.days)
        return from_json(json.loads(path.read_text(encoding='utf-8')))
    simulation, _ = build_simulation(
        request.mission, request.day, request.scenes, schedule, request.days, seed
    )
    last = 0.0

    def report_progress(now: float) -> None:
        nonlocal last
        # The bar counts simulated seconds over all missions, so report differences.
        on_progress(now - last)
        last = now

    diary = simulation.run(report_progress)
    write_json(to_json(diary), path)
    return diary


def filter_by_schedule(results: Sequence[MissionResult], schedule: str) -> list[MissionResult]:
    """Return the results of one schedule, in the order of the seeds."""
    return [each for each in results if each.schedule == schedule]


def mean_daily_minutes(results: Sequence[MissionResult], days: int) -> BootstrapMean:
    """Return the minutes flown per day, with the interval over seeds."""
    return bootstrap_mean([each.figures.flown / 60.0 / days for each in results])


def flight_time_ratio(results: Sequence[MissionResult]) -> BootstrapMean | None:
    """Return the ratio of flown time, light-aware to duty cycle, over the same seeds."""
    ours, naive = filter_by_schedule(results, AWARE), filter_by_schedule(results, NAIVE)
    # The ratio does not exist for a schedule that never flew.
    if not (ours and naive and all(each.figures.flown for each in naive)):
        return None
    return bootstrap_ratio(
        [each.figures.flown for each in ours], [each.figures.flown for each in naive]
    )
