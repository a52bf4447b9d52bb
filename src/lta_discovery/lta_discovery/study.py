"""A study of some flights of one vehicle, from the flights to the finding."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Final, final

from lta_config.errors import BadInput
from lta_discovery.finding import Finding, Gap, Rung, Verdict
from lta_discovery.fit.bounds import strained_words, wanting_out
from lta_discovery.fit.evidence import floor_of, own_variance
from lta_discovery.fit.fit import Fit, Fitter, Joint
from lta_discovery.flights.measured import Measured
from lta_discovery.flights.outliers import without_outliers
from lta_discovery.flights.said_once import said_once
from lta_discovery.flights.splitting import assigned, Role, ROLES
from lta_discovery.flights.windows import FEWEST, windows
from lta_discovery.forecast.held_out import gaps, shown
from lta_discovery.forecast.share import forecasting
from lta_discovery.model.candidates import whole
from lta_discovery.model.knobs import Knob, knobs
from lta_discovery.model.nominal import Nominal
from lta_discovery.naming.classes import Kind, kind_of, same_class
from lta_discovery.naming.detectable import detectable
from lta_discovery.naming.naming import Named, Naming, Step
from lta_discovery.naming.proof import Proof, Proven
from lta_discovery.naming.sizes import effects, learned
from lta_discovery.outside.outside import Outside, outside
from lta_discovery.replay.linear import Point
from lta_discovery.replay.linearise import Linearised
from lta_discovery.replay.periods import knots_for
from lta_discovery.replay.replay import Replay
from lta_discovery.replay.sensing import floor_pressure, Places
from lta_model.vehicle import Vehicle

Progress = Callable[[str, float], None]

FASTER: Final = 1.25  # times as many knots, for which naming begins anew
FAR: Final = 3.0  # s; the horizon at which the model has to be better than coast


@final
@dataclass(frozen=True, slots=True)
class Flown:
    """
    One flight of a study.

    Attributes
    ----------
    name : str
        Of its bag.
    role : str
        'train', 'confirm' or 'holdout'.
    flight : Linearised
        Ready to be replayed.

    """

    name: str
    role: str
    flight: Linearised


@final
@dataclass(frozen=True, slots=True)
class Shown:
    """
    One flight under three models; nothing in them was fitted to it if it was held out.

    Attributes
    ----------
    flown : Flown
        The flight.
    before, tuned, after : Point
        The vehicle file; its tolerances fitted without any effect; with the named effects.

    """

    flown: Flown
    before: Point
    tuned: Point
    after: Point


@final
@dataclass(frozen=True, slots=True)
class Study:
    """
    What was found, with what it takes to draw it.

    Attributes
    ----------
    finding : Finding
        The words and numbers.
    nominal, learned : Nominal
        The vehicle as its file has it, and with the named effects.
    flights : sequence of Flown
        All of them.
    shown : sequence of Shown
        The held-out flights, or the confirming ones where there are none.
    bare : sequence of Fit
        The flights that taught, then those that confirmed, their tolerances fitted without any
        effect.
    full : sequence of Fit
        The same with the named effects.
    refitted : Nominal, optional
        The vehicle with everything fitted to forecasts, for forecasts between what was flown.

    """

    finding: Finding
    nominal: Nominal
    learned: Nominal
    flights: Sequence[Flown]
    shown: Sequence[Shown]
    bare: Sequence[Fit] = ()
    full: Sequence[Fit] = ()
    refitted: Nominal | None = None


def study(
    vehicle: Vehicle, flights: Sequence[Role], seed: int = 0, progress: Progress | None = None
) -> Study:
    """
    Find what is missing, confirm it, and show what it is worth.

    Parameters
    ----------
    vehicle : Vehicle
        As its file has it.
    flights : sequence of (name, role, Measured)
        Role 'train', 'confirm' or 'holdout'; where nothing confirms, what teaches is split, and
        a single flight in three parts.
    seed : int
        Of the bootstrap.
    progress : callable, optional
        Told what is being done, and which part of all is done.

    Raises
    ------
    BadInput
        If no flight teaches, or one is too short for a prediction.

    """
    tell = progress or (lambda what, part: None)
    tell('making ready', 0.0)
    nominal = Nominal.of(vehicle)
    flown, known, warnings = _flown(vehicle, nominal, flights)
    flown, found = _named(nominal, flown, lambda part: tell('naming', 0.05 + 0.6 * part))
    pair = _of(flown, 'train'), _of(flown, 'confirm')
    tell('proving', 0.65)
    proven = Proof(nominal, [*pair[0], *pair[1]]).run(found)
    tell('predicting', 0.9)
    held_out = bool(_of(flown, 'holdout'))
    last = [f for f in flown if f.role == ('holdout' if held_out else 'confirm')]
    bare, measured = _forecasting(nominal, [*pair[0], *pair[1]], proven)
    models = [shown(f.flight, nominal, bare, measured) for f in last]
    differences = gaps([f.flight for f in last], models, seed)
    if not held_out:
        warnings.append('No flight was held out: the gaps are of flights that confirmed.')
    strained = wanting_out(known, proven.full.prior, proven.full.fitted.mean)
    warnings.extend(strained_words(strained))
    rest = outside(pair, proven.full, floor_of(nominal))
    kind = kind_of([f.flight.replay.flight for f in flown])
    finding = Finding(
        verdict=verdict(proven, rest, differences, kind),
        effects=effects(nominal, proven, known, rest.more),
        ladder=tuple(_rungs(step) for step in (*found.steps, *proven.steps)),
        where=(),
        gaps=tuple(differences),
        held_out=held_out,
        remains=rest.remains,
        warnings=tuple(warnings),
        seed=seed,
        bags={role: tuple(f.name for f in flown if f.role == role) for role in ROLES},
        vehicle=vehicle.file.name,
        detectable=detectable(
            proven.full.sides(len(pair[0])), proven.full.prior, known, tuple(whole(proven.names))
        ),
        unexplained=rest.sentences,
        draught=rest.draught,
        strained=tuple(strained),
    )
    seen = [Shown(f, *each) for f, each in zip(last, models, strict=True)]
    tell('done', 1.0)
    after = learned(nominal, proven, known, finding.effects)
    fits = proven.bare.members, proven.full.members
    return Study(finding, nominal, after, flown, seen, *fits)


def _flown(
    vehicle: Vehicle, nominal: Nominal, flights: Sequence[Role]
) -> tuple[list[Flown], list[Knob], list[str]]:
    """Return flights ready to be replayed, what can be turned, and what makes them weaker."""
    tidy, said = _tidied(flights)
    given, warnings = assigned(tidy)
    known = knobs(nominal, any(flight.wrench is not None for _, _, flight in given))
    flown = [Flown(name, role, ready(vehicle, each, known)) for name, role, each in given]
    _enough(flown)
    return flown, known, [*warnings, *said]


def _of(flown: Sequence[Flown], role: str) -> list[Linearised]:
    """Return the flights of a role."""
    return [one.flight for one in flown if one.role == role]


def _named(
    nominal: Nominal, flown: list[Flown], tell: Callable[[float], None]
) -> tuple[list[Flown], Named]:
    """
    Name what is missing; return the flights with as many knots as they need, and what was found.

    The vehicle file says how fast the vehicle swings, and so does its attitude. Where the fit
    finds that it swings faster than either, all begins anew with more knots.
    """
    knots = knots_for([one.flight for one in flown], nominal)
    while True:
        flown = [replace(one, flight=one.flight.with_knots(knots)) for one in flown]
        pair = _of(flown, 'train'), _of(flown, 'confirm')
        found = Naming(nominal, pair).run(tell)
        fitted = [joint.group.linears[0].point.nominal for joint in found.fits]
        needed = max(knots_for(side, each) for side, each in zip(pair, fitted, strict=True))
        if needed <= FASTER * knots:
            return flown, found
        knots = needed


def _forecasting(
    nominal: Nominal, flights: Sequence[Linearised], proven: Proven
) -> tuple[Joint, Joint]:
    """Return the fits without and with effects, their tolerances as forecasts bear them."""
    known = flights[0].knobs
    fitter = Fitter(nominal, flights, own_variance(known), floor_of(nominal))
    named = whole(proven.names)
    places = [k for k, knob in enumerate(known) if knob.name in named]
    bare = forecasting(fitter, proven.bare)
    return bare, forecasting(fitter, proven.measured, places) if places else bare


def _tidied(flights: Sequence[Role]) -> tuple[list[Role], list[str]]:
    """Return flights without wild readings, and a sentence on each that had any."""
    out, said = [], []
    for name, role, flight in flights:
        clean, count = without_outliers(flight)
        out.append((name, role, clean))
        if count:
            said.append(f'{name}: wild readings were left out, {count} of them.')
    return out, said_once(said, len(flights))


def ready(vehicle: Vehicle, flight: Measured, known: Sequence[Knob]) -> Linearised:
    """Return a flight ready to be replayed."""
    replay = Replay(flight, windows(flight), vehicle.command(()))
    places = Places.of(vehicle, 0.0)
    return Linearised(replay, known, Places.of(vehicle, floor_pressure(flight, places)))


def _enough(flown: Sequence[Flown]) -> None:
    """Refuse flights that are too short to say anything."""
    for one in flown:
        if len(one.flight.replay.first) < FEWEST:
            raise BadInput(
                f"The flight '{one.name}' has {len(one.flight.replay.first)} usable pieces "
                f"as '{one.role}'; at least {FEWEST} are needed: fly longer, or mend its gaps."
            )


def _rungs(step: Step) -> tuple[Rung, ...]:
    """Return one round of the ladder of evidence."""
    return tuple(
        Rung(
            trial.name, trial.gain, trial.replicated, trial.held_out, trial.apart,
            trial.name == step.named,
        )
        for trial in step.trials
    )  # fmt: skip


def verdict(proven: Proven, rest: Outside, differences: Sequence[Gap], kind: Kind) -> Verdict:
    """
    Return the verdict: what the flights allow to say.

    A rival that no flight of this kind could tell from what was named does not put it in question.
    """
    far = [gap for gap in differences if gap.channel == 'position' and gap.horizon_s == FAR]
    if far and far[0].coast < min(far[0].tuned, far[0].after) and not rest.held:
        return 'not_identifiable'
    doubted = [
        any(not same_class(name, one, kind) for one in proven.unlike[name])
        for name in proven.names
    ]
    if doubted and all(doubted):
        return 'not_identifiable'
    return rest.verdict(proven.names)
