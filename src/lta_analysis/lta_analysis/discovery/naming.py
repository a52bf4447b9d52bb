"""
Name what is missing, one effect at a time, until no candidate is confirmed.

A glance at all candidates (`scan`) can promise what a refit does not keep, and large unexplained
forces can hide an effect; so the best few are refitted, on each flight by itself, and only that
counts.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, final

from lta_analysis.discovery.accept import TIE, Trial
from lta_analysis.discovery.evidence import FLOOR, learned, tolerances
from lta_analysis.discovery.fit import Fit, fit, settled
from lta_analysis.discovery.linear import origin
from lta_analysis.discovery.linearise import Linearised
from lta_analysis.discovery.nominal import Nominal
from lta_analysis.discovery.scan import likeness, scan
from lta_analysis.discovery.starts import begun
import numpy as np

QUICK: Final = 5  # of each glance
REFITTED: Final = 4
CAP: Final = 1.5  # floors; of the deviations in the second glance
MOST: Final = 4  # effects
WORTH: Final = 1.0  # nats; a glance below it is not followed
ALIKE: Final = 0.98  # of the cosine of two columns; beyond it one refit stands for both


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
    fits : tuple of Fit
        Of the two flights, with them.

    """

    steps: tuple[Step, ...]
    names: tuple[str, ...]
    fits: tuple[Fit, Fit]


@final
class Naming:
    """
    Two flights of one vehicle.

    Parameters
    ----------
    nominal : Nominal
        The vehicle as its file has it.
    flights : pair of Linearised
        To learn from, and to confirm by.

    """

    def __init__(self, nominal: Nominal, flights: tuple[Linearised, Linearised]) -> None:
        self.nominal, self.flights = nominal, flights
        self.knobs = flights[0].knobs
        self._names = [knob.name for knob in self.knobs]

    def run(self) -> Named:
        """Name what is missing."""
        named: tuple[str, ...] = ()
        fits = self._fitted(named, None)
        steps = []
        while len(named) < MOST:
            step, then = self._round(named, fits)
            steps.append(step)
            if not step.named:
                break
            named, fits = (*named, step.named), then
        return Named(tuple(steps), named, fits)

    def _fitted(self, named: Sequence[str], before: tuple[Fit, Fit] | None) -> tuple[Fit, Fit]:
        """Fit both flights with some effects, from where they stand."""
        prior = tolerances(self.knobs, named)
        out = []
        for k, flight in enumerate(self.flights):
            if before is None:
                begin = origin(self.nominal, self.knobs, len(flight.replay.first))
                out.append(fit(flight, self.nominal, prior, begin))
            else:
                last = before[k]
                deviations = np.minimum(last.deviations, 2.5 * FLOOR)
                begin = begun(flight, prior, last.linear.point, deviations, named)
                out.append(fit(flight, self.nominal, prior, begin, deviations))
        return out[0], out[1]

    def _glance(self, named: Sequence[str], fits: tuple[Fit, Fit]) -> dict[str, tuple[str, ...]]:
        """Return the few candidates that are worth a refit, each with those that look like it."""
        prior = tolerances(self.knobs, named)
        found: dict[str, float] = {}
        for this in fits:
            at = this.linear.point.values
            capped = this.pieces.reduced(np.minimum(this.deviations, CAP * FLOOR))
            for reduced in (this.reduced, capped):
                seen = [s for s in scan(reduced, at, prior, self.knobs) if s.name not in named]
                for one in seen[:QUICK]:
                    if one.gain > WORTH:
                        found.setdefault(one.name, 0.0)
        for name in found:
            found[name] = sum(self._promised(name, named, this) for this in fits)
        ranked = sorted(found, key=lambda name: -found[name])
        return self._distinct([name for name in ranked if found[name] > WORTH], named, fits)

    def _distinct(
        self, ranked: list[str], named: Sequence[str], fits: tuple[Fit, Fit]
    ) -> dict[str, tuple[str, ...]]:
        """Return the first few candidates that neither flight takes for each other."""
        prior = tolerances(self.knobs, named)
        alike = np.min(
            [np.abs(likeness(this.reduced, prior, ranked, self.knobs)) for this in fits], axis=0
        )
        out: dict[str, tuple[str, ...]] = {}
        for i, name in enumerate(ranked):
            same = [other for other in out if alike[i, ranked.index(other)] > ALIKE]
            if same:
                out[same[0]] = (*out[same[0]], name)
            elif len(out) < REFITTED:
                out[name] = ()
        return out

    def _promised(self, name: str, named: Sequence[str], this: Fit) -> float:
        """Return what a candidate wins with the deviations free, without relinearising."""
        prior = tolerances(self.knobs, (*named, name))
        return settled(this.pieces, prior, this.deviations)[3] - this.evidence

    def _round(
        self, named: tuple[str, ...], fits: tuple[Fit, Fit]
    ) -> tuple[Step, tuple[Fit, Fit]]:
        """Try the best candidates."""
        tried, glance = {}, self._glance(named, fits)
        for name in glance:
            then = self._fitted((*named, name), fits)
            tried[name] = self._trial(name, named, fits, then), then
        ranked = sorted(tried, key=lambda name: -tried[name][0].total)
        trials = tuple(tried[name][0] for name in ranked)
        # A lesser candidate is not confirmed by the failure of a better one.
        close = [trial for trial in trials if trials[0].total - trial.total < TIE]
        for trial in close:
            if trial.accepted:
                others = tuple(other.name for other in close if other is not trial)
                tied = (*glance[trial.name], *others)
                return Step(trials, tied, trial.name), tried[trial.name][1]
        return Step(trials, (), ''), fits

    def _trial(
        self, name: str, named: tuple[str, ...], fits: tuple[Fit, Fit], then: tuple[Fit, Fit]
    ) -> Trial:
        """Return what both flights say of a candidate."""
        k = self._names.index(name)
        knob, values = self.knobs[k], [float(this.fitted.mean[k]) for this in then]
        spread = sum(float(this.fitted.covariance[k, k]) for this in then)
        spread += 2.0 * knob.tolerance**2 if knob.per_flight else 0.0
        differ, larger = abs(values[0] - values[1]), max(map(abs, values))
        held_out = self._carried((*named, name), then) - self._carried(named, fits)
        return Trial(
            name,
            then[0].evidence - fits[0].evidence,
            then[1].evidence - fits[1].evidence,
            held_out,
            float(differ / np.sqrt(spread)),
            differ / larger if larger > 0.0 else 0.0,
        )

    def _carried(self, named: tuple[str, ...], fits: tuple[Fit, Fit]) -> float:
        """Return the evidence of the second flight under what the first has taught."""
        prior = learned(fits[0].fitted, self.knobs, named)
        return settled(fits[1].pieces, prior, fits[1].deviations)[3]
