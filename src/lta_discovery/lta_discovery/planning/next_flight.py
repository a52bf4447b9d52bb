"""
The next flight: what to fly so that a name is the only one, as a sentence and as a scenario file.

Where no flight decides, the sentence says what to measure instead.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final, final

from lta_config.errors import BadInput
from lta_config.files import find
from lta_discovery.finding import NamedEffect
from lta_discovery.fit.evidence import floor_of, Pieces, Reduced
from lta_discovery.model.knobs import Knob
from lta_discovery.naming.accept import TIE
from lta_discovery.naming.classes import Kind, kind_of, same_class
from lta_discovery.naming.classes import others as alike
from lta_discovery.planning.advice import advice
from lta_discovery.planning.choice import Chosen, Planner, Rival, Tell
from lta_discovery.planning.pairs import Pairs
from lta_discovery.planning.rehearsal import Sensors
from lta_discovery.replay.linear import origin
from lta_discovery.study import Study
from lta_flight.ingredients import gather
import yaml

FILE: Final = 'next_flight.yaml'
SCENE: Final = 'hall'
STRATEGY: Final = 'bag'
MOST: Final = 4  # names that one is told from by a flight
CERTAIN: Final = 'No name is in doubt: there is no flight to plan.'
BIG: Final = 2.0  # typical sizes; of what is supposed of a name that no flight was studied for
SEEN_BY: Final[dict[Kind, Sensors]] = {
    'all': 'all',
    'imu': 'imu',
    'pose': 'pose',
    'wrench': 'pose',
    'hover': 'all',
}


@final
@dataclass(frozen=True, slots=True)
class Next:
    """
    What comes next.

    Attributes
    ----------
    text : str
        A sentence or two for people; '' where nothing is to be decided.
    scenario : mapping or None
        The file's content; None where no flight decides.
    nats : float
        Log Bayes factor to expect of the flight; 0 without one.

    """

    text: str = ''
    scenario: Mapping[str, Any] | None = None
    nats: float = 0.0

    def write(self, folder: Path) -> Path | None:
        """Write the scenario into a folder; return its path, None where there is none."""
        if self.scenario is None:
            return None
        path = folder / FILE
        head = f'# {self.text}\n# Flown by: lta fly --scenario {FILE}\n'
        text = yaml.safe_dump(self.scenario, sort_keys=False, default_flow_style=None, width=110)
        try:
            path.write_text(head + text, encoding='utf-8')
        except OSError as error:
            raise BadInput(f"'{path}' cannot be written ({error.strerror}); make room.") from error
        return path


def between(
    vehicle: str,
    first: str,
    second: str,
    scene: str = SCENE,
    kind: Kind = 'all',
    tell: Tell = lambda _words, _share: None,
) -> Next:
    """
    Return the flight that tells two names apart, without any flights that there are.

    Parameters
    ----------
    vehicle : str
        Name or file.
    first, second : str
        Of knobs: 'linear_drag.surge', 'quadratic_drag.surge'.
    scene : str
        Scenario, of which the room and the air are taken.
    kind : str
        Of the data that will be recorded.
    tell : callable
        Told what is being done.

    Raises
    ------
    BadInput
        If there is no such name, or the scene is too low to fly in.

    """
    planner = _planner(vehicle, scene, kind, (), tell)
    if first == second:
        raise BadInput(f"'{first}' is to be told from itself; name another effect.")
    one, other = planner.knob(first), planner.knob(second)
    a, b = (Rival(k, BIG * max(k.typical, 3.0 * k.tolerance)) for k in (one, other))
    return decided(planner, a, [b], kind)


def of_study(
    study: Study,
    vehicle: str,
    tell: Tell = lambda _words, _share: None,
    scene: str = SCENE,
) -> Next:
    """
    Return the flight that makes the strongest name of a study unique that is not so yet.

    Parameters
    ----------
    study : Study
        What was found, from which flights.
    vehicle, tell, scene
        As for `between`.

    """
    one = next((one for one in study.finding.effects if one.confusable_with), None)
    if one is None:
        return Next(CERTAIN)
    planner = _planner(vehicle, scene, _kind(study), _reduced(study), tell)
    knob = planner.knob(one.knobs[0])
    first = Rival(knob, _learned(one, planner.knobs)[knob.name])
    known = {each.name for each in planner.knobs}
    rivals = [name for name in one.confusable_with if name in known and name != knob.name]
    others = [planner.mimic(first, planner.knob(name)) for name in rivals]
    return decided(planner, first, others, _kind(study))


def _planner(
    vehicle: str,
    scene: str,
    kind: Kind,
    flown: Sequence[Reduced],
    tell: Tell,
) -> Planner:
    """Return what plans for a vehicle."""
    made = gather(vehicle, scene, STRATEGY, '')
    text = find('vehicle', vehicle).read_text(encoding='utf-8')
    return Planner(made, text, SEEN_BY[kind], flown, tell)


def decided(planner: Planner, first: Rival, others: Sequence[Rival], kind: Kind) -> Next:
    """Return what tells a name from others: a flight, a measurement, or both."""
    # A hover is one of many flights: what it cannot tell, another may.
    rich: Kind = 'all' if kind == 'hover' else kind
    name = first.knob.name
    never = tuple(o.knob.name for o in others if same_class(name, o.knob.name, rich))
    open_ = [other for other in others if other.knob.name not in never][:MOST]
    words = []
    if never:
        words.append(_never(name, never, rich))
    if not open_:
        return Next(' '.join(words))
    names = tuple(other.knob.name for other in open_)
    chosen = planner.choose(first, open_)
    if chosen is None:
        words.append(
            f'No safe flight that was tried would tell {name} from {_listed(names, "or")}: '
            f'{advice(name, names, rich)}.'
        )
        return Next(' '.join(words))
    words.append(_told(name, names, chosen))
    return Next(' '.join(words), scenario_of(name, names, chosen), chosen.nats)


def _never(name: str, others: tuple[str, ...], kind: Kind) -> str:
    """Return what to measure in place of a flight."""
    return f'No flight tells {_listed((name, *others))} apart: {advice(name, others, kind)}.'


def doubted(study: Study) -> Study:
    """
    Return a study whose names are confusable with all that its flights cannot tell from them.

    Besides what was tied in the refits: what no data of the kind can tell, and what these flights
    are expected to tell by less than names need to be apart.
    """
    if not study.finding.effects:
        return study
    kind = _kind(study)
    taught = [one.flight for one in study.flights if one.role != 'holdout']
    pairs = Pairs(_reduced(study), taught[0].knobs)
    effects = []
    for one in study.finding.effects:
        values = _learned(one, taught[0].knobs)
        own = [name for knob in one.knobs for name in alike(knob, kind)]
        near = [name for knob in one.knobs for name in pairs.confused(knob, values[knob], TIE)]
        found = dict.fromkeys((*one.confusable_with, *own, *near))
        both = [
            other
            for other in found
            if any(pairs.can_replace(knob, values[knob], other) for knob in one.knobs)
        ]
        # Two that are one and were both named are in doubt as well.
        only = one.knobs[0] if len(one.knobs) == 1 else ''
        effects.append(replace(one, confusable_with=tuple(n for n in both if n != only)))
    return replace(study, finding=replace(study.finding, effects=tuple(effects)))


def _learned(one: NamedEffect, knobs: Sequence[Knob]) -> dict[str, float]:
    """Return how far each named knob of an effect was turned; its typical size if that is lost."""
    change = {each.name: each.value - each.before for each in one.parameters}
    out = {}
    for knob in knobs:
        if knob.name in one.knobs:
            moved = (
                change[name] / rate
                for (effect, name), rate in knob.moves.items()
                if effect == one.name and rate and change.get(name)
            )
            out[knob.name] = next(moved, knob.typical)
    return out


def _reduced(study: Study) -> list[Reduced]:
    """Return what the flights that taught and confirmed say, about the vehicle file."""
    out = []
    for flight in (one.flight for one in study.flights if one.role != 'holdout'):
        begin = origin(study.nominal, flight.knobs, flight.replay.cut)
        out.append(Pieces(flight.at(begin)).reduced(floor_of(study.nominal)))
    return out


def _kind(study: Study) -> Kind:
    """Return the kind of data that taught and confirmed."""
    return kind_of([one.flight.replay.flight for one in study.flights if one.role != 'holdout'])


def hint(study: Study) -> str:
    """Return what comes next without planning it: the page of every study has this."""
    one = next((one for one in study.finding.effects if one.confusable_with), None)
    if one is None:
        return ''
    kind = _kind(study)
    rich: Kind = 'all' if kind == 'hover' else kind
    name = one.knobs[0]
    rivals = [o for o in one.confusable_with if o != name]
    never = tuple(o for o in rivals if same_class(name, o, rich))
    rest = tuple(o for o in rivals if o not in never)
    words = [_never(name, never, rich)] if never else []
    if rest:
        words.append(
            f'The same command with --plan writes the flight that is to tell {name} from '
            f'{_listed(rest, "or")}.'
        )
    return ' '.join(words)


def _told(name: str, names: tuple[str, ...], chosen: Chosen) -> str:
    """Return a flight in words."""
    x, y, z = chosen.space
    return (
        f'To tell {name} from {_listed(names, "or")}, {chosen.manoeuvre.about} for '
        f'{chosen.manoeuvre.length:.0f} s, twice: the true one is then expected to lead by '
        f'{chosen.nats:.0f} nats (3 decide). It takes {x:.0f} m by {y:.0f} m, and {z:.1f} m of '
        'height.'
    )


def scenario_of(name: str, names: tuple[str, ...], chosen: Chosen) -> dict[str, Any]:
    """Return the scenario file of a chosen flight."""
    scene = dict(chosen.made.contents['scenario'])
    about = f'{chosen.manoeuvre.about}, to tell {name} from {_listed(names, "or")}.'
    scene |= {'name': 'next_flight', 'about': about[0].upper() + about[1:]}
    return scene


def _listed(names: Sequence[str], word: str = 'and') -> str:
    """Return names in a row."""
    *first, last = names
    return f'{", ".join(first)} {word} {last}' if first else last
