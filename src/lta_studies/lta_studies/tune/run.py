# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Run a tuning: search, comparison, stability margins, helium limits and gains file."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import final

from lta_config.command_line import relative_path
from lta_config.errors import BadInput, format_count
from lta_config.files import find_file as find_file
from lta_config.schema.vehicle_file import load_vehicle_file
from lta_control.laws import load_gains
from lta_control.laws.cascade import CascadeGains
from lta_report.report import Report
from lta_report.request import argument, Mass, option, StudyRequest, StudyRun
from lta_report.study import hash_inputs, StudyProgress
from lta_report.study_store import StudyStore
from lta_report.workers import ItemFailure, Workers
from lta_studies.tune import step_response
from lta_studies.tune.cma_search import (
    GainSearchResult,
    replace_parameters,
    round_gain,
    search_gains,
    select_parameters,
    TunableParameter,
    write_gains,
)
from lta_studies.tune.compare import (
    draw_cases,
    evaluate_gains,
    evaluate_jobs,
    EvaluationJob,
    fly_comparison,
    GainEvaluation,
    ResponseMetrics,
    SEARCH_STORE,
)
from lta_studies.tune.helium_limit import (
    find_tolerable_helium_loss,
    HeliumLimit,
    rotor_lift_loss_limit,
)
from lta_studies.tune.margins import compute_loop_margins, LoopMargins, TUNING_CRUISE_SPEED
from lta_studies.tune.step_response import TuningCase, TuningScene
from rich.console import Console

TUNABLE_LAW = 'cascade'  # the only control law that can be tuned
GAINS_NAME = 'gains.yaml'


@final
class TuningRequest(StudyRequest, command='tune', quick={'cases': 2, 'budget': 20, 'draws': 4}):
    """
    Tune controller gains that stay stable over a range of helium losses.

    For each loss, a candidate flies a step-response test (take-off, then steps of altitude,
    heading and forward speed, and a turn at speed) and one mission to the lamp, with sensor noise.
    The controller does not know the loss. The cost combines settling time, overshoot, steady-state
    error, oscillation (measured, or predicted by the linearised loop), rotor effort and mission
    time; half its mean and half its maximum over the losses count. CMA-ES searches the logarithms
    of the gains, within a factor of 6 and their declared bounds. Limits stay fixed unless --number
    names them.

    Old and new gains are then compared on new random cases that the search did not use. Stability
    margins of altitude, heading and speed come from the linearised loop, in hover and at 0.4 m/s.
    Flights determine the helium loss at which the gains fail.

    The results folder, by default runs/tune-<name>-<hash>, gets the new gains as gains.yaml. Every
    candidate is stored there, and repeating the command resumes. Ctrl-C stops at once and writes
    the best gains so far. The vehicle's own gains are not replaced: copy the new file if it is
    better.

    Exit status 0: done. 2: bad input, nothing was flown. 130: Ctrl-C.

    Example: lta tune gtmab --most '6 g' --budget 121 --out runs/tuned
    """

    vehicle: str = argument('Vehicle name or file.', default='gtmab', complete='vehicle')
    gains: str | None = option(
        "Initial gains, name or file; the vehicle's by default.", default=None
    )
    least: Mass = option(
        'Smallest loss of lift that the gains must handle, in g or kg.', default='0 g',
        metavar='MASS',
    )  # fmt: skip
    most: Mass = option(
        'Largest loss of lift that the gains must handle, in g or kg.', default='6 g',
        metavar='MASS',
    )  # fmt: skip
    cases: int = option(
        'Number of lift losses, evenly spaced from --least to --most; each candidate set of gains '
        'is flown once with each loss.',
        default=4, low=1,
    )  # fmt: skip
    budget: int = option('Number of candidate sets of gains to fly.', default=121, low=1)
    draws: int = option(
        'Number of flights with random losses of lift on which old and new gains are compared.',
        default=20, low=2,
    )  # fmt: skip
    numbers: tuple[str, ...] = option(
        'Gain to tune, such as climb.kp; repeat to tune several. By default, all gains above 0.',
        default=(), name='number', metavar='PATH',
    )  # fmt: skip
    seed: int = option('Random seed.', default=1, low=0, high=2**31 - 1)

    def run(self, run: StudyRun) -> Report:
        """Return the report of old and new gains."""
        from lta_studies.tune.report import build_report

        done = tune_once(self, run.console)
        run.open_folder(done.folder)
        if not self.page:
            return build_report(done, None)
        # Fly old and new gains once more, to plot their step responses
        scene = TuningScene(self.vehicle)
        cases = [TuningCase(loss, self.seed + k) for k, loss in enumerate(done.losses)]
        old, new = (fly_responses(scene, side.gains, cases) for side in (done.old, done.new))
        return build_report(done, (old, new))


