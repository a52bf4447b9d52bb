"""Tuning from the order to the page: search, compare, margins, limits, files."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import final

from lta_config.errors import BadInput
from lta_config.files import find as find_file
from lta_config.schema.vehicle_file import load_vehicle_file
from lta_control.cascade import CascadeGains
from lta_control.gains_file import load_gains
from lta_report.children import Children
from lta_studies.tune import exam
from lta_studies.tune.book import Book, identity
from lta_studies.tune.compare import compared, drawn, Flights
from lta_studies.tune.crew import crew, fly_all, Task
from lta_studies.tune.exam import Case, Scene
from lta_studies.tune.find import find, Found
from lta_studies.tune.gains_text import check_writable, rounded, write_gains
from lta_studies.tune.limit import helium_limit, HeliumLimit, rotors_carry
from lta_studies.tune.numbers import changed, chosen, Number
from lta_studies.tune.progress import TuneProgress
from lta_studies.tune.steadiness import CRUISE, Steadiness, steadiness
from rich.console import Console

LAW = 'cascade'  # the law whose gains this examines
GAINS_NAME = 'gains.yaml'


@final
@dataclass(frozen=True, slots=True)
class Order:
    """What to tune and how; losses in kg."""

    vehicle: str
    gains: str | None = None
    least: float = 0.0
    most: float = 6e-3
    cases: int = 4
    budget: int = 101
    draws: int = 20
    seed: int = 1
    numbers: tuple[str, ...] = ()
    workers: int = 2
    folder: Path | None = None
    out: Path | None = None
    command: str = 'lta tune'


@final
@dataclass(frozen=True, slots=True)
class Side:
    """One set of gains and what is known of it."""

    gains: CascadeGains
    flights: Flights
    steadiness: tuple[Steadiness, ...]
    limit: HeliumLimit


@final
@dataclass(frozen=True, slots=True)
class Tuned:
    """
    How a tuning went.

    Attributes
    ----------
    found : Found
        What the search found.
    numbers : tuple of Number
        What it turned, as it was before.
    old, new : Side
        Before and after.
    losses : tuple of float
        Of the examinations of the search. [kg]
    file, folder : Path
        The gains file, and where all is kept.

    """

    order: Order
    gains_name: str
    found: Found
    numbers: tuple[Number, ...]
    old: Side
    new: Side
    losses: tuple[float, ...]
    file: Path
    folder: Path


def gains_of(vehicle: str, named: str | None) -> str:
    """Return the gains to start from; `BadInput` where the vehicle flies by another law."""
    control = load_vehicle_file(vehicle).control
    law = control.law if control else 'none'
    if law != LAW:
        raise BadInput(
            f'{vehicle} flies by the control law {law}, and the examination is of {LAW}; name a '
            f'vehicle whose control block says {LAW}.'
        )
    if named is None and (control is None or control.gains is None):
        raise BadInput(f'{vehicle} names no gains in its control block; start from --gains NAME.')
    return named or (control.gains if control and control.gains else '')


def cases_of(order: Order) -> list[Case]:
    """Return the examinations of the search: losses evenly over the spread, a seed each."""
    gap = (order.most - order.least) / max(1, order.cases - 1)
    return [Case(order.least + k * gap, order.seed + k) for k in range(order.cases)]


def check(order: Order) -> None:
    """Refuse a spread that no gains could hold."""
    if order.least > order.most:
        raise BadInput(
            f'The spread goes from {1e3 * order.least:g} g to {1e3 * order.most:g} g; give the '
            'smaller loss first.'
        )
    most = rotors_carry(Scene(order.vehicle).known)
    if order.most >= most:
        raise BadInput(
            f'At a loss of {1e3 * order.most:g} g the rotors of {order.vehicle} cannot carry it '
            f'any more, which ends at {1e3 * most:.1f} g; take a smaller --most.'
        )


def tune_once(order: Order, console: Console) -> Tuned:
    """
    Search gains, compare them with where they began, and write the gains file.

    Raises
    ------
    BadInput
        If it cannot be done as ordered; nothing was flown then.

    """
    name = gains_of(order.vehicle, order.gains)
    check(order)
    old = load_gains(name)
    if order.out:
        check_writable(order.out)
    numbers = chosen(old, order.numbers)
    scene, cases = Scene(order.vehicle), cases_of(order)
    about = subject(order, old, numbers)
    folder = (
        order.folder or Path('runs') / f'tune-{scene_name(order)}-{identity(about)[:8]}'
    ).absolute()
    with (
        Book(folder, identity(about)) as book,
        TuneProgress(console, order.budget, len(cases)) as progress,
        crew(order.workers) as workers,
    ):
        flown = partial(examined, scene, old, cases, workers)
        found = find(numbers, flown, book, order.budget, order.seed, progress.candidate)
        best = {path: rounded(value) for path, value in found.numbers.items()}
        new = changed(old, best)
        file = order.out or folder / GAINS_NAME
        write_gains(new, words(order, name, found, len(cases)), file)
        progress.stage(f'flying {order.draws} fresh draws with old and new gains')
        fresh = drawn(order.least, order.most, order.draws, order.seed)
        flights = compared(scene, (old, new), fresh, workers)
        progress.stage('margins and limits')
        before, after = (
            side(scene, gains, own, order) for gains, own in zip((old, new), flights, strict=True)
        )
    losses = tuple(case.loss for case in cases)
    return Tuned(order, name, found, tuple(numbers), before, after, losses, file, folder)


def examined(
    scene: Scene,
    start: CascadeGains,
    cases: Sequence[Case],
    workers: Children,
    candidate: Mapping[str, float],
) -> list[float]:
    """Return the cost of each examination of a candidate."""
    gains = changed(start, candidate)
    tasks = [Task(scene, gains, case) for case in cases]
    return [report.cost for report in fly_all(tasks, workers)]


def side(scene: Scene, gains: CascadeGains, flights: Flights, order: Order) -> Side:
    """Return what is known of a set of gains."""
    middle = 0.5 * (order.least + order.most)
    losses = sorted({order.least, middle, order.most})
    margins = steadiness(scene, gains, losses, (0.0, CRUISE))
    return Side(gains, flights, tuple(margins), helium_limit(scene.vehicle, gains))


def scene_name(order: Order) -> str:
    """Return the vehicle's own name."""
    return load_vehicle_file(order.vehicle).name


