# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Fly, simulate, import and report flights: the commands, and what a notebook flies besides."""

from collections.abc import Iterable, Mapping
from dataclasses import asdict, replace
from itertools import product
from pathlib import Path
from typing import Any, final, get_args, Literal, TYPE_CHECKING

from lta_analysis.console import print_lines
from lta_bag.bag_folder import find_bag
from lta_bridge.live.origin_gate import LIVE_PORT
from lta_config.atomic_file import stage_results
from lta_config.command_line import format_lta_command, relative_path
from lta_config.errors import BadInput, format_count
from lta_config.files import list_shipped_names
from lta_config.schema.import_file import Format
from lta_config.topics import is_name
from lta_control.strategies import STRATEGIES
from lta_data.bag.recorded_flight import open_flight, RecordedFlight, select_robot
from lta_data.importers.draft.choices import Answers
from lta_flight.flight_run import EXIT_STATUSES, FlightRun, SIMULATED_ROBOT
from lta_flight.progress import FlightProgress
from lta_report.request import (
    Action,
    argument,
    build_request,
    CHANGES,
    Changes,
    Folder,
    option,
    Outcome,
    Request,
    ROBOT,
    VEHICLE,
)
from lta_report.results_folder import format_page_line, resolve_folder
from rich.console import Console

if TYPE_CHECKING:
    from lta_data.importers.run import ImportedLog
    from lta_flight.report.results import FlightResults

DEFAULT_VEHICLE, DEFAULT_SCENARIO = 'gtmab', 'lamp_room'
UNKNOWN_ROOM = 'hall'  # for recordings of no known scene: no wall is near
OUT_OPTION: Any = option(
    'Folder of the results; in runs/ by default.', default=None, metavar='FOLDER', kw_only=True
)
STRATEGY_OPTION: Any = option(
    f'Navigation strategy: {", ".join(STRATEGIES)}, or a file such as ./mine.py.', default='homing'
)
SEED_OPTION: Any = option('Random seed.', default=1, low=0, high=2**31 - 1)
# Fields of a flight that forecasts do not have
ONLY_OF_FLIGHTS = (
    'scenario', 'strategy', 'gains', 'seed', 'changes', 'begin', 'end', 'bag',
)  # fmt: skip


@final
class FlyRequest(Action, command='fly', json=True):
    """
    Fly with the full ROS graph, record to MCAP and write a report page.

    In lockstep the same seed gives the same flight, every value of it.

    With --live, Foxglove can watch without ROS; a slow viewer never blocks the flight.

    Exit status 0: the drone reached its goal, with homing for 3 s. 1: a node died or stalled. 2:
    bad input, nothing was started. 3: out of time. 4: the drone left the room. 130: Ctrl-C (143:
    SIGTERM, 129: SIGHUP).

    Example: lta fly --seed 3 --time realtime
    """

    vehicle: str = VEHICLE
    scenario: str = option('Scenario name or file.', default=DEFAULT_SCENARIO, complete='scenario')
    strategy: str = STRATEGY_OPTION
    seed: int = SEED_OPTION
    time: Literal['lockstep', 'realtime'] | None = option(
        'Speed of the simulation. lockstep: as fast as the nodes respond. realtime: wall-clock '
        'speed.',
        default=None, default_text='lockstep; realtime with --live',
    )  # fmt: skip
    processes: Literal['many', 'one'] = option(
        'Whether every node has a process of its own, or all share one, which needs less '
        'processor time.',
        default='many',
    )
    out: Folder | None = OUT_OPTION
    live: bool = option('Stream the flight live to Foxglove.', default=False)
    live_port: int = option(
        'Port for Foxglove, with --live.', default=LIVE_PORT, low=1, high=65535
    )
    page: bool = option('Write an HTML report.', default=True)

    def run(self, console: Console) -> Outcome[FlightRun]:
        """Fly, write the page, and return the run."""
        from lta_data.scene import describe_exceeded_region_of_bag
        from lta_flight.flight import fly_once

        # A live view in lockstep would run too fast to watch
        pace = self.time or ('realtime' if self.live else 'lockstep')
        with FlightProgress(console) as progress:
            flight = fly_once(
                self.vehicle, self.scenario, self.strategy, self.seed, progress, time=pace,
                processes=self.processes, live_port=self.live_port if self.live else None,
                out=self.out,
            )  # fmt: skip
        page = flight.folder / 'report.html' if self.page else None
        results = report_run(flight, page)
        if results is not None:
            warning = describe_exceeded_region_of_bag(open_flight(flight.bag))
            flight = replace(flight, warning=warning)
        print_lines(console, format_outcome(flight, results))
        if results is not None:
            print_files(flight.bag, page, console)
        # The report is written first, whatever the outcome
        return Outcome(flight, encode_flight(flight, results, page), EXIT_STATUSES[flight.outcome])


