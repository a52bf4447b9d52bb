# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Compare calibrated models with forecasts that one writes in an evening.

`lta calibrate` and two peers (`forecast_peers.py`) learn from the same training flights, and
forecast the same held-out flights from the same starts, beside coasting, the vehicle file and a
perfect model. The flights are those of a GT-MAB (github.com/gtfactslab/Kasmalkar_LCSS2024) and of
RGBlimp (github.com/zhu-yj/ABNODE) in LTA_DATA, and three cases of the independent simulator.
"""

from argparse import Namespace
from collections.abc import Callable, Iterator, Mapping, Sequence
import math
import os
from pathlib import Path
import tempfile
from typing import Final, final, NamedTuple

from lta_data.importers.run import import_logs, ImportRequest
from lta_discovery.calibration.calibration import calibrate_flights
from lta_discovery.calibration.prepared_flights import prepare_calibration
from lta_discovery.discovery.forecast_comparison import compare_forecasts, ComparedModel
from lta_discovery.flights.bags import read_bags, Role
from lta_discovery.flights.measured_flight import GRID_PERIOD, MeasuredFlight
from lta_discovery.flights.usable_flights import CALIBRATION_TIME, select_usable_flights
from lta_discovery.state_filter.forecasts import FlightForecasts
from lta_model.vehicle import load_vehicle
import numpy as np
from numpy.typing import NDArray

from campaigns import ROOT
from campaigns.calibration import record_case
from campaigns.forecast_peers import Flown, Physics, Ridge, Starts
from campaigns.harness import Campaign, Case, Row, Rows

Array = NDArray[np.float64]

DATA: Final = Path(os.environ.get('LTA_DATA', ROOT.parent / 'shared' / 'data'))
MOCAP, RGBLIMP = DATA / 'mocap_blimp', DATA / 'rgblimp'
FLIGHTS: Final = 100  # of RGBlimp
REPEATS: Final = 4  # of each input
SEED: Final = 2026  # of the drawn flights of RGBlimp, and of the simulated cases
DRAWN: Final = 8  # inputs that teach, and others that are held out
CASES: Final = (0, 1, 2)
MODELS: Final = (
    'coasting', 'vehicle file', 'calibrated', 'physics', 'ridge', 'perfect model',
)  # fmt: skip
MAPPING: Final = """
schema: 1
name: mocap_blimp
about: Flights of a GT-MAB by motion capture, north-east-down, with commanded forces and moment.
format: csv
data: measured
time: {column: time, unit: s}
world: [x, -y, -z]
body: FRD
topics:
  - topic: ground_truth/odom
    position: {columns: [x, y, z], unit: m}
    orientation: {euler: [psi, theta, phi], sequence: ZYX, unit: rad, direction: body to world}
    velocity: {columns: [vx, vy, vz], unit: m/s}
    rates: {columns: [wx, wy, wz], unit: rad/s}
  - topic: wrench_command
    force: {columns: [fx, fy, fz], unit: N}
    torque: {columns: [null, null, tauz], unit: N m}
"""
FIRST_DAY: Final = ('april_21_pid_helix', 'april_21_pid_line', 'april_21_cbf_triangle')
SECOND_DAY: Final = ('april_25_cbf_helix', 'april_25_cbf_line')


@final
class RealStudy(NamedTuple):
    """Bags that teach a vehicle, and groups of held-out bags by title."""

    vehicle: str  # name or file
    train: Sequence[Path]
    held_out: Mapping[str, Sequence[Path]]


@final
class ForecastRow(NamedTuple):
    """RMS errors of position by MODELS at one horizon, over all forecasts of a group [m]."""

    title: str
    horizon: float
    count: int
    errors: tuple[float, ...]

    @property
    def ratio(self) -> float:
        """Error of the calibrated vehicle by that of the better peer."""
        return self.errors[2] / min(self.errors[3:5])


def bring(
    folder: Path, names: Sequence[str], vehicle: str, mapping: str, out: Path
) -> dict[str, Path]:
    """Import flights; return their bags by name."""
    sources = [folder / f'{name}.csv.gz' for name in names]
    order = ImportRequest(sources, mapping, vehicle=vehicle)
    done = import_logs(order, out)
    return {name: Path(one.bag) for name, one in zip(names, done, strict=True)}


def list_mocap(place: Path) -> Iterator[RealStudy]:
    """Yield the studies of the GT-MAB's flights."""
    mapping = place / 'mapping.yaml'
    mapping.write_text(MAPPING, encoding='utf-8')
    names = sorted(path.name.removesuffix('.csv.gz') for path in MOCAP.glob('*.csv.gz'))
    bags = bring(MOCAP, names, 'gtmab', str(mapping), place / 'mocap')

    def rest(day: str, train: Sequence[str]) -> list[Path]:
        return [bags[name] for name in names if name.startswith(day) and name not in train]

    yield RealStudy('gtmab', [bags[name] for name in FIRST_DAY], {
        'GT-MAB, same day': rest('april_21', FIRST_DAY),
        'GT-MAB, another day': rest('april_25', ()),
    })  # fmt: skip
    yield RealStudy('gtmab', [bags[name] for name in SECOND_DAY], {
        'GT-MAB, two flights teach': rest('april_25', SECOND_DAY)
    })  # fmt: skip


