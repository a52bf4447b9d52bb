"""Simulate, vary and discover in a notebook: the commands of `lta` as functions."""

from collections.abc import Mapping, Sequence
from itertools import product
import operator
from pathlib import Path
from typing import Any

from lta_config.errors import BadInput
from lta_config.parameter_override import parse_assignment
from lta_data.bag.recorded_flight import open_flight, RecordedFlight
from lta_discovery.discovery.run import discover_effects, DiscoveryRequest
from lta_discovery.forecast_study import build_report, study_forecasts
from lta_flight.flight_run import SilentObserver
from lta_flight.flight_spec import build_loop, load_spec
from lta_flight.report.results import compute_results
from lta_flight.simulate import simulate_closed_loop, simulate_once, SimulationRequest
from lta_report.report_output import PAGE, write_report
from lta_report.results_folder import stage_results


def simulate(
    vehicle: Path | str = 'gtmab',
    scenario: Path | str = 'lamp_room',
    strategy: Path | str = 'homing',
    seed: int = 1,
    changes: Mapping[str, object] | None = None,
    out: Path | str | None = None,
) -> RecordedFlight:
    """
    Fly once in one process, as `lta simulate`, and return the recording.

    `vehicle`, `scenario`, `strategy`: names or files. `changes`: replaced parameters by path:
    {'vehicle.trim.heaviness': '4 g'}. `out`: folder of the results, empty or new;
    runs/<time>-<name> by default. Raise `BadInput` if the request is invalid; nothing has been
    flown then.
    """
    words = tuple(f'{path}={value}' for path, value in (changes or {}).items())
    folder = None if out is None else Path(out)
    number = read_count('seed', seed)
    request = SimulationRequest(
        str(vehicle), str(scenario), str(strategy), '', number, words, folder
    )
    return open_flight(simulate_once(request, SilentObserver())[0].bag)


def read_count(name: str, value: Any) -> int:  # noqa: ANN401 - what a notebook gives
    """Return a whole number of 0 or more, also of numpy; raise `BadInput` for others."""
    try:
        number = operator.index(value)
    except TypeError:
        number = -1
    if number < 0:
        raise BadInput(f'{name} is {value!r}, but must be a whole number, 0 or more.')
    return number


def sweep(
    values: Mapping[str, Sequence[object]],
    seeds: int = 1,
    vehicle: Path | str = 'gtmab',
    scenario: Path | str = 'lamp_room',
    strategy: Path | str = 'homing',
) -> list[dict[str, Any]]:
    """
    Fly every combination of some values, one after the other, without recording.

    For many flights use `lta sweep`, which flies on all cores and resumes.

    Parameters
    ----------
    values : mapping
        Values by path: {'vehicle.trim.heaviness': ['2 g', '4 g']}.
    seeds : int
        Number of flights of each combination.

    Returns
    -------
    list of dict
        One for each flight: the values, `seed`, and the results as `lta simulate --json` has them.

    """
    base = load_spec(str(vehicle), str(scenario), str(strategy), '')
    count = read_count('seeds', seeds)
    rows = []
    for chosen in product(*values.values()):
        row = dict(zip(values, chosen, strict=True))
        spec = base.with_values(
            dict(parse_assignment(f'{path}={value}') for path, value in row.items())
        )
        for seed in range(1, count + 1):
            view, _ = simulate_closed_loop(build_loop(spec, seed), None, SilentObserver())
            rows.append({**row, 'seed': seed, **compute_results(view).to_dict()})
    return rows


def discover(
    vehicle: Path | str,
    train: Sequence[Path | str],
    confirm: Sequence[Path | str] = (),
    holdout: Sequence[Path | str] = (),
    out: Path | str = 'runs/discover',
) -> dict[str, Any]:
    """
    Find what a vehicle file lacks, as `lta discover`.

    Returns
    -------
    dict
        The content of discovery.json; the folder `out` also has the page and the corrected file.

    """
    bags = {
        role: [Path(bag) for bag in paths]
        for role, paths in (('train', train), ('confirm', confirm), ('holdout', holdout))
    }
    request = DiscoveryRequest(str(vehicle), bags)  # type: ignore[arg-type]
    report = discover_effects(request, lambda _words, _share: None)
    with stage_results(Path(out), PAGE) as folder:
        write_report(report, folder)
    return dict(report.data)


def forecast(
    vehicle: Path | str, flights: Sequence[Path | str], robot: str | None = None
) -> dict[str, Any]:
    """
    Judge a vehicle file by forecasts of recorded flights, as `lta simulate --forecasts`.

    Returns
    -------
    dict
        The content of forecasts.json: `pandas.DataFrame(result['rows'])` is a table.

    """
    result = build_report(study_forecasts(str(vehicle), [Path(bag) for bag in flights], robot))
    return dict(result.data)