def report_run(flight: FlightRun, page: Path | None) -> 'FlightResults | None':
    """Write the page and return the results; None if a failed flight left no recording."""
    from lta_flight.report.page import write_page
    from lta_flight.report.results import compute_results
    from lta_flight.report.view import FlightView

    try:
        if page is not None:
            return write_page(flight.bag, page)
        return compute_results(FlightView(open_flight(flight.bag)))
    except BadInput:
        # A node that died at the start may have left an empty bag
        if flight.outcome == 'failed':
            return None
        raise


@final
class SimulateRequest(Action, command='simulate', json=True):
    """
    Fly in one process: the same algorithms in the same order as the graph, without DDS.

    The bag has the values of that of "lta fly" with the same seed, except for /clock and
    /diagnostics, which depend on the wall clock and are left out.

    --set overrides a file's parameter by its path: vehicle.trim.heaviness=4 g,
    scenario.air.wind=[0.2, 0, 0] m/s, scenario.air.wind.0=0.2 m/s (one element, counted from 0),
    gains.heading_kp=0.5; or a node's: mission.altitude=0.8. Roots are vehicle, scenario, gains,
    mission, reserve (action at low charge), estimator, demodulator, prior (lamp position) and
    energy_monitor. Changed files are saved next to the bag. The drone's own model uses the
    overridden values, too.

    --commands flies the recorded duties, or forces and moments, of a flight through a vehicle
    file: the difference is what that file lacks. It grows with time, as nothing corrects it;
    --begin and --end choose a part. The bag has the clock of the recording, for
    "lta compare --align none".

    --commands with --forecasts judges a vehicle file: a forecast begins every 1.5 s from past
    readings only, and its errors 1, 3 and 8 s ahead stand beside those of coasting (constant
    body velocity and rates). It needs measured poses. It writes a page and forecasts.json, with a
    row for each forecast. "lta calibrate" judges in the same way.

    Exit status 0: the drone reached its goal, with homing for 3 s, or flew all --commands, or
    --forecasts are done. 2: bad input, nothing was flown. 3: out of time. 4: the drone left the
    room.

    Example: lta simulate --seed 3 --set 'vehicle.trim.heaviness=4 g'

    Example: lta simulate --commands runs/flight --vehicle my_blimp.yaml --begin 20 --end 30

    Example: lta simulate --commands A B --vehicle my_blimp.yaml --forecasts
    """

    vehicle: str | None = option(
        f'Vehicle name or file; {DEFAULT_VEHICLE}, or the recorded one, by default.', default=None,
        complete='vehicle',
    )  # fmt: skip
    scenario: str | None = option(
        f'Scenario name or file; {DEFAULT_SCENARIO}, or the recorded one, by default.',
        default=None, complete='scenario',
    )  # fmt: skip
    strategy: str = STRATEGY_OPTION
    gains: str = option("Controller gains, name or file; the vehicle's by default.", default='')
    seed: int = SEED_OPTION
    changes: Changes = CHANGES
    commands: tuple[Path, ...] = option(
        'Fly the commands of this recording (bag or results folder) from its motion on, instead '
        'of a controller. Several with --forecasts.',
        default=(), metavar='BAG...',
    )  # fmt: skip
    forecasts: bool = option(
        'With --commands: judge the vehicle by forecasts of the recordings instead.',
        default=False,
    )
    begin: float = option('With --commands: begin so many seconds into it.', default=0.0, low=0.0)
    end: float | None = option(
        'With --commands: end so many seconds into it.', default=None, low=0.0
    )
    robot: str | None = option(
        'With --commands: robot whose commands are flown; needed if the recording has several.',
        default=None,
    )
    out: Folder | None = OUT_OPTION
    bag: bool = option('Record a bag and write an HTML report.', default=True)

    def run(self, console: Console) -> Outcome[Any]:
        """Fly, write the page, and return the recording, or the run without a bag."""
        from lta_flight.flight_spec import load_spec
        from lta_flight.report.page import write_page
        from lta_flight.simulate import CommandRequest, simulate_once

        if self.forecasts:
            return self.forecast(console)
        if len(self.commands) > 1:
            raise BadInput(
                'One recording is flown at a time; give one with --commands, or add --forecasts.'
            )
        recording = self.commands[0] if self.commands else None
        part = {'begin', 'end', 'robot'} & self.model_fields_set
        if recording is None and part:
            raise BadInput(
                '--begin, --end and --robot choose from a recording; add --commands BAG.'
            )
        vehicle, scenario = self.name_scene(recording)
        spec = load_spec(vehicle, scenario, self.strategy, self.gains).with_values(self.changes)
        commands = (
            CommandRequest(recording, self.robot, self.begin, self.end) if recording else None
        )
        with FlightProgress(console, 'loading the world') as progress:
            flight, results = simulate_once(
                spec, self.seed, self.out, progress, record=self.bag, commands=commands
            )
        page = flight.folder / 'report.html' if self.bag else None
        if page is not None:
            # Results of the recorded bag, the same as `lta report` shows
            results = write_page(flight.bag, page)
        print_lines(
            console, format_outcome(flight, results),
            f'Simulation speed: {flight.pace:.1f} x real time.',
        )  # fmt: skip
        data = encode_flight(flight, results, page)
        status = EXIT_STATUSES[flight.outcome]
        if not self.bag:
            del data['bag']
            return Outcome(flight, data, status)
        print_files(flight.bag, page, console)
        if recording is not None:
            robot = () if self.robot is None else ('--robot', f'{self.robot}:{SIMULATED_ROBOT}')
            line = format_lta_command(
                'compare', recording, relative_path(flight.bag), '--align', 'none', *robot
            )
            print_lines(console, f'Compare them: {line}')
        return Outcome(open_flight(flight.bag), data, status)

    def name_scene(self, recording: Path | None) -> tuple[str, str]:
        """Return vehicle and scenario: those asked for, else recorded ones, else the usual."""
        from lta_flight.recorded_choices import find_recorded_name

        recorded = {} if recording is None else open_flight(
            find_bag(recording), self.robot
        ).provenance  # fmt: skip
        room = DEFAULT_SCENARIO if recording is None else UNKNOWN_ROOM
        return (
            self.vehicle or find_recorded_name(recorded, 'vehicle') or DEFAULT_VEHICLE,
            self.scenario or find_recorded_name(recorded, 'scenario') or room,
        )

    def forecast(self, console: Console) -> Outcome[Any]:
        """Judge the vehicle by forecasts, and return the result of the study."""
        # A flight does not wait for these imports, which take as long as all others
        from lta_analysis.door import perform
        from lta_discovery.forecast_study import ForecastRequest

        useless = [each for each in ONLY_OF_FLIGHTS if each in self.model_fields_set]
        if useless:
            raise BadInput(
                f'{" and ".join(map(self.name_option, useless))} cannot be used with --forecasts, '
                'which flies nothing new; leave it out.'
            )
        values = {
            'vehicle': self.vehicle, 'flights': self.commands, 'robot': self.robot,
            'out': self.out,
        }  # fmt: skip
        used = {name: value for name, value in values.items() if value}
        result = perform(build_request(ForecastRequest, used), console)
        result.print(console)
        return Outcome(result, result.to_json(), result.report.status)