@final
@dataclass(frozen=True, slots=True)
class GainSetResult:
    """One set of gains with its flights, stability margins and helium limit."""

    gains: CascadeGains
    flights: GainEvaluation
    steadiness: tuple[LoopMargins, ...]
    limit: HeliumLimit


@final
@dataclass(frozen=True, slots=True)
class TuningResult:
    """Result of a tuning."""

    order: TuningRequest
    gains_name: str
    search: GainSearchResult
    numbers: tuple[TunableParameter, ...]  # tuned parameters with their old values
    # Results with the old and the new gains
    old: GainSetResult
    new: GainSetResult
    losses: tuple[float, ...]  # losses in the search [kg]
    # The gains file and the results folder
    file: Path
    folder: Path


def select_start_gains(vehicle: str, named: str | None) -> str:
    """Return the name of the start gains; raise `BadInput` for another control law."""
    control = load_vehicle_file(vehicle).control
    law = control.law if control else 'none'
    if law != TUNABLE_LAW:
        raise BadInput(
            f'{vehicle} uses the control law {law}, but only {TUNABLE_LAW} can be tuned; choose a '
            f'vehicle whose control block names {TUNABLE_LAW}.'
        )
    if named is None and (control is None or control.gains is None):
        raise BadInput(
            f'{vehicle} names no gains in its control block; give the start gains with '
            '--gains NAME.'
        )
    return named or (control.gains if control and control.gains else '')


def build_cases(order: TuningRequest) -> list[TuningCase]:
    """Return the cases of the search: evenly spaced losses, one seed each."""
    # One case alone flies the smallest loss; `max` avoids the division by zero.
    gap = (order.most - order.least) / max(1, order.cases - 1)
    return [TuningCase(order.least + k * gap, order.seed + k) for k in range(order.cases)]


def check_loss_range(order: TuningRequest) -> None:
    """Raise `BadInput` for a range of losses that no gains could hold."""
    if order.least > order.most:
        raise BadInput(
            f'--least is {1e3 * order.least:g} g and --most {1e3 * order.most:g} g; --least must '
            'be the smaller one.'
        )
    most = rotor_lift_loss_limit(TuningScene(order.vehicle).nominal_vehicle)
    if order.most >= most:
        raise BadInput(
            f'The rotors of {order.vehicle} can compensate a lift loss of {1e3 * most:.1f} g, '
            f'less than --most {1e3 * order.most:g} g; choose a smaller --most.'
        )


def tune_once(order: TuningRequest, console: Console) -> TuningResult:
    """
    Search for gains, compare them with the start gains, and write the gains file.

    Raises
    ------
    BadInput
        If the request is invalid; raised before any flight.
    KeyboardInterrupt
        After Ctrl-C; the best gains so far are written.

    """
    name = select_start_gains(order.vehicle, order.gains)
    check_loss_range(order)
    old = load_gains(name)
    numbers = select_parameters(old, order.numbers)
    scene, cases = TuningScene(order.vehicle), build_cases(order)
    # The hash of all inputs names the folder, so the same command resumes its search.
    identity = hash_inputs(describe_search(order, old, numbers))
    folder = (order.out or Path('runs') / f'tune-{vehicle_name(order)}-{identity[:8]}').absolute()
    flights = order.budget * len(cases)
    console.print(
        f'{format_count(order.budget, "candidate")} with '
        f'{format_count(len(cases), "test flight")} each: {format_count(flights, "flight")}.',
        highlight=False,
    )
    with (
        StudyStore(folder, SEARCH_STORE, identity, order.options.retry_failed) as store,
        StudyProgress(console, order.budget, unit='candidates') as progress,
        order.options.open_workers(evaluate_gains) as workers,
    ):

        def show_candidate(count: int, best: float) -> None:
            progress.show_detail(
                f'{format_count(count * len(cases), "flight")}, best cost {best:.3f}'
            )
            progress.count_item()

        evaluate = partial(evaluate_candidate, scene, old, cases, workers)
        outcome = search_gains(numbers, evaluate, store, order.budget, order.seed, show_candidate)
        # The rounded gains of the file are also the ones that are compared.
        best = {path: round_gain(value) for path, value in outcome.numbers.items()}
        new = replace_parameters(old, best)
        file = folder / GAINS_NAME
        write_gains(new, format_gains_comment(order, name, outcome, len(cases)), file)
        if outcome.stopped:
            progress.show_message(
                f'{len(outcome.history)} of {order.budget} candidates were flown; the best gains '
                f'so far are in {relative_path(file)}. Repeat the command to resume.'
            )
            # The comparison would take another minute
            raise KeyboardInterrupt
        progress.wait_for(f'flying {order.draws} new random flights with old and new gains')
        fresh = draw_cases(order.least, order.most, order.draws, order.seed)
        both = fly_comparison(scene, (old, new), fresh, workers)
        progress.wait_for('computing margins and the helium limit of both')
        before, after = (
            evaluate_gain_set(scene, gains, own, order)
            for gains, own in zip((old, new), both, strict=True)
        )
    losses = tuple(case.loss for case in cases)
    return TuningResult(order, name, outcome, tuple(numbers), before, after, losses, file, folder)


