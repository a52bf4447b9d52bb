"""
Name what is missing, one effect at a time, until no candidate is confirmed.

A glance at all candidates (`scan`) can promise what a refit does not keep, and large unexplained
forces can hide an effect; so the best few are refitted, on the flights that teach and on those
that confirm, each by themselves, and only that counts.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Final, final

from lta_discovery.fit import early
from lta_discovery.fit.deviations import weighed
from lta_discovery.fit.evidence import floor_of, learned, own_variance, Prior, shared, Sizes
from lta_discovery.fit.fit import Fitter, Joint
from lta_discovery.fit.starts import begun, TRIED
from lta_discovery.model.candidates import components, whole
from lta_discovery.model.knobs import Knob
from lta_discovery.model.nominal import Nominal
from lta_discovery.naming.accept import APART, TIE, Trial, TRIFLE
from lta_discovery.naming.beside import vague
from lta_discovery.naming.displacing import AGREED, apart, differ, Displacing, HALF, QUARTER
from lta_discovery.naming.scan import likeness, scan, SIZES
from lta_discovery.parallel import map_parallel
from lta_discovery.replay.linear import origin
from lta_discovery.replay.linearise import Linearised
import numpy as np

Pair = tuple[Joint, Joint]
# Candidates worth a refit: what each promises [nats], and what looks like it.
Glance = Mapping[str, tuple[float, tuple[str, ...]]]

QUICK: Final = 5  # of each glance
REFITTED: Final = 4  # candidates of a round
CAP: Final = 1.5  # floors; of the deviations in the second glance
MOST: Final = 4  # effects
WORTH: Final = 1.0  # nats; a glance below it is not followed
ROUGHLY: Final = 0.3  # nats; how well a promise need be known
HOPE: Final = 5.0  # nats; nor is a candidate that promises less on all flights together
HOPELESS: Final = 0.35  # of what the best has won: who promises less is not refitted
ALIKE: Final = 0.98  # of the cosine of two columns; beyond it one refit stands for both
UNLIKE: Final = 0.5  # of the same; below it the failure of the one says nothing of the other
CHANCES: Final = 1  # further glances, beside what has failed
EVEN: Final = 0.2  # of what it wins on one side, that a candidate of these wins on the other
CAPPED: Final = 2.5  # floors; of the deviations that a fit begins with


@final
@dataclass(frozen=True, slots=True)
class Step:
    """
    One round.

    Attributes
    ----------
    trials : tuple of Trial
        Those refitted, the best first.
    tied : tuple of str
        Names that nothing tells from the best.
    named : str
        '' where none was confirmed.

    """

    trials: tuple[Trial, ...]
    tied: tuple[str, ...]
    named: str


@final
@dataclass(frozen=True, slots=True)
class Named:
    """
    What was found.

    Attributes
    ----------
    steps : tuple of Step
        Round by round; the last one named nothing, unless there were too many.
    names : tuple of str
        Of the effects, in the order in which they were found.
    fits : pair of Joint
        Of the flights that teach and of those that confirm, with them.
    bare : pair of Joint
        The same without any.
    sizes : mapping of str to float
        How many typical sizes each may have, where it is not one.

    """

    steps: tuple[Step, ...]
    names: tuple[str, ...]
    fits: Pair
    bare: Pair
    sizes: Sizes = field(default_factory=dict)


@final
class Naming:
    """
    Flights of one vehicle.

    Parameters
    ----------
    nominal : Nominal
        The vehicle as its file has it.
    flights : pair of sequences of Linearised
        To learn from, and to confirm by; at least one each.

    """

    def __init__(
        self, nominal: Nominal, flights: tuple[Sequence[Linearised], Sequence[Linearised]]
    ) -> None:
        self.nominal, self.flights = nominal, flights
        self.knobs = flights[0][0].knobs
        self.floor = floor_of(nominal)
        own = own_variance(self.knobs)
        self.fitters = [Fitter(nominal, each, own, self.floor) for each in flights]
        self._displacing = Displacing(flights, self.floor)
        self._names = [knob.name for knob in self.knobs]
        self._sizes: dict[str, float] = {}

    def run(self, progress: Callable[[float], None] = lambda part: None) -> Named:
        """Name what is missing, and tell which part is done, as far as anyone can know."""
        named: tuple[str, ...] = ()
        bare = fits = self._first()
        steps: list[Step] = []
        history: list[tuple[str, Pair]] = []
        while len(named) < MOST:
            progress(1.0 - 0.7 * 0.5 ** len(steps))
            step, then = self._round(named, fits)
            steps.append(step)
            if not step.named:
                break
            history.append((step.named, fits))
            named, fits = (*named, step.named), then
        gone = {*self._displacing.withdrawn(history, fits), *self._impossible(named, fits)}
        if gone:
            named = tuple(name for name in named if name not in gone)
            fits = self._fitted(named, bare) if named else bare
            steps = [replace(one, named='') if one.named in gone else one for one in steps]
        sizes = {name: self._sizes[name] for name in named if name in self._sizes}
        return Named(tuple(steps), named, fits, bare, sizes)

    def _first(self) -> Pair:
        """Fit all flights without any effect."""
        prior = shared(self.knobs)

        def fit(fitter: Fitter) -> Joint:
            points = [origin(self.nominal, self.knobs, each.replay.cut) for each in fitter.flights]
            at, points, deviations = early.begun(fitter, prior, points)
            return fitter.fit(prior, fitter.about(at, points), deviations)

        first, second = map_parallel(fit, self.fitters)
        return first, second

    def _knob(self, name: str) -> Knob:
        """Return a knob by its name."""
        return self.knobs[self._names.index(name)]

    def _impossible(self, named: Sequence[str], fits: Pair) -> set[str]:
        """Return those of which a side has a value that no such effect can have."""
        out = set[str]()
        for name in named:
            for k in self._places(name):
                for this in fits:
                    value, deviation = this.fitted.mean[k], np.sqrt(this.fitted.covariance[k, k])
                    if not self.knobs[k].possible(float(value), float(deviation)):
                        out.add(name)
        return out

    def _places(self, name: str) -> list[int]:
        """Return which knobs are the components of a candidate."""
        return [self._names.index(one) for one in components(name) if one in self._names]

    def _trifling(self, name: str, fits: Pair) -> bool:
        """Tell whether a candidate is too small to be worth a name, on either side."""
        places = self._places(name)
        typical = np.array([self.knobs[k].typical for k in places])
        sizes = [np.max(np.abs(this.fitted.mean[places]) / typical) for this in fits]
        return bool(min(sizes) < TRIFLE)

    def _fitted(self, named: Sequence[str], before: Pair) -> Pair:
        """Fit all flights with some effects, from where they stand."""
        prior = shared(self.knobs, named, self._sizes)

        def fit(one: tuple[Fitter, Joint]) -> Joint:
            fitter, last = one
            deviations = np.minimum(last.deviations, CAPPED * self.floor)
            begin = begun(fitter, prior, last.group, deviations, named)
            return fitter.fit(prior, begin, deviations)

        first, second = map_parallel(fit, list(zip(self.fitters, before, strict=True)))
        return first, second

    def _glance(self, named: Sequence[str], fits: Pair, failed: Sequence[str] = ()) -> Glance:
        """
        Return the few candidates worth a refit: what they promise, and what looks like them.

        What looks like one that has failed already is left out, and then the words for whatever
        follows motion, place or time as well.
        """
        prior = shared(self.knobs, named, self._sizes)
        out = {*whole(named), *self._like(failed, prior, fits)}
        found: dict[str, float] = {}
        sizes: dict[str, set[float]] = {}
        for this in fits:
            capped = this.group.reduced(np.minimum(this.deviations, CAP * self.floor))
            for reduced in (this.reduced, capped):
                seen = [
                    s
                    for s in scan(reduced, this.group.at, prior, self.knobs)
                    if s.name not in out and self._knob(s.name).promising(s.value, s.deviation)
                ]
                for one in seen[:QUICK]:
                    if one.gain > WORTH:
                        sizes.setdefault(one.name, set()).add(one.size)
        for name, some in sizes.items():
            both = {size: self._promised(name, size, named, fits) for size in some}
            self._sizes[name] = max(both, key=lambda size: both[size])
            found[name] = both[self._sizes[name]]
        ranked = sorted(found, key=lambda name: -found[name])
        worth = [name for name in ranked if found[name] > HOPE]
        return {
            name: (found[name], same) for name, same in self._distinct(worth, prior, fits).items()
        }

    def _distinct(self, ranked: list[str], prior: Prior, fits: Pair) -> dict[str, tuple[str, ...]]:
        """Return the first few candidates that no flight takes for each other."""
        alike = np.min(
            [np.abs(likeness(this.reduced, prior, ranked, self.knobs)) for this in fits], axis=0
        )
        out: dict[str, tuple[str, ...]] = {}
        for i, name in enumerate(ranked):
            same = [other for other in out if alike[i, ranked.index(other)] > ALIKE]
            if same:
                out[same[0]] = (*out[same[0]], name)
            elif whole(out) & {name}:
                continue  # a component of what is tried already
            elif len(out) < REFITTED:
                out[name] = ()
        return out

    def _promised(self, name: str, size: float, named: Sequence[str], fits: Pair) -> float:
        """Return what a candidate wins with the deviations free, without relinearising."""
        prior = shared(self.knobs, (*named, name), {**self._sizes, name: size})

        def won(this: Joint) -> float:
            found = weighed(this.group, prior, this.deviations, self.floor, worth=ROUGHLY)
            return found[1] - this.evidence

        return sum(map_parallel(won, fits)) - SIZES[size]

    def _like(self, failed: Sequence[str], prior: Prior, fits: Pair) -> set[str]:
        """Return those that have failed, what some flight takes for one, and vague words."""
        if not failed:
            return set()
        others = [knob.name for knob in self.knobs if knob.typical > 0.0]
        names = [*failed, *(name for name in others if name not in failed)]
        words = {name for name in others if vague(name)}
        alike = [np.abs(likeness(this.reduced, prior, names, self.knobs)) for this in fits]
        nearest = np.max(alike, axis=0)[:, : len(failed)].max(axis=1)
        near = zip(names, nearest, strict=True)
        return {*failed, *words, *(name for name, cosine in near if cosine > UNLIKE)}

    def _round(self, named: tuple[str, ...], fits: Pair) -> tuple[Step, Pair]:
        """
        Try the best candidates.

        What is outside the library fills the glance with what it resembles. Where all that fails,
        candidates that resemble none of it are tried as well; they must be of another place.
        Where something still remains, so are those that no glance can judge, since they jump.
        """
        step, then = self._tried(named, fits, self._glance(named, fits))
        trials = step.trials
        judged = {*whole(named), *(trial.name for trial in trials)}
        for _ in range(CHANCES):
            if step.named or not step.trials or not self._displacing.loud(fits):
                break
            failed = tuple(trial.name for trial in trials)
            step, then = self._tried(named, fits, self._glance(named, fits, failed), failed)
            trials = (*trials, *step.trials)
        jumping = {name: (np.inf, ()) for name in TRIED if name in set(self._names) - judged}
        if jumping and not step.named and self._displacing.loud(fits):
            step, then = self._tried(named, fits, jumping)
            trials = (*step.trials, *(one for one in trials if one.name not in jumping))
        return replace(step, trials=trials), then

    def _tried(
        self, named: tuple[str, ...], fits: Pair, glance: Glance, failed: Sequence[str] = ()
    ) -> tuple[Step, Pair]:
        """Try the best candidates of a glance, which are none of those that have failed."""
        tried: dict[str, tuple[Trial, Pair]] = {}
        for name, (promise, _) in glance.items():
            most = max((trial.total for trial, _ in tried.values()), default=0.0)
            if promise < HOPELESS * most and name not in TRIED:
                continue
            then = self._fitted((*named, name), fits)
            tried[name] = self._trial(name, named, fits, then), then
        ranked = sorted(tried, key=lambda name: -tried[name][0].total)
        trials = tuple(tried[name][0] for name in ranked)
        # A lesser candidate is not confirmed by the failure of a better one, unless that fell to
        # something outside the library, or its own flights contradict each other.
        close = [trial for trial in trials if trials[0].total - trial.total < TIE]
        fell = False
        for trial in trials:
            then = tried[trial.name][1]
            if not trial.accepted or self._impossible((trial.name,), then):
                continue
            if self._trifling(trial.name, then):
                continue
            if failed and not self._elsewhere(trial, fits, then):
                continue
            if not (fell or trial in close or self._lesser(trial, trials, named, fits, failed)):
                continue
            part = QUARTER if failed else HALF
            fell = not self._displacing.stands(trial.name, trial.total, fits, then, part)
            if not fell:
                others = tuple(one.name for one in close if one is not trial and not one.torn)
                tied = (*glance[trial.name][1], *others)
                return Step(trials, tied, trial.name), then
        return Step(trials, (), ''), fits

    def _elsewhere(self, trial: Trial, fits: Pair, then: Pair) -> bool:
        """Tell whether a candidate is sound, and no part of what remains."""
        least, most = sorted((trial.gain, trial.replicated))
        sound = trial.both and least > EVEN * most and trial.apart < AGREED
        return sound and self._displacing.elsewhere(trial.name, fits, then)

    def _lesser(
        self,
        trial: Trial,
        trials: Sequence[Trial],
        named: tuple[str, ...],
        fits: Pair,
        failed: Sequence[str],
    ) -> bool:
        """
        Tell whether a candidate may be named though others win clearly more.

        They have to be about something else, and torn; or, beside what has failed, where it is
        known that something is outside the library, they may be in any trouble, and need not be
        about something else where their own flights do not agree on them.
        """
        above = [one for one in trials if one.total >= trial.total + TIE]
        if failed:
            above = [one for one in above if one.apart < APART]
        elif not (trial.both and all(one.torn for one in above)):
            return False
        if not above:
            return True
        prior = shared(self.knobs, named, self._sizes)
        names = [trial.name, *(one.name for one in above)]
        alike = [np.abs(likeness(this.reduced, prior, names, self.knobs))[0, 1:] for this in fits]
        return bool(np.max(alike) < UNLIKE)

    def _trial(self, name: str, named: tuple[str, ...], fits: Pair, then: Pair) -> Trial:
        """Return what all flights say of a candidate."""
        places, cost = self._places(name), SIZES[self._sizes.get(name, 1.0)]
        return Trial(
            name,
            then[0].evidence - fits[0].evidence - cost,
            then[1].evidence - fits[1].evidence - cost,
            self._carried(then) - self._carried(fits),
            max(apart(then, k) for k in places),
            differ(then, self._names.index(name)),
        )

    def _carried(self, fits: Pair) -> float:
        """Return the evidence of the flights that confirm under what the others have taught."""
        prior = learned(fits[0].fitted)
        return weighed(fits[1].group, prior, fits[1].deviations, self.floor)[1]
