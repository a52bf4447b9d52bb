# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Score calibrations that are hidden in flights of the independent simulator.

Gains of 0.2 to 3 of either sign, markers up to 20 degrees and 15 cm off, a net lift
of up to 25 mN in each flight, and commands up to 0.4 s late; two of three vehicles are commanded
by a wrench, the third by duties. `lta calibrate` sees two training flights and a confirming one.
Its intervals are compared with the truth, and its forecasts of the confirming flight with those of
the oracle, the vehicle file with all true values.
"""

from argparse import ArgumentParser, Namespace
from collections.abc import Iterator, Sequence
import math
from pathlib import Path
import tempfile
import time
from typing import Final

from lta_config.files import find_file
from lta_discovery.calibration.calibrated_file import format_calibrated_vehicle
from lta_discovery.calibration.calibration import calibrate_flights
from lta_discovery.calibration.result import Calibration
from lta_discovery.discovery.forecast_comparison import (
    compare_forecasts,
    ComparedModel,
)
from lta_discovery.flights.bags import read_bags, Role
from lta_discovery.flights.usable_flights import select_usable_flights, UsableFlights
from lta_discovery.model.calibration_parameters import list_calibration_parameters
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import apply_parameters, NET_LIFT_FORCE
from lta_discovery.state_filter.forecast_noise import HORIZONS
from lta_discovery.state_filter.forecast_scores import (
    CALIBRATED,
    COASTING,
    FILE_MODEL,
    find_main_score,
    HorizonErrors,
)
from lta_model.effects.protocol import AXES
from lta_model.vehicle import load_vehicle, Vehicle
import numpy as np

from campaigns.challenge.calibration_case import (
    CalibrationCase,
    draw_calibration,
    generate_calibration_case,
    misstate_thrusts,
    SECONDS,
)
from campaigns.challenge.recording import write_bag
from campaigns.harness import Campaign, Case, Row, Rows

ROLES: Final = ('train', 'train', 'confirm')


def is_driven(number: int) -> bool:
    """Return whether the vehicle of a case is commanded by duties."""
    return number % 3 == 2


def record_case(
    seed: int, number: int, folder: Path, seconds: tuple[float, float] = SECONDS
) -> tuple[CalibrationCase, Path, dict[Role, list[Path]]]:
    """Generate a case of flights of some length [s]; write its bags and its vehicle file."""
    vehicle, rotors = load_vehicle('gtmab'), is_driven(number)
    case = generate_calibration_case(vehicle, seed, number, ROLES, seconds, rotors)
    text = find_file('vehicle', 'gtmab').read_text(encoding='utf-8')
    if rotors:
        text = misstate_thrusts(text, vehicle, draw_calibration(vehicle, seed, number, rotors))
    path = folder / 'vehicle.yaml'
    path.write_text(text, encoding='utf-8')
    bags: dict[Role, list[Path]] = {'train': [], 'confirm': []}
    for flight in case.flights:
        write_bag(folder / flight.name, flight.streams, vehicle.rotor_names, {})
        bags['train' if flight.role == 'train' else 'confirm'].append(folder / flight.name)
    return case, path, bags


def list_intervals(case: CalibrationCase, found: Calibration) -> list[Row]:
    """Return all values with a known truth: truth, estimate and interval."""
    truths = case.list_true_values(load_vehicle('gtmab'))
    rows = []
    for one in found.values:
        truth = truths.get(one.name) if not one.flight else None
        if one.flight and one.name == 'net_lift.force':
            truth = case.lifts[one.flight]
        elif one.flight and one.name == 'helium_leak.rate':
            truth = -case.trends[one.flight]
        if truth is not None:
            row = {'name': one.name, 'truth': truth, 'value': one.value, 'ci95': one.ci95}
            rows.append({**row, 'known': one.is_known, 'far': one.is_far})
    return rows


def list_commanded_axes(case: CalibrationCase) -> list[bool]:
    """Return the axes on which a wrench is commanded."""
    axes = () if case.shares else (0, 1, 2, 5) if case.is_steered else (0, 2, 5)
    return [axis in axes for axis in range(6)]


def find_oracle(case: CalibrationCase, vehicle: Vehicle) -> NominalVehicle:
    """Return the vehicle file with all true values."""
    nominal = NominalVehicle.from_vehicle(vehicle)
    knobs = list_calibration_parameters(nominal, list_commanded_axes(case), True)
    values = np.zeros(len(knobs))
    truths = case.list_true_values(load_vehicle('gtmab'))
    for k, knob in enumerate(knobs):
        if knob.name not in truths:
            continue
        (effect, parameter), truth = next(iter(knob.moves)), truths[knob.name]
        if effect == 'vehicle':
            values[k] = math.log(truth)
        elif knob.name.endswith('.thrust'):
            values[k] = truth - 1.0
        else:
            values[k] = truth - nominal.parameter_value(effect, parameter)
    oracle = apply_parameters(nominal, knobs, values)[0]
    if case.shares:
        for k, column in enumerate(case.truth.columns, start=1):
            for axis, number in zip(AXES, column, strict=True):
                # Negative where the file has the axis of the rotor the other way round
                number *= math.copysign(1.0, case.shares[k - 1])
                oracle = oracle.with_value('rotor_thrust', f'{axis}_{k}', number)
    return oracle


def score_oracle(
    case: CalibrationCase, vehicle: Vehicle, usable: UsableFlights, found: Calibration
) -> float:
    """Return the oracle's position error 3 s ahead in the confirming flight [m]."""
    taught = [case.lifts[one.name] for one in case.flights if one.role == 'train']
    oracle = find_oracle(case, vehicle).with_value(
        *NET_LIFT_FORCE.split('.'), float(np.mean(taught))
    )
    training = [flight for _, role, flight in usable.flights if role == 'train']
    confirming = {name: flight for name, role, flight in usable.flights if role == 'confirm'}
    model = ComparedModel('oracle', oracle, list(found.noise.values()))
    parameters = list_calibration_parameters(oracle, list_commanded_axes(case), True)
    main = compare_forecasts(vehicle, training, confirming, [model], parameters, HORIZONS).main
    assert main is not None
    return main.errors[model.name].position


