"""Simulate, import, check and vary flights in a notebook; they return the data themselves."""

from collections.abc import Iterable, Mapping
from itertools import product
from pathlib import Path
from typing import Any, TYPE_CHECKING

from lta_analysis.console import plain_console
from lta_config.errors import BadInput
from lta_data.bag.recorded_flight import open_flight, RecordedFlight
from lta_flight.progress import FlightProgress
from lta_report.request import build_request, Changes, option, Request
from lta_report.results_folder import resolve_folder
from rich.console import Console

if TYPE_CHECKING:
    from pandas import DataFrame

Name = Path | str  # a shipped name or a file


class NotebookFlight(Request):
    """Numbers and values of a flight that a notebook gives, checked."""

    seed: int = option('Random seed.', default=1, low=0, high=2**31 - 1)
    seeds: int = option('Number of flights of each combination.', default=1, low=0)
    changes: Changes = option('New values by path.', default={})


def simulate(
    vehicle: Name = 'gtmab',
    scenario: Name = 'lamp_room',
    strategy: Name = 'homing',
    seed: int = 1,
    changes: Mapping[str, object] | None = None,
    out: Name | None = None,
    gains: Name = '',
) -> RecordedFlight:
    """
    Fly once in one process, as `lta simulate`, and return the recording.

    `vehicle`, `scenario`, `strategy`, `gains`: names or files. `changes`: replaced parameters by
    path: {'vehicle.trim.heaviness': '4 g'}. `out`: folder of the results, empty or new;
    runs/<time>-<name> by default. Raise `BadInput` if the request is invalid; nothing has been
    flown then.
    """
    from lta_flight.simulate import simulate_once, SimulationRequest

    own = build_request(NotebookFlight, {'seed': seed, 'changes': changes or {}})
    request = SimulationRequest(
        str(vehicle), str(scenario), str(strategy), str(gains), own.seed,
        tuple(f'{path}={value}' for path, value in (changes or {}).items()),
        None if out is None else Path(out),
    )  # fmt: skip
    with FlightProgress(plain_console(stderr=True), 'loading the world') as progress:
        return open_flight(simulate_once(request, progress)[0].bag)


def fly_grid(
    values: Mapping[str, object],
    seeds: int = 1,
    vehicle: Name = 'gtmab',
    scenario: Name = 'lamp_room',
    strategy: Name = 'homing',
) -> list[dict[str, Any]]:
    """
    Fly every combination of some values, one after the other, without recording.

    For many flights use `sweep`, which flies on all cores and resumes.

    Parameters
    ----------
    values : mapping
        Values by path: {'vehicle.trim.heaviness': ['2 g', '4 g']}; one stands for a list of one.
    seeds : int
        Number of flights of each combination.

    Returns
    -------
    list of dict
        One for each flight: the values, `seed`, and the results as `lta simulate --json` has them.

    """
    from lta_flight.flight_spec import build_loop, load_spec
    from lta_flight.report.results import compute_results
    from lta_flight.simulate import simulate_closed_loop

    count = build_request(NotebookFlight, {'seeds': seeds}).seeds
    base = load_spec(str(vehicle), str(scenario), str(strategy), '')
    rows, silent = [], FlightProgress(Console(quiet=True))
    lists = [
        [each] if isinstance(each, str) or not isinstance(each, Iterable) else list(each)
        for each in values.values()
    ]
    for chosen in product(*lists):
        row = dict(zip(values, chosen, strict=True))
        spec = base.with_values(build_request(NotebookFlight, {'changes': row}).changes)
        for seed in range(1, count + 1):
            view, _ = simulate_closed_loop(build_loop(spec, seed), None, silent)
            rows.append({**row, 'seed': seed, **compute_results(view).to_dict()})
    return rows


def import_log(
    source: Name,
    mapping: Name | None = None,
    format: str | None = None,
    out: Name | None = None,
    robot: str = 'lta1',
    vehicle: Name | None = None,
) -> RecordedFlight:
    """
    Convert a log to a bag, as `lta import`, and return the recording.

    Parameters
    ----------
    source : path
        Log file or bag folder.
    mapping : path or str, optional
        Mapping that defines meaning, unit and axes of each column: a file or a shipped name; by
        default the shipped one that fits the columns, if only one does.
    format : str, optional
        File format; detected by default.
    out : path, optional
        New folder of the bag; runs/<time>-<name> by default.
    robot : str
        Namespace of the topics in the bag.
    vehicle : path or str, optional
        Flown vehicle, name or file; stored in the bag.

    Raises
    ------
    BadInput
        If the log cannot be imported; nothing is written then.

    """
    from lta_data.importers.run import import_logs, ImportProgress, ImportRequest

    path = Path(source)
    request = ImportRequest(
        [path], None if mapping is None else str(mapping), format, robot,
        None if vehicle is None else str(vehicle),
    )  # fmt: skip
    folder = resolve_folder(None if out is None else Path(out), path.name.split('.')[0] or 'log')
    with ImportProgress(plain_console(stderr=True), 1) as progress:
        (log,) = import_logs(request, folder, progress)
    return open_flight(log.bag)


def check(*bags: Name, robot: str | None = None) -> 'DataFrame':
    """
    Check the data quality of recordings, as `lta bag check`.

    `bags`: bag folders, results folders or .mcap files; several are also compared in pairs.
    `robot`: robot to check; by default every robot in a bag. Return a row for each finding: bag,
    robot, severity, kind, channel, interval [s] and evidence. Raise `BadInput` for what is no bag.
    """
    from dataclasses import asdict

    from lta_data.data_quality.check_report import check_bags
    import pandas as pd

    if not bags:
        raise BadInput('There is nothing to check; name one recording or more.')
    checked = check_bags([Path(bag) for bag in bags], robot, plain_console(stderr=True))
    rows = [
        {'bag': one.path, 'robot': one.robot, **asdict(finding)}
        for one in checked
        for finding in one.report.findings
    ]
    return pd.DataFrame(rows)
