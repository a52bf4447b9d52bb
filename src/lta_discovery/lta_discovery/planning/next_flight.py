"""
Plan the next flight that separates confusable effects, as a sentence and a scenario file.

If no flight does, the sentence suggests a measurement instead.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final, final

from lta_config.errors import BadInput
from lta_config.files import find_file, parse_yaml
from lta_discovery.finding import NamedEffect
from lta_discovery.fit.evidence import PieceReducer, ReducedFlight, wrench_floor
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.planning.flight_choice import (
    FlightChoice,
    NextFlightPlanner,
    ParameterHypothesis,
    Tell,
)
from lta_discovery.planning.measurement_advice import suggest_measurement
from lta_discovery.planning.rehearsal import Sensors
from lta_discovery.planning.separability import PairSeparability
from lta_discovery.replay.linearized_flight import unchanged_vehicle_point
from lta_discovery.selection.candidate_acceptance import TIE
from lta_discovery.selection.equivalence_classes import (
    classify_data_kind,
    is_equivalent,
    Kind,
    list_equivalent_effects,
)
from lta_discovery.study import DiscoveryStudy
from lta_flight.flight_spec import load_spec
import yaml

FILE: Final = 'next_flight.yaml'
SCENE: Final = 'hall'
STRATEGY: Final = 'bag'
MOST: Final = 4  # most rivals of one flight
CERTAIN: Final = 'No effect found can be confused with another: there is no flight to plan.'
BIG: Final = 2.0  # typical sizes; hypothetical size of an effect without earlier flights
SEEN_BY: Final[dict[Kind, Sensors]] = {
    'all': 'all',
    'imu': 'imu',
    'pose': 'pose',
    'wrench': 'pose',
    'hover': 'all',
}


@final
@dataclass(frozen=True, slots=True)
class NextFlightPlan:
    """The plan."""

    text: str = ''  # a sentence or two; '' if there is nothing to decide
    scenario: Mapping[str, Any] | None = None  # content of the file; None if no flight decides
    nats: float = 0.0  # expected log Bayes factor of the flight; 0 without one

    def write(self, folder: Path) -> Path | None:
        """Write the scenario into a folder; return its path, or None without a scenario."""
        if self.scenario is None:
            return None
        path = folder / FILE
        head = f'# {self.text}\n# Fly it with: lta fly --scenario {FILE}\n'
        text = yaml.safe_dump(self.scenario, sort_keys=False, default_flow_style=None, width=110)
        try:
            path.write_text(head + text, encoding='utf-8')
        except OSError as error:
            raise BadInput(
                f"'{path}' cannot be written ({error.strerror}); check that its folder is "
                'writable and has free space.'
            ) from error
        return path


def plan_separating_flight(
    vehicle: str,
    first: str,
    second: str,
    scene: str = SCENE,
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
        load_spec(vehicle, scene, STRATEGY, ''), _read_text(vehicle), SEEN_BY[kind], (), tell
    )
    if first == second:
        raise BadInput(f"'{first}' is given twice; name two different effects.")
    one, other = planner.find_parameter(first), planner.find_parameter(second)
    # 3 tolerances at least: a smaller value would be within the error of the file
    a, b = (ParameterHypothesis(k, BIG * max(k.typical, 3.0 * k.tolerance)) for k in (one, other))
    return plan_decision(planner, a, [b], kind)


def plan_for_study(
    study: DiscoveryStudy,
    vehicle: str,
    tell: Tell = lambda _words, _share: None,
    scene: str = SCENE,
) -> NextFlightPlan:
    """Plan the flight that separates the strongest confusable effect of a study."""
    one = next((one for one in study.finding.effects if one.confusable_with), None)
    if one is None:
        return NextFlightPlan(CERTAIN)
    kind, text = _classify_study(study), study.calibrated_file or _read_text(vehicle)
    spec = load_spec(vehicle, scene, STRATEGY, '')
    # After a calibration that file flies, and the flights are about its vehicle
    spec = replace(spec, contents={**spec.contents, 'vehicle': parse_yaml(text, vehicle)})
    knobs = study.flights[0].flight.knobs
    planner = NextFlightPlanner(spec, text, SEEN_BY[kind], _reduce_flights(study), tell, knobs)
    knob = planner.find_parameter(one.knobs[0])
    first = ParameterHypothesis(knob, _estimate_changes(one, planner.knobs)[knob.name])
    names = {each.name for each in planner.knobs}
    rivals = [name for name in one.confusable_with if name in names and name != knob.name]
    others = [planner.fit_rival_value(first, planner.find_parameter(name)) for name in rivals]
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
    open_ = [other for other in others if other.knob.name not in never][:MOST]
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


def add_confusable(study: DiscoveryStudy) -> DiscoveryStudy:
    """
    Add to the effects of a study all others that its flights cannot separate from them.

    Besides ties of the refits, these are equivalents for the kind of data, and effects whose
    expected evidence in these flights is below the required one.
    """
    if not study.finding.effects:
        return study
    kind = _classify_study(study)
    flights = [one.flight for one in study.flights if one.role != 'holdout']
    pairs = PairSeparability(_reduce_flights(study), flights[0].knobs)
    effects = []
    for one in study.finding.effects:
        values = _estimate_changes(one, flights[0].knobs)
        own = [name for knob in one.knobs for name in list_equivalent_effects(knob, kind)]
        near = [
            name for knob in one.knobs for name in pairs.list_confused(knob, values[knob], TIE)
        ]
        candidates = dict.fromkeys((*one.confusable_with, *own, *near))
        both = [
            other
            for other in candidates
            if any(pairs.can_replace(knob, values[knob], other) for knob in one.knobs)
        ]
        # Two named but equivalent effects are confusable as well.
        # An effect is not confusable with itself
        only = one.knobs[0] if len(one.knobs) == 1 else ''
        effects.append(replace(one, confusable_with=tuple(n for n in both if n != only)))
    return replace(study, finding=replace(study.finding, effects=tuple(effects)))


def _estimate_changes(one: NamedEffect, knobs: Sequence[FreeParameter]) -> dict[str, float]:
    """Return the change of each named parameter; its typical size if unknown."""
    change = {each.name: each.value - each.before for each in one.parameters}
    out = {}
    for knob in knobs:
        if knob.name in one.knobs:
            moved = (
                # Back from the model parameter to the unit of the free parameter
                change[name] / rate
                for (effect, name), rate in knob.moves.items()
                if effect == one.name and rate and change.get(name)
            )
            out[knob.name] = next(moved, knob.typical)
    return out


def _reduce_flights(study: DiscoveryStudy) -> list[ReducedFlight]:
    """Return the reduced training and confirming flights, about the vehicle file."""
    out = []
    for flight in (one.flight for one in study.flights if one.role != 'holdout'):
        begin = unchanged_vehicle_point(study.nominal, flight.knobs, flight.replay.cut)
        out.append(
            PieceReducer(flight.linearize(begin)).eliminate_unknowns(wrench_floor(study.nominal))
        )
    return out


def _classify_study(study: DiscoveryStudy) -> Kind:
    """Return the kind of data of the training and confirming flights."""
    return classify_data_kind(
        [one.flight.replay.flight for one in study.flights if one.role != 'holdout']
    )


def format_next_step(study: DiscoveryStudy) -> str:
    """Return the next step without a plan, as shown on every page."""
    one = next((one for one in study.finding.effects if one.confusable_with), None)
    if one is None:
        return ''
    kind = _classify_study(study)
    rich: Kind = 'all' if kind == 'hover' else kind
    name = one.knobs[0]
    rivals = [o for o in one.confusable_with if o != name]
    never = tuple(o for o in rivals if is_equivalent(name, o, rich))
    rest = tuple(o for o in rivals if o not in never)
    words = [_format_no_flight(name, never, rich)] if never else []
    if rest:
        words.append(
            f'Repeat the command with --plan to plan a flight that separates {name} from '
            f'{_join_names(rest, "or")}.'
        )
    return ' '.join(words)


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
