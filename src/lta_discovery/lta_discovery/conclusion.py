"""
Derive the conclusion of a study: the single source of its headline, tiles, advice and files.

A finding holds the measured results. This module alone decides whether they support a name, a gain
or the use of the learned vehicle file, so that no two outputs contradict each other.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
import math
from typing import Final, final, Literal

from lta_discovery.finding import ChannelErrors, StudyResult, Verdict
from lta_discovery.forecast.forecast_warnings import (
    find_worse_forecasts,
    find_worse_than_tolerances,
    should_keep_file,
    WHOLE,
)
from lta_discovery.model.candidates import vector_components
from lta_discovery.selection.candidate_acceptance import GAIN
from lta_model.effects import EFFECTS

Advice = Literal['keep', 'measure', 'again', 'use', 'law', 'refitted']
# A possible effect is one that the readings favour and no forecast needs
Concluded = Literal[
    'none', 'named', 'possible', 'unexplained', 'named+unexplained', 'possible+unexplained',
    'not_identifiable',
]  # fmt: skip

FAR: Final = 3.0  # s; the horizon at which a model has to be better than coasting
LOOSE: Final = 0.7  # of the error before; below it, tuning the tolerances alone is worth reporting
WORSE: Final = 1.05  # of the error before; above it, the learned file should not be used yet
# Channels of the measurement effects that no forecast of the pose shows, by the kind of sensor
SENSORS: Final[Mapping[str, tuple[str, ...]]] = {
    'rates': ('p', 'q', 'r'),
    'force': ('fx', 'fy', 'fz'),
    'range': ('range',),
    'pressure': ('pressure',),
}
CLEARLY: Final = 0.9  # of the error of the other files; below it, the refitted one is advised
ADVICE: Final[Mapping[Advice, str]] = {
    'keep': 'Keep the vehicle file as it is.',
    'measure': 'Measure the parameters in the vehicle file again, and correct them.',
    'again': 'Record another flight before you change the vehicle file.',
    'use': 'Use the corrected vehicle file: vehicle.yaml in the results folder.',
    'law': 'Use the vehicle file with the law, vehicle.yaml in the results folder, within the '
    'region of the law.',
    'refitted': 'To predict flights, use refitted.yaml in the results folder, in its region of '
    'validity.',
}
# Advice with which no law is sought, and the reason
LAWLESS: Final[Mapping[Advice, str]] = {
    'measure': 'the vehicle file has to be corrected first',
    'again': 'another flight has to be recorded first',
}


@final
@dataclass(frozen=True, slots=True)
class Conclusion:
    """What a study supports, and the advice that follows."""

    verdict: Concluded
    # Of the effects that were found. Possible: not said to be missing, and in no file except
    # beside a law, which was fitted with them
    effect_status: Literal['named', 'possible']
    # Parameters that explain the data as well as an effect; the headline names them with "or"
    rivals: tuple[str, ...]
    # Whether a model that ignores the commands predicts the position best, at the longest horizon
    coasting: bool
    advice: Advice  # what to do with the vehicle file, a key of `ADVICE`
    # The improvement to report: the position at the longest horizon, or another error that only
    # the effects reduce. None unless the advice is to act on it.
    gain: ChannelErrors | None
    # Whether the vehicle file explains the flights to within its tolerances and the noise
    fits: bool
    # The position error over some seconds, if the final model does not beat coasting there: then
    # it is no improvement
    useless: ChannelErrors | None = None
    # The position error at the longest horizon, if the file with all numbers refitted forecasts
    # the held-out flights clearly better than any other, position and attitude
    refitted: ChannelErrors | None = None
    # Whether there is a vehicle file with what was learned: the named effects, or a law
    has_learned_file: bool = False

    @property
    def asserted(self) -> bool:
        """Whether the effects are missing: they are named, not only possible."""
        return self.verdict in ('named', 'named+unexplained')

    @property
    def idle(self) -> bool:
        """Whether no forecast needs the effects more than fitted tolerances."""
        return self.verdict in ('possible', 'possible+unexplained')

    @property
    def is_doubtful(self) -> bool:
        """Whether the names or their values are in doubt."""
        doubts = self.rivals, self.useless, self.advice == 'again', self.coasting, self.idle
        return any(map(bool, doubts))


def draw_conclusion(finding: StudyResult) -> Conclusion:
    """Return the conclusion that a finding supports."""
    gap = select_main_error(finding.gaps)
    added = find_added_gain(finding.gaps, [one.name for one in finding.effects])
    advice = _choose_advice(finding)
    idle = bool(finding.effects) and finding.verdict != 'not_identifiable' and added is None
    loose = _tolerances_suffice(gap) and (idle or finding.verdict == 'none')
    if idle and advice == 'use':
        advice = 'measure' if loose else 'again'
    if (idle or advice == 'keep') and has_law(finding) and not find_law_obstacle(finding):
        advice = 'law'
    refitted = find_better_refit(finding)
    unnamed = not finding.effects and finding.verdict != 'not_identifiable'
    if refitted is not None and unnamed and advice != 'law':
        advice = 'refitted'
    rivals = dict.fromkeys(rival for one in finding.effects for rival in one.confusable_with)
    # A law or a refitted file is advised only if it beats coasting
    beaten = advice in ('law', 'refitted')
    useless = None if beaten else find_useless_forecast(finding.gaps)
    # A gain is only reported together with the advice to use it
    gain = added if advice == 'use' else gap if loose and advice == 'measure' else None
    verdict = _conclude_verdict(finding.verdict, idle)
    return Conclusion(
        verdict=verdict,
        effect_status=(
            'possible' if finding.effects and not verdict.startswith('named') else 'named'
        ),
        rivals=tuple(rivals),
        coasting=gap is not None and gap.coast < min(gap.tuned, gap.after),
        advice=advice,
        gain=gain if useless is None else None,
        fits=finding.verdict == 'none'
        and advice == 'keep'
        and useless is None
        and not (finding.strained or find_worse_forecasts(finding.gaps)),
        useless=useless,
        refitted=refitted,
        has_learned_file=verdict.startswith('named') or has_law(finding),
    )


def _conclude_verdict(verdict: Verdict, idle: bool) -> Concluded:
    """Return the verdict of a search, less the names that no forecast needs."""
    if idle and verdict == 'named':
        return 'possible'
    if idle and verdict == 'named+unexplained':
        return 'possible+unexplained'
    return verdict


def find_added_gain(gaps: Sequence[ChannelErrors], effects: Sequence[str]) -> ChannelErrors | None:
    """
    Return an error that named effects reduce beyond what fitting the tolerances does.

    At its longest horizon and beyond its uncertainty: that of the position if there is one, or of
    the attitude, or of the readings of a sensor that a named effect is about.
    """
    kinds = [getattr(EFFECTS.get(effect), 'channel', '') for effect in effects]
    sensors = [channel for kind in kinds for channel in SENSORS.get(kind, ())]
    for channel in (*WHOLE, *sensors):
        own = [gap for gap in gaps if gap.channel == channel]
        gap = max(own, key=lambda one: one.horizon_s, default=None)
        if gap is not None and gap.after < min(gap.before, gap.tuned) and _is_added(gap):
            return gap
    return None


def _is_added(gap: ChannelErrors) -> bool:
    """Return whether the named effects reduce an error beyond its uncertainty."""
    return gap.added_ci95[0] > 0.0 or math.isinf(gap.tuned)


def has_law(finding: StudyResult) -> bool:
    """Return whether a law is proposed."""
    return finding.law is not None and finding.law.law is not None


def find_law_obstacle(finding: StudyResult) -> str:
    """Return why the advice, without a law, rules out a file with one; '' if it does not."""
    if should_keep_file(finding.gaps):
        return 'the fit to these flights predicts worse than the vehicle file'
    return LAWLESS.get(_choose_advice(finding), '')


def find_useless_forecast(gaps: Sequence[ChannelErrors]) -> ChannelErrors | None:
    """Return the position error over some seconds, if coasting is as good as the final model."""
    far = [gap for gap in gaps if gap.channel == 'position' and gap.horizon_s == FAR]
    return far[0] if far and far[0].coast <= far[0].after else None


def find_better_refit(finding: StudyResult) -> ChannelErrors | None:
    """Return the main error, if the refitted file forecasts held-out flights clearly better."""
    gap = select_main_error(finding.gaps)
    if gap is None or not finding.held_out:
        return None
    whole = [
        one for one in finding.gaps
        if one.channel in ('position', 'attitude') and one.horizon_s == gap.horizon_s
    ]  # fmt: skip
    near = [one for one in finding.gaps if one.channel == 'position' and one.horizon_s == FAR]
    if any(not one.refitted < min(one.before, one.coast) for one in near):
        return None
    better = [
        one.refitted < CLEARLY * min(one.before, one.tuned, one.after, one.coast) for one in whole
    ]
    return gap if len(whole) == 2 and all(better) else None


def forget_refit(finding: StudyResult) -> StudyResult:
    """Return a finding without the errors of a refitted model, of which there is no file."""
    gaps = tuple(replace(gap, refitted=math.nan) for gap in finding.gaps)
    return replace(finding, gaps=gaps)


def _choose_advice(finding: StudyResult) -> Advice:
    """Choose the advice on the vehicle file."""
    # Forecasts decide first: a file that predicts better stays, whatever was named.
    if should_keep_file(finding.gaps):
        return 'keep'
    if finding.verdict == 'not_identifiable' or (
        finding.effects and find_worse_than_tolerances(finding.gaps)
    ):
        return 'again'
    if finding.effects:
        gap = select_main_error(finding.gaps)
        worse = gap is not None and gap.after > WORSE * gap.before
        return 'again' if worse or find_useless_forecast(finding.gaps) is not None else 'use'
    gap = select_main_error(finding.gaps)
    if finding.strained or (finding.verdict == 'none' and _tolerances_suffice(gap)):
        return 'measure'
    # Strong evidence without a name means that the training and confirming flights disagree.
    strong = any(rung.total > GAIN for step in finding.ladder for rung in step)
    return 'again' if strong and finding.verdict == 'none' else 'keep'


def _tolerances_suffice(gap: ChannelErrors | None) -> bool:
    """Return whether the tolerances alone remove much of the main error."""
    return gap is not None and gap.tuned < LOOSE * gap.before


def select_main_error(gaps: Sequence[ChannelErrors]) -> ChannelErrors | None:
    """Return the position error at the longest horizon, or another channel's if there is none."""
    finite = [gap for gap in gaps if math.isfinite(gap.before) and math.isfinite(gap.after)]
    # Fall back to other channels if no position is finite
    place = [gap for gap in finite if gap.channel == 'position'] or finite
    return max(place, key=lambda gap: gap.horizon_s, default=None)


def is_still_named(finding: StudyResult, knob: str) -> bool:
    """Return whether a parameter named in one round of the search is in the final result."""
    named = {name for one in finding.effects for name in one.knobs}
    return bool(named & set(vector_components(knob)))