def encode_flight(
    flight: FlightRun, results: 'FlightResults | None', page: Path | None
) -> dict[str, object]:
    """Return the content of --json."""
    # Without results there is no page
    warned = {'warning': flight.warning} if flight.warning else {}
    pages = {} if page is None or results is None else {'page': str(page)}
    return {
        'outcome': flight.outcome,
        'pace': flight.pace,
        'bag': str(flight.bag),
        **({} if results is None else results.to_dict()),
        **pages,
        **warned,
        'units': {'pace': '1', **({} if results is None else results.list_units())},
    }


def format_outcome(flight: FlightRun, results: 'FlightResults | None') -> str:
    """Return the outcome in one sentence, and the warning of the flight, if any."""
    from lta_flight.report.page import describe_outcome

    # The bag has no goal to judge by, so the simulator's verdict counts
    on_course = flight.outcome == 'reached' and results is not None and results.success is None
    if results is None or flight.outcome in {'failed', 'flown'} or on_course:
        text = f'The drone {flight.sentence}.'
    elif flight.outcome == 'reached':
        text = f'{describe_outcome(results)}.'
    else:
        text = f'{describe_outcome(results)}; it {flight.sentence}.'
    return f'{text} {flight.warning}' if flight.warning else text


def print_files(bag: Path, page: Path | None, console: Console) -> None:
    """Print the paths of the results and how to open them."""
    info = format_lta_command('bag', 'info', relative_path(bag))
    print_lines(console, f'Bag  {bag}  (open it in Foxglove, or run: {info})')
    if page is not None:
        print_lines(console, format_page_line(page))


