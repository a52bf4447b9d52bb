"""Live a mission under several schedules and seeds, on all cores, and go on where it stopped."""

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
from lta_energy.diary import Diary
from lta_energy.light_of_days import light_of, LightOfDays
from lta_report.results_folder import keep_json
from lta_studies.light.evaluation.intervals import Mean, mean, ratio
from lta_studies.mission.figures import Figures, figures_of, from_json, to_json
from lta_studies.mission.flyer import Flyer
from lta_studies.mission.lived import AWARE, DOZING, life_of, NAIVE
from lta_studies.mission.scene import Scenes

SCHEDULES: Final = (AWARE, NAIVE, DOZING)
KEPT: Final = 'lives_of.json'  # in the folder of the results: what its lives are of


class Told(NamedTuple):
    """One life: its schedule and seed, its diary, its figures."""

    schedule: str
    seed: int
    diary: Diary
    figures: Figures


@final
@dataclass(frozen=True, slots=True)
class Order:
    """
    What is to be lived.

    Parameters
    ----------
    mission : MissionFile
        The mission.
    day : LightDay
        Its light.
    scenes : Scenes
        What it flies in.
    days : int
        How many.
    seeds : sequence of int
        Of clouds, meters and flights.
    schedules : sequence of str
        Of `SCHEDULES`.

    """

    mission: MissionFile
    day: LightDay
    scenes: Scenes
    days: int
    seeds: Sequence[int]
    schedules: Sequence[str]

    def light(self, seed: int) -> LightOfDays:
        """Return the light of a seed."""
        return light_of(self.day, self.days, seed)

    @property
    def digest(self) -> str:
        """What changes when any life of it would."""
        parts = [
            each.model_dump_json()
            for each in (self.mission, self.day, self.scenes.vehicle.file, self.scenes.scenario)
        ]
        return hashlib.sha256('\n'.join([*parts, str(self.days)]).encode()).hexdigest()[:16]


def order_of(name: str, days: int, seeds: Sequence[int], schedules: Sequence[str]) -> Order:
    """Return what is to be lived; `BadInput` where the mission cannot be."""
    mission = load_mission(name)
    return Order(mission, load_light_day(mission.light), Scenes(mission), days, seeds, schedules)


def run(order: Order, folder: Path, told: Callable[[float], None]) -> list[Told]:
    """
    Return all lives, those from an earlier run in the folder as they were.

    Ctrl-C ends all that are being lived at their next stretch, as does one that breaks.

    Parameters
    ----------
    order : Order
        What is to be lived.
    folder : Path
        Where each life is written when it ends.
    told : callable
        Hears how many seconds of missions have gone by since it last heard.

    """
    begin(order, folder)
    jobs = [(schedule, seed) for seed in order.seeds for schedule in order.schedules]
    cores = len(os.sched_getaffinity(0))
    found: dict[tuple[str, int], Diary] = {}
    stopping = Event()

    def heard(gone: float) -> None:
        if stopping.is_set():
            raise CancelledError
        told(gone)

    if not all(place(folder, *job).exists() for job in jobs):
        # In this thread, which Ctrl-C ends: nothing stops another one in the compiler.
        compiled(order)
    with ThreadPoolExecutor(cores) as pool:
        running = {pool.submit(one, order, folder, *job, heard): job for job in jobs}
        try:
            for done in as_completed(running):
                found[running[done]] = done.result()
        except BaseException:
            stopping.set()  # the pool waits for its threads whatever it is told
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    beacons = len(order.mission.round)
    return [Told(*job, found[job], figures_of(found[job], beacons)) for job in jobs]


def begin(order: Order, folder: Path) -> None:
    """Note in the folder what its lives are of, or see that it is the same."""
    note = folder / KEPT
    if note.exists():
        kept = json.loads(note.read_text(encoding='utf-8')).get('digest')
        if kept != order.digest:
            raise BadInput(
                f"'{folder}' holds another mission's results; choose another folder with --out."
            )
        return
    if folder.exists() and any(folder.iterdir()):
        raise BadInput(f"'{folder}' holds something else; choose another folder with --out.")
    folder.mkdir(parents=True, exist_ok=True)
    keep_json({'name': order.mission.name, 'digest': order.digest}, note)


def place(folder: Path, schedule: str, seed: int) -> Path:
    """Return where a life is kept."""
    return folder / f'{schedule.replace(",", "").replace(" ", "_")}_{seed}.json'


def compiled(order: Order) -> None:
    """Have compiled what flies."""
    light = order.light(order.seeds[0])
    Flyer(order.mission, order.scenes, light, order.seeds[0]).compile()


def one(
    order: Order, folder: Path, schedule: str, seed: int, told: Callable[[float], None]
) -> Diary:
    """Return one life, from its file where it has been lived already."""
    path = place(folder, schedule, seed)
    if path.exists():
        told(DAY * order.days)
        return from_json(json.loads(path.read_text(encoding='utf-8')))
    life, _ = life_of(order.mission, order.day, order.scenes, schedule, order.days, seed)
    last = 0.0

    def heard(now: float) -> None:
        nonlocal last
        told(now - last)
        last = now

    diary = life.live(heard)
    keep_json(to_json(diary), path)
    return diary


def of(lives: Sequence[Told], schedule: str) -> list[Told]:
    """Return the lives under one schedule, by seed."""
    return [each for each in lives if each.schedule == schedule]


def minutes(lives: Sequence[Told], days: int) -> Mean:
    """Return the minutes flown a day, with the interval over seeds."""
    return mean([each.figures.flown / 60.0 / days for each in lives])


def gain(lives: Sequence[Told]) -> Mean | None:
    """Return what the energy-aware schedule flies by what the naive does, over the same seeds."""
    ours, naive = of(lives, AWARE), of(lives, NAIVE)
    if not (ours and naive and all(each.figures.flown for each in naive)):
        return None
    return ratio([each.figures.flown for each in ours], [each.figures.flown for each in naive])
