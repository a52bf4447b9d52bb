"""
What a study concludes, drawn once: headline, tiles, warnings, JSON and commands derive from it.

The finding holds what was measured. Whether that allows a name to be asserted, a gain to be told
or the learned file to be used is decided here and nowhere else, so that no two places of a page
can say it differently.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
import math
from typing import Final, final, Literal

from lta_discovery.finding import DiscoveryFinding, PredictionGap
from lta_discovery.forecast.forecast_warnings import (
    find_vain_gaps,
    find_worse_gaps,
    should_keep_file,
)
from lta_discovery.model.candidates import vector_components
from lta_discovery.selection.acceptance import GAIN

Advice = Literal['keep', 'measure', 'again', 'use']

LOOSE: Final = 0.7  # of the error before; below it tuning tolerances alone is worth a word
WORSE: Final = 1.05  # of the error before; above it what was learned is not to be used yet
CLOSER: Final = 0.95  # of the error with tolerances alone; above it the effect predicts no better
ADVICE: Final[Mapping[Advice, str]] = {
    'keep': 'Keep the vehicle file as it is.',
    'measure': 'Measure the numbers of the vehicle file again, and correct it.',
    'again': 'Fly again before you change the vehicle file.',
    'use': 'Use the vehicle file with what was learned.',
}


@final
@dataclass(frozen=True, slots=True)
class Conclusion:
    """
    What may be said, and what to do.

    Attributes
    ----------
    asserted : bool
        Whether the effects are said to be missing; else they only may be.
    rivals : tuple of str
        Knobs that may be missing in place of an effect: with them it is "X or Y".
    coasting : bool
        Whether a model that ignores the commands predicts the position best.
    advice : str
        What to do with the vehicle file: 'keep' it, 'measure' its numbers again, fly 'again', or
        'use' what was learned. `ADVICE` has the sentences.
    gain : Gap, optional
        What may be told as an improvement: the position furthest ahead. Only where the advice is
        to act on it.
    by_tolerances : bool
        Whether tuning the tolerances of the file alone makes most of that improvement.
    fits : bool
        Whether the vehicle file explains the flights to within its tolerances and the noise.

    """

    asserted: bool
    rivals: tuple[str, ...]
    coasting: bool
    advice: Advice
    gain: PredictionGap | None
    by_tolerances: bool
    fits: bool

    @property
    def is_doubtful(self) -> bool:
        """Whether the names or their values are in doubt."""
        return bool(self.rivals) or self.advice == 'again' or self.coasting


def draw_conclusion(finding: DiscoveryFinding) -> Conclusion:
    """Return what a finding allows to say."""
    gap = select_main_gap(finding.gaps)
    advice, loose = _choose_advice(finding), _tolerances_suffice(finding)
    rivals = dict.fromkeys(rival for one in finding.effects for rival in one.confusable_with)
    better = advice == 'use' and gap is not None and gap.shrink > 0.0
    return Conclusion(
        asserted=bool(finding.effects) and finding.verdict != 'not_identifiable',
        rivals=tuple(rivals),
        coasting=gap is not None and gap.coast < min(gap.tuned, gap.after),
        advice=advice,
        gain=gap if better or (loose and advice == 'measure') else None,
        by_tolerances=gap is not None and gap.after >= CLOSER * gap.tuned,
        fits=finding.verdict == 'none'
        and advice == 'keep'
        and not (finding.strained or find_worse_gaps(finding.gaps)),
    )


def _choose_advice(finding: DiscoveryFinding) -> Advice:
    """Return what to do with the vehicle file."""
    if should_keep_file(finding.gaps):
        return 'keep'
    if finding.verdict == 'not_identifiable' or (finding.effects and find_vain_gaps(finding.gaps)):
        return 'again'
    if finding.effects:
        gap = select_main_gap(finding.gaps)
        return 'again' if gap is not None and gap.after > WORSE * gap.before else 'use'
    if finding.strained or _tolerances_suffice(finding):
        return 'measure'
    strong = any(rung.total > GAIN for step in finding.ladder for rung in step)
    return 'again' if strong and finding.verdict == 'none' else 'keep'


def _tolerances_suffice(finding: DiscoveryFinding) -> bool:
    """Tell whether nothing is missing, but numbers within their tolerances make most errors."""
    gap = select_main_gap(finding.gaps)
    return finding.verdict == 'none' and gap is not None and gap.tuned < LOOSE * gap.before


def select_main_gap(gaps: Sequence[PredictionGap]) -> PredictionGap | None:
    """Return the gap that stands for all: of the position, furthest ahead."""
    finite = [gap for gap in gaps if math.isfinite(gap.before) and math.isfinite(gap.after)]
    place = [gap for gap in finite if gap.channel == 'position'] or finite
    return max(place, key=lambda gap: gap.horizon_s, default=None)


def is_still_named(finding: DiscoveryFinding, knob: str) -> bool:
    """Tell whether what a round of the ladder named is still named at the end."""
    told = {name for one in finding.effects for name in one.knobs}
    return bool(told & set(vector_components(knob)))