@final
class FlightPageRequest(Action, command='report'):
    """
    Write the page of a recorded flight, and with --pictures and --video its figures and a film.

    Example: lta report runs/20261120-lamp_room-1/bag --pictures thesis/figures

    Example: lta report runs/20261120-lamp_room-1/bag --video flight.mp4

    Example: lta report fleet/bag --robot lta2
    """

    bag: Path = argument('Bag folder, results folder or .mcap file.')
    out: Folder | None = option(
        'Folder of report.html or report-ROBOT.html; that of the bag by default.', default=None,
        metavar='FOLDER',
    )  # fmt: skip
    robot: str | None = ROBOT
    pictures: Path | None = option(
        'Write each figure as PNG to this folder; needs Chromium.', default=None, metavar='FOLDER'
    )
    video: Path | None = option(
        'Film the 3-D view: MP4 or GIF file to write; needs Chromium and ffmpeg.', default=None,
        metavar='FILE',
    )  # fmt: skip

    def run(self, console: Console) -> Outcome[Path]:
        """Write page, figures and film, and return the path of the page."""
        from lta_analysis.door import check_picture_output
        from lta_bag.reader import read_bag
        from lta_flight.report.page import write_page
        from lta_report.browser import find_chromium
        from lta_report.screenshots import check_video_output, write_pictures, write_video

        bag = find_bag(self.bag)
        stored = read_bag(bag)
        select_robot(stored, self.robot)  # raises BadInput before any folder is created
        if next(stored.iterate_messages(), None) is None:
            raise BadInput(f"'{bag}' contains no message to report on; choose another bag.")
        # Several robots of a bag must not overwrite each other's page
        name = 'report.html' if self.robot is None else f'report-{self.robot}.html'
        folder = (self.out or bag.absolute().parent).absolute()
        check_picture_output(self.pictures)
        if self.video is not None:
            find_chromium()
            check_video_output(self.video)
        with stage_results(folder, name) as part:
            write_page(bag, part / name, self.robot)
        page = folder / name
        print_lines(console, f'Page {page}')
        if self.pictures is not None:
            print_lines(
                console, *(f'Picture {each}' for each in write_pictures(page, self.pictures))
            )
        if self.video is not None:
            write_video(page, self.video)
            print_lines(console, f'Video {self.video}')
        return Outcome(page)