def list_rgblimp(place: Path) -> Iterator[RealStudy]:
    """Yield the study of RGBlimp: one flight of each of some inputs teaches."""
    draw = np.random.default_rng(SEED)
    inputs = draw.permutation(FLIGHTS // REPEATS)[: 2 * DRAWN]
    pairs = [draw.permutation(REPEATS)[:2] for _ in inputs]
    one, two = (
        [f'data_{REPEATS * i + pair[k] + 1}' for i, pair in zip(inputs, pairs, strict=True)]
        for k in (0, 1)
    )
    groups = {'RGBlimp, repeats': two[:DRAWN], 'RGBlimp, other inputs': one[DRAWN:]}
    names = [*one, *two[:DRAWN]]
    bags = bring(RGBLIMP, names, 'rgblimp', 'rgblimp', place / 'rgblimp')
    yield RealStudy('rgblimp', [bags[name] for name in one[:DRAWN]], {
        title: [bags[name] for name in group] for title, group in groups.items()
    })  # fmt: skip


def list_simulated(place: Path) -> Iterator[RealStudy]:
    """Yield a study of each simulated case."""
    for number in CASES:
        folder = place / f'case_{number}'
        folder.mkdir()
        _, path, bags = record_case(SEED, number, folder)
        yield RealStudy(str(path), bags['train'], {f'simulated, case {number}': bags['confirm']})


def run_study(study: RealStudy) -> Iterator[ForecastRow]:
    """Yield the rows of a study."""
    vehicle = load_vehicle(study.vehicle)
    held_out = [bag for group in study.held_out.values() for bag in group]
    bags: dict[Role, list[Path]] = {'train': list(study.train), 'confirm': held_out}
    recordings = read_bags(bags, None)
    usable = select_usable_flights(recordings, vehicle, CALIBRATION_TIME).flights
    taught = [one for one in usable if one[1] == 'train']
    found = calibrate_flights(vehicle, study.vehicle, taught, lambda _what, _part: None)
    prepared = prepare_calibration(vehicle, taught)
    horizons = prepared.horizons
    known = [Flown(flight) for _, _, flight in taught]
    physics = Physics.fit(known)
    ridges = {horizon: Ridge.fit(known, horizon) for horizon in horizons}
    group_of = {
        one.name: title
        for one, title in zip(
            [each for each in recordings if each.role == 'confirm'],
            [title for title, group in study.held_out.items() for _ in group],
            strict=True,
        )
    }
    noise = list(found.noise.values())
    models = [
        ComparedModel('vehicle file', found.nominal, noise),
        ComparedModel('calibrated', found.calibrated, noise),
    ]
    training = [flight for _, _, flight in taught]
    held_out = {name: flight for name, role, flight in usable if role != 'train'}
    told = compare_forecasts(
        vehicle, training, held_out, models, prepared.parameters, horizons
    ).forecasts
    for title in study.held_out:
        which = [f for f, name in enumerate(held_out) if group_of[name] == title]
        flights = [[*held_out.values()][f] for f in which]
        file, calibrated = ([told[model.name][f] for f in which] for model in models)
        yield from compare(title, flights, (file, calibrated), physics, ridges)


def compare(
    title: str,
    flights: Sequence[MeasuredFlight],
    told: tuple[Sequence[FlightForecasts], Sequence[FlightForecasts]],
    physics: Physics,
    ridges: Mapping[float, Ridge],
) -> Iterator[ForecastRow]:
    """Yield the errors of all models at each horizon that was reached."""
    flown = [Flown(one) for one in flights]
    at = [
        np.rint((each.starts - one.time[0]) / GRID_PERIOD).astype(np.int64)
        for one, each in zip(flights, told[0], strict=True)
    ]
    starts = Starts(flown, at)
    whole = np.concatenate([[0], np.cumsum([len(one) for one in at])])[starts.of]
    rows = whole + np.array([
        np.searchsorted(at[f], k) for f, k in zip(starts.of, starts.at, strict=True)
    ])  # fmt: skip
    tables = [[one.coasting for one in told[1]], *([one.errors for one in each] for each in told)]
    by_physics = physics.forecast(starts, list(ridges))
    for h, (horizon, ridge) in enumerate(ridges.items()):
        truth = starts.truth(horizon)[:, :3]
        off = np.stack([
            *(np.concatenate(table)[rows, h, :3] for table in tables),
            truth - by_physics[horizon],
            truth - ridge.forecast(starts),
        ])  # fmt: skip
        known = ~np.isnan(off).any(axis=(0, 2))
        # Deviations stand for the errors of a perfect model
        least = np.concatenate([one.floor for one in told[1]])[rows, h, :3]
        off = np.concatenate([off, least[None]])[:, known]
        if known.any():
            errors = np.sqrt(np.nanmean(np.sum(off**2, axis=2), axis=1))
            yield ForecastRow(title, horizon, off.shape[1], tuple(errors.tolist()))


SETS: Final[Mapping[str, tuple[Path | None, Callable[[Path], Iterator[RealStudy]]]]] = {
    'mocap_blimp': (MOCAP, list_mocap),
    'rgblimp': (RGBLIMP, list_rgblimp),
    'simulated': (None, list_simulated),
}


def format_mean(rows: Sequence[ForecastRow]) -> str:
    """Return the geometric mean of the ratios."""
    return f'{math.exp(float(np.mean([math.log(row.ratio) for row in rows]))):.2f}'


def format_row(row: ForecastRow) -> str:
    """Return a row as Markdown."""
    errors = ' | '.join(f'{100.0 * one:.1f}' for one in row.errors)
    return f'| {row.title} | {row.horizon:g} | {row.count} | {errors} | {row.ratio:.2f} |'


def run(case: Case, options: Namespace) -> Row:
    """Return the rows of a set of flights."""
    data, studies = SETS[case.kind]
    if data is not None and not data.is_dir():
        return {'rows': [], 'skipped': f'{case.kind} is skipped: {data} is not there.'}
    with tempfile.TemporaryDirectory() as place:
        return {'rows': [row for study in studies(Path(place)) for row in run_study(study)]}


def list_table(rows: Rows, options: Namespace) -> Iterator[str]:
    """Yield the errors of all models, and the means."""
    errors = [ForecastRow(*one) for row in rows.values() for one in row.get('rows', ())]
    yield from list_errors(errors)
    yield from (row['skipped'] for row in rows.values() if 'skipped' in row)


def list_errors(rows: Sequence[ForecastRow]) -> Iterator[str]:
    """Yield the table of errors and the means."""
    yield 'RMS errors of the position [cm]:'
    yield ''
    yield (
        f'| held out | horizon [s] | forecasts | {" | ".join(MODELS)} | calibrated / better peer |'
    )
    yield f'|{"---|" * (len(MODELS) + 4)}'
    yield from map(format_row, rows)
    yield ''
    if rows:
        by_horizon = ', '.join(
            f'{format_mean([row for row in rows if row.horizon == horizon])} at {horizon:g} s'
            for horizon in sorted({row.horizon for row in rows})
        )
        by_set = ', '.join(
            f'{format_mean([row for row in rows if row.title.startswith(name)])} for {name}'
            for name in dict.fromkeys(row.title.partition(',')[0] for row in rows)
        )
        yield (
            f'Calibrated / better peer, geometric mean: {format_mean(rows)} over all; {by_set}; '
            f'{by_horizon}.'
        )


CAMPAIGN: Final = Campaign(
    lambda options: list(SETS), run, list_table, page='forecasts.md', alone=True
)