def encode_score(score: HorizonErrors) -> Row:
    """Return position and attitude errors by coasting, the file and the calibration."""
    kinds = {'coast': COASTING, 'before': FILE_MODEL, 'after': CALIBRATED}
    return {kind: list(score.errors[name]) for kind, name in kinds.items()}


def run_case(seed: int, number: int, seconds: tuple[float, float]) -> Row:
    began = time.process_time()
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        case, path, bags = record_case(seed, number, folder, seconds)
        vehicle = load_vehicle(str(path))
        usable = select_usable_flights(read_bags(bags), vehicle)
        found = calibrate_flights(vehicle, str(path), usable.flights, lambda _what, _part: None)
        row: Row = {'method': found.method, 'values': list_intervals(case, found)}
        if main := find_main_score(found.scores.get('confirm', ())):
            row['scores'] = encode_score(main)
            row['oracle'] = score_oracle(case, vehicle, usable, found)
        try:
            text = format_calibrated_vehicle(path.read_text(), vehicle, found, 'a trial')
            (folder / 'calibrated.yaml').write_text(text)
            load_vehicle(str(folder / 'calibrated.yaml'))
            row['file'] = True
        except Exception as fault:  # whatever a user would meet
            row['file'] = str(fault)
    return {**row, 'cpu_s': time.process_time() - began}


def is_inside(value: Row) -> bool:
    """Return whether an interval contains the truth."""
    return bool(value['ci95'][0] <= value['truth'] <= value['ci95'][1])


def list_calibration_table(rows: Sequence[Row]) -> Iterator[str]:
    """Yield the lines of the table of some cases."""
    yield f'by likelihood {sum(row["method"] == "likelihood" for row in rows)}'
    yield f'vehicle file written {sum(row["file"] is True for row in rows)}'
    values = [one for row in rows for one in row['values']]
    for words, some in (
        ('all values', values),
        ('learned from the flights', [one for one in values if one['known']]),
        ('not learned', [one for one in values if not one['known']]),
    ):
        inside = sum(map(is_inside, some))
        share = 100.0 * inside / len(some) if some else math.nan
        yield f'truth inside the 95 % interval, {words}: {inside} of {len(some)} ({share:.1f} %)'
    groups: dict[str, list[Row]] = {}
    for one in values:
        groups.setdefault(one['name'].partition('.')[0].partition('_1')[0], []).append(one)
    for name, some in sorted(groups.items()):
        yield f'  {name}: {sum(map(is_inside, some))} of {len(some)}'
    scored = [row for row in rows if 'oracle' in row]
    ratios = [row['scores']['after'][0] / row['oracle'] for row in scored]
    if ratios:
        good = sum(one <= 1.1 for one in ratios)
        yield (
            f'position error at 3 s by the oracle: median {np.median(ratios):.3f}, 90 % below '
            f'{np.quantile(ratios, 0.9):.3f}, at most 1.1 in {good} of {len(ratios)}'
        )
        for key, words in (('after', 'calibrated'), ('before', 'file'), ('coast', 'coasting')):
            errors = [100.0 * row['scores'][key][0] for row in scored]
            yield f'position error at 3 s, {words}: median {np.median(errors):.2f} cm'
        better = sum(row['scores']['after'][0] < row['scores']['coast'][0] for row in scored)
        yield f'better than coasting: {better} of {len(scored)}'


def run(case: Case, options: Namespace) -> Row:
    """Return the row of a case."""
    row = run_case(options.seed, case.number, tuple(options.seconds))
    return {**row, 'driven': is_driven(case.number)}


def list_table(rows: Rows, options: Namespace) -> Iterator[str]:
    """Yield the tables by kind of command."""
    for command in ('wrench', 'rotors'):
        driven = command == 'rotors'
        some = [row for case, row in rows.items() if is_driven(case.number) is driven]
        if some:
            yield f'**{command}**: {len(some)} cases, seed {options.seed}'
            yield ''
            whole = [row for row in some if 'driven' in row]
            yield from (f'- {line}' for line in list_calibration_table(whole))


def add_arguments(parser: ArgumentParser) -> None:
    """Add the lengths of the flights."""
    parser.add_argument('--seconds', nargs=2, type=float, default=SECONDS, help='least and most')


CAMPAIGN: Final = Campaign(
    lambda options: ['calibration'], run, list_table, each=20, add_arguments=add_arguments,
    alone=True, smoke='--each 1 --seconds 13 14',
)  # fmt: skip