@final
class LogImportRequest(Action, command='import', json=True):
    """
    Convert logs to bags: CSV, MATLAB, NumPy, Parquet, ROS 1 and 2, PX4, ArduPilot, Crazyflie.

    Only units and axes are converted: nothing is smoothed, resampled or filled in. Anomalies (time
    that stops or runs backwards, cells without a number) are kept and reported. The bag stores the
    name and SHA-256 of its source, the whole mapping, and whether the data are measured or
    simulated.

    A mapping defines the meaning, unit and axes of each column: docs/import.md. One source becomes
    FOLDER/bag, several become FOLDER/NAME/bag; if one cannot be imported, none is.

    With --draft, columns, units, axes and rates are proposed from names and physics, with reasons
    and a picture, and written to FOLDER/mapping.yaml. Where two readings fit, the command asks;
    without a terminal it prints both with the --set that decides, and ends with status 2.

    Example: lta import --draft flight.csv --out runs/lab

    Example: lta import data_1.csv --vehicle rgblimp

    Example: lta import flight.bag --mapping my_tracker.yaml --out runs/lab/flight

    Example: lta import log00 log01 --json
    """

    sources: tuple[Path, ...] = argument(
        'Log files or bag folders to import.', metavar='SOURCE...'
    )
    mapping: str | None = option(
        'Mapping that defines meaning, unit and axes of each column: a file, or one of '
        f'{", ".join(list_shipped_names("imports"))}. By default, the shipped mapping that fits '
        'the columns, if only one does.',
        default=None,
    )
    format: str | None = option(
        f'File format: {", ".join(get_args(Format))}; detected by default.', default=None
    )
    out: Folder | None = OUT_OPTION
    robot: str = option('Namespace of the topics in the new bag.', default='lta1')
    vehicle: str | None = option(
        'Flown vehicle, name or file; stored in the bag. A draft names commands after its rotors.',
        default=None,
    )
    draft: bool = option(
        'Propose a mapping from the columns of a log, instead of importing it.', default=False
    )
    answers: Answers = option(
        'Decide a question of --draft, such as time.rate=60. Repeatable.', default={}, name='set',
        metavar='KEY=VALUE',
    )  # fmt: skip

    def run(self, console: Console) -> Outcome[Any]:
        """Write the bags, and return the recording, or a list of several."""
        from lta_data.importers.run import import_logs, ImportRequest
        from lta_report.progress_bar import ProgressBar

        if self.draft:
            from lta_analysis.import_draft import run_draft

            return run_draft(self.sources, self.answers, self.vehicle, self.out, console)
        if self.answers:
            raise BadInput('--set decides a question of --draft; add --draft, or remove --set.')
        # The robot becomes a ROS namespace
        if not is_name(self.robot):
            raise BadInput(
                f"--robot '{self.robot}' is not a valid ROS namespace; use a letter, followed by "
                'letters, digits or _.'
            )
        # A name such as '.csv' has an empty stem
        target = resolve_folder(self.out, self.sources[0].name.split('.')[0] or 'log')
        request = ImportRequest(self.sources, self.mapping, self.format, self.robot, self.vehicle)
        with ProgressBar(console, total=len(self.sources)) as bar:
            done = import_logs(
                request,
                target,
                lambda name, done: bar.update_bar(description=name, completed=done),
            )
        for one in done:
            print_import(one, console)
        # One entry per source, also for a single source
        flights: list[RecordedFlight] = [open_flight(Path(one.bag)) for one in done]
        return Outcome(flights if len(flights) > 1 else flights[0], list(map(asdict, done)))


def print_import(one: 'ImportedLog', console: Console) -> None:
    """Print a summary of one imported log."""
    form = f'{one.format}, mapping {one.mapping}' if one.mapping else one.format
    place = relative_path(Path(one.bag))
    print_lines(
        console, f'{one.source} ({"; ".join(filter(None, (form, one.data)))})', style='bold'
    )
    topics = one.topics.items()
    print_lines(console, *(f'  {name}: {format_count(n, "message")}' for name, n in topics))
    print_lines(console, *(f'  {note}' for note in one.notes), style='yellow')
    print_lines(console, f'Bag {place}')
    for purpose, verb in (('See it', 'info'), ('Check units, axes and clocks', 'check')):
        print_lines(console, f'{purpose}: {format_lta_command("bag", verb, place)}', style='dim')


class GridRequest(Request):
    """Numbers and values of the flights of a grid, checked."""

    seeds: int = option('Number of flights of each combination.', default=1, low=0)
    changes: Changes = option('New values by path.', default={})


def fly_grid(
    values: Mapping[str, object],
    seeds: int = 1,
    vehicle: Path | str = DEFAULT_VEHICLE,
    scenario: Path | str = DEFAULT_SCENARIO,
    strategy: Path | str = 'homing',
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

    if not isinstance(values, Mapping):
        raise BadInput(f'values is {values!r}, but must be lists of values by path.')
    count = build_request(GridRequest, {'seeds': seeds}).seeds
    base = load_spec(str(vehicle), str(scenario), str(strategy), '')
    rows, silent = [], FlightProgress(Console(quiet=True))
    lists = [
        [each] if isinstance(each, str) or not isinstance(each, Iterable) else list(each)
        for each in values.values()
    ]
    for chosen in product(*lists):
        row = dict(zip(values, chosen, strict=True))
        spec = base.with_values(build_request(GridRequest, {'changes': row}).changes)
        for seed in range(1, count + 1):
            view, _ = simulate_closed_loop(build_loop(spec, seed), None, silent)
            rows.append({**row, 'seed': seed, **compute_results(view).to_dict()})
    return rows
