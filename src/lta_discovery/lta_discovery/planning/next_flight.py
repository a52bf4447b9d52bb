"""
Plan the next flight that separates confusable effects, as a sentence and a scenario file.

If no flight does, the sentence suggests a measurement instead.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final, final, NamedTuple

from lta_config.command_line import format_lta_command, relative_path
from lta_config.errors import BadInput
from lta_config.files import find_file, parse_yaml
from lta_discovery.planning.equivalence_classes import is_equivalent, Kind
from lta_discovery.planning.flight_choice import (
    FlightChoice,
    NextFlightPlanner,
    ParameterHypothesis,
    Tell,
)
from lta_discovery.planning.rehearsal import Sensors
from lta_discovery.progress import DiscoverProgress
from lta_flight.flight_spec import load_spec
from lta_report.report import Report
from lta_report.request import argument, option, ReportRequest, StudyRun
import yaml

NEXT_FLIGHT_FILE: Final = 'next_flight.yaml'
NEXT_FLIGHT_SCENE: Final = 'hall'
NEXT_STRATEGY: Final = 'bag'
MOST_RIVALS: Final = 4  # most rivals of one flight
BIG: Final = 2.0  # typical sizes; hypothetical size of an effect without earlier flights
SEEN_BY: Final[dict[Kind, Sensors]] = {
    'all': 'all',
    'imu': 'imu',
    'pose': 'pose',
    'wrench': 'pose',
    'hover': 'all',
}


class MeasurementAdvice(NamedTuple):
    """Effects that flights confuse, and the measurement that separates them."""

    effects: frozenset[str]
    what: str


MEASURE: Final = (
    MeasurementAdvice(
        frozenset({'net_lift', 'payload', 'ballast', 'gas_purity'}),
        'each acts as a constant force; weigh the vehicle on a scale, without and with gas',
    ),
    MeasurementAdvice(
        frozenset({'tracker_delay', 'clock_offset', 'command_delay'}),
        'each is a delay; tap the vehicle and compare when its IMU and the tracker record it',
    ),
    MeasurementAdvice(
        frozenset({'added_mass', 'cg_height', 'thrust_scale', 'added_inertia', 'motor_lag'}),
        'they scale the response alike; measure the thrust on a scale, or fly a known payload',
    ),
    MeasurementAdvice(
        frozenset({'rotor_misalignment', 'rotor_fault', 'cg_offset', 'tracker_misalignment'}),
        'check the rotors, level the tracker, and measure one of these effects on its own',
    ),
    MeasurementAdvice(
        frozenset({'linear_drag', 'quadratic_drag', 'cross_flow'}),
        'tow the vehicle at two known speeds, or let it glide to rest with its motors off',
    ),
)
OTHERWISE: Final = 'measure one of these effects on its own'
RICHER: Final[dict[Kind, tuple[Kind, str]]] = {
    'pose': ('imu', 'record the IMU as well'),
    'imu': ('all', 'record range, pressure and voltage as well'),
    'wrench': ('pose', 'record the motor duties as well'),
    'hover': ('all', 'fly manoeuvres, not only a hover'),
}


@final
@dataclass(frozen=True, slots=True)
class NextFlightPlan:
    """The plan."""

    text: str = ''  # a sentence or two; '' if there is nothing to decide
    scenario: Mapping[str, Any] | None = None  # content of the file; None if no flight decides
    nats: float = 0.0  # expected log Bayes factor of the flight; 0 without one

    def format_scenario(self) -> str:
        """Return the text of the scenario file."""
        head = f'# {self.text}\n# Fly it with: lta fly --scenario {NEXT_FLIGHT_FILE}\n'
        return head + yaml.safe_dump(
            self.scenario, sort_keys=False, default_flow_style=None, width=110
        )


@final
class SeparatingFlightRequest(ReportRequest, command='tests between', folder='tests-between'):
    """
    Plan the flight that tells two effects of a vehicle apart.

    Simulates manoeuvres with the vehicle file, the cheapest first, and with each effect. Writes
    next_flight.yaml, a scenario for "lta fly", or says why no flight tells them apart and what to
    measure instead.

    Exit status 0: done. 2: bad input.

    Example: lta tests between linear_drag.surge quadratic_drag.surge --vehicle gtmab
    """

    first: str = argument('Effect, such as linear_drag.surge.')
    second: str = argument('Another effect.')
    vehicle: str = option('Vehicle name or file.', complete='vehicle')
    scenario: str = option('Scenario to fly in, name or file.', default=NEXT_FLIGHT_SCENE)

    def run(self, run: StudyRun) -> Report:
        """Return the report with the scenario to fly."""
        with DiscoverProgress(run.console) as progress:
            plan = plan_separating_flight(
                self.vehicle, self.first, self.second, self.scenario, tell=progress.show_stage
            )
        path, flies = relative_path(run.folder / NEXT_FLIGHT_FILE), plan.scenario is not None
        fly = format_lta_command('fly', '--vehicle', self.vehicle, '--scenario', path)
        return Report(
            command='tests between',
            subject=f'{self.first}, {self.second}',
            headline=plan.text,
            introduction='Each effect was simulated at a size of two typical sizes.',
            tiles=[],
            blocks=(),
            data={'next_flight': plan.text, 'expected_nats': plan.nats,
                  'scenario': str(path) if flies else None},
            commands={'fly it': fly} if flies else {},
            outputs={NEXT_FLIGHT_FILE: plan.format_scenario()} if flies else {},
        )  # fmt: skip


def plan_separating_flight(
    vehicle: str,
    first: str,
    second: str,
    scene: str = NEXT_FLIGHT_SCENE,
    kind: Kind = 'all',
    tell: Tell = lambda _words, _share: None,
) -> NextFlightPlan:
    """
    Plan the flight that separates two effects, without earlier flights.

    `first`, `second`: of parameters: 'linear_drag.surge', 'quadratic_drag.surge'. `scene`:
    scenario that gives the room and the air. Raise `BadInput` for an unknown effect, or a scenario
    too low to fly in.
    """
    planner = NextFlightPlanner(
        load_spec(vehicle, scene, NEXT_STRATEGY, ''), _read_text(vehicle), SEEN_BY[kind], tell
    )
    if first == second:
        raise BadInput(f"'{first}' is given twice; name two different effects.")
    one, other = planner.find_parameter(first), planner.find_parameter(second)
    # 3 tolerances at least: a smaller value would be within the error of the file
    a, b = (ParameterHypothesis(k, BIG * max(k.typical, 3.0 * k.tolerance)) for k in (one, other))
    return plan_decision(planner, a, [b], kind)


def plan_next_flight(
    vehicle: str,
    text: str,
    names: Sequence[str],
    values: Mapping[str, float],
    kind: Kind,
    tell: Tell = lambda _words, _share: None,
    scene: str = NEXT_FLIGHT_SCENE,
) -> NextFlightPlan:
    """
    Plan the flight that separates effects that earlier flights cannot tell apart.

    Parameters
    ----------
    vehicle, text : str
        Name of the vehicle, and its file, which the flight is planned about.
    names : sequence of str
        Of parameters, the one to separate from the others first.
    values : mapping of str to float
        Their estimates, relative to the file; a typical size where there is none.

    """
    spec = load_spec(vehicle, scene, NEXT_STRATEGY, '')
    # After a calibration that file flies
    spec = replace(spec, contents={**spec.contents, 'vehicle': parse_yaml(text, vehicle)})
    planner = NextFlightPlanner(spec, text, SEEN_BY[kind], tell)
    effects = [name for name in names if name in {one.name for one in planner.knobs}]
    if len(effects) < 2:
        return NextFlightPlan(
            f'No flight is planned to separate {_join_names(names)}: only effects can be flown.'
        )
    first, *others = [
        ParameterHypothesis(one, values.get(one.name) or one.typical)
        for one in map(planner.find_parameter, effects)
    ]
    return plan_decision(planner, first, others, kind)


def _read_text(vehicle: str) -> str:
    """Return the text of a vehicle file."""
    return find_file('vehicle', vehicle).read_text(encoding='utf-8')


def plan_decision(
    planner: NextFlightPlanner,
    first: ParameterHypothesis,
    others: Sequence[ParameterHypothesis],
    kind: Kind,
) -> NextFlightPlan:
    """Return how to separate an effect from others: a flight, a measurement, or both."""
    # A richer flight may separate what a hover cannot.
    rich: Kind = 'all' if kind == 'hover' else kind
    name = first.knob.name
    never = tuple(o.knob.name for o in others if is_equivalent(name, o.knob.name, rich))
    # More rivals would need too many simulations
    open_ = [other for other in others if other.knob.name not in never][:MOST_RIVALS]
    words = []
    if never:
        words.append(_format_no_flight(name, never, rich))
    if not open_:
        return NextFlightPlan(' '.join(words))
    names = tuple(other.knob.name for other in open_)
    chosen = planner.choose_flight(first, open_)
    if chosen is None:
        words.append(
            f'No safe manoeuvre separates {name} from {_join_names(names, "or")}: '
            f'{suggest_measurement(name, names, rich)}.'
        )
        return NextFlightPlan(' '.join(words))
    words.append(_format_flight(name, names, chosen))
    return NextFlightPlan(' '.join(words), build_scenario(name, names, chosen), chosen.nats)


def _format_no_flight(name: str, others: tuple[str, ...], kind: Kind) -> str:
    """Suggest a measurement in place of a flight."""
    return (
        f'No flight separates {_join_names((name, *others))}: '
        f'{suggest_measurement(name, others, kind)}.'
    )


def _format_flight(name: str, names: tuple[str, ...], chosen: FlightChoice) -> str:
    """Describe a flight in words."""
    x, y, z = chosen.space
    return (
        f'To separate {name} from {_join_names(names, "or")}, {chosen.manoeuvre.about} for '
        f'{chosen.manoeuvre.length:.0f} s; fly this twice. The expected evidence for the true '
        f'effect is {chosen.nats:.0f} nats (3 are enough). The flight needs a space of {x:.0f} m '
        f'by {y:.0f} m and a height of {z:.1f} m.'
    )


def build_scenario(name: str, names: tuple[str, ...], chosen: FlightChoice) -> dict[str, Any]:
    """Return the scenario file of a chosen flight."""
    scene = dict(chosen.flight_spec.contents['scenario'])
    about = f'{chosen.manoeuvre.about}, to separate {name} from {_join_names(names, "or")}.'
    scene |= {'name': 'next_flight', 'about': about[0].upper() + about[1:]}
    return scene


def _join_names(names: Sequence[str], word: str = 'and') -> str:
    """Join names with commas and a final conjunction."""
    *first, last = names
    return f'{", ".join(first)} {word} {last}' if first else last


def suggest_measurement(name: str, others: tuple[str, ...], kind: Kind) -> str:
    """
    Return how to separate an effect from others that no flight of a kind can separate.

    `name`, `others`: of parameters: 'net_lift.force'.
    """
    # Prefer more sensors or a richer flight, if they separate the effects
    richer = RICHER.get(kind)
    if richer is not None and not any(is_equivalent(name, one, richer[0]) for one in others):
        return richer[1]
    effects = {one.partition('.')[0] for one in (name, *others)}
    matches = (advice.what for advice in MEASURE if effects <= advice.effects)
    return next(matches, OTHERWISE)