def subject(order: Order, gains: CascadeGains, numbers: Sequence[Number]) -> dict[str, object]:
    """Return all that the costs of a search depend on."""
    return {
        'vehicle': find_file('vehicle', order.vehicle).read_text(encoding='utf-8'),
        'gains': gains.model_dump(),
        'numbers': [asdict(number) for number in numbers],
        'cases': [asdict(case) for case in cases_of(order)],
        'steps': [list(step) for step in exam.STEPS],
        'seed': order.seed,
    }


def words(order: Order, start: str, found: Found, cases: int) -> list[str]:
    """Return the comment above the gains."""
    count = len(found.history)
    ended = ', stopped early' if found.stopped else ''
    return [
        f'Gains for {scene_name(order)}, found by: {order.command}',
        f'{count} candidates with {cases} examinations each{ended}, from the gains {start}; '
        f'search seed {order.seed}.',
        f'Lift lost: {1e3 * order.least:g} to {1e3 * order.most:g} g against the trim of its '
        f'file; seeds {order.seed} to {order.seed + cases - 1}.',
        f'Cost {found.first:.3f} before, {found.cost:.3f} after (half the mean and half the '
        'worst; see lta tune --help).',
    ]


def traced(
    scene: Scene, gains: CascadeGains, cases: Sequence[Case]
) -> list[tuple[float, exam.Trace]]:
    """Return what examinations looked like, each with its loss [kg]."""
    return [(case.loss, exam.fly(scene, gains, case)) for case in cases]