def evaluate_candidate(
    scene: TuningScene,
    start: CascadeGains,
    cases: Sequence[TuningCase],
    workers: Workers[EvaluationJob, ResponseMetrics],
    candidate: Mapping[str, float],
) -> list[float] | ItemFailure:
    """Return the cost of each test flight of a candidate, or the failure of one."""
    gains = replace_parameters(start, candidate)
    tasks = [EvaluationJob(scene, gains, case) for case in cases]
    reports = evaluate_jobs(tasks, workers)
    return reports if isinstance(reports, ItemFailure) else [each.cost for each in reports]


def evaluate_gain_set(
    scene: TuningScene, gains: CascadeGains, flights: GainEvaluation, order: TuningRequest
) -> GainSetResult:
    """Compute the stability margins and the helium limit of a set of gains."""
    middle = 0.5 * (order.least + order.most)
    # A set, because the three coincide where the range is a point.
    losses = sorted({order.least, middle, order.most})
    # Margins in hover and in cruise
    margins = compute_loop_margins(scene, gains, losses, (0.0, TUNING_CRUISE_SPEED))
    return GainSetResult(
        gains, flights, tuple(margins), find_tolerable_helium_loss(scene.vehicle, gains)
    )


def vehicle_name(order: TuningRequest) -> str:
    """Return the name in the vehicle file."""
    return load_vehicle_file(order.vehicle).name


def describe_search(
    order: TuningRequest, gains: CascadeGains, numbers: Sequence[TunableParameter]
) -> dict[str, object]:
    """Return everything that the costs of a search depend on."""
    return {
        # The file's text rather than its name: an edited vehicle starts a new search.
        'vehicle': find_file('vehicle', order.vehicle).read_text(encoding='utf-8'),
        'gains': gains.model_dump(),
        'numbers': [asdict(number) for number in numbers],
        'cases': [asdict(case) for case in build_cases(order)],
        'steps': [list(step) for step in step_response.SETPOINT_STEPS],
        'seed': order.seed,
    }


def format_gains_comment(
    order: TuningRequest, start: str, result: GainSearchResult, cases: int
) -> list[str]:
    """Return the comment lines at the top of the gains file."""
    count = len(result.history)
    ended = ', stopped early' if result.stopped else ''
    return [
        f'Gains for {vehicle_name(order)}, found by: {order.format_command()}',
        f'{format_count(count, "candidate")} with {format_count(cases, "test flight")} '
        f'each{ended}, starting from the gains {start}; search seed {order.seed}.',
        f'Lift lost: {1e3 * order.least:g} to {1e3 * order.most:g} g relative to the trim of '
        f'the vehicle file; seeds {order.seed} to {order.seed + cases - 1}.',
        f'Cost {result.first:.3f} before, {result.cost:.3f} after (average of mean and worst; '
        'see lta tune --help).',
    ]


def fly_responses(
    scene: TuningScene, gains: CascadeGains, cases: Sequence[TuningCase]
) -> list[tuple[float, step_response.StepResponse]]:
    """Fly the test flights and return their responses, each with its loss [kg]."""
    return [(case.loss, step_response.fly_steps(scene, gains, case)) for case in cases]
