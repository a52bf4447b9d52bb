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

from lta_discovery.finding import Finding, Gap
from lta_discovery.forecast.cautions import in_vain, keeps, worse
from lta_discovery.model.candidates import components
from lta_discovery.naming.accept import GAIN

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
    gain: Gap | None
    by_tolerances: bool
    fits: bool

    @property
    def doubtful(self) -> bool:
        """Whether the names or their values are in doubt."""
        return bool(self.rivals) or self.advice == 'again' or self.coasting


def draw_conclusion(found: Finding) -> Conclusion:
    """Return what a finding allows to say."""
    gap = main_gap(found.gaps)
    advice, loose = _choose_advice(found), _tolerances_suffice(found)
    rivals = dict.fromkeys(rival for one in found.effects for rival in one.confusable_with)
    better = advice == 'use' and gap is not None and gap.shrink > 0.0
    return Conclusion(
        asserted=bool(found.effects) and found.verdict != 'not_identifiable',
        rivals=tuple(rivals),
        coasting=gap is not None and gap.coast < min(gap.tuned, gap.after),
        advice=advice,
        gain=gap if better or (loose and advice == 'measure') else None,
        by_tolerances=gap is not None and gap.after >= CLOSER * gap.tuned,
        fits=found.verdict == 'none'
        and advice == 'keep'
        and not (found.strained or worse(found.gaps)),
    )


def _choose_advice(found: Finding) -> Advice:
    """Return what to do with the vehicle file."""
    if keeps(found.gaps):
        return 'keep'
    if found.verdict == 'not_identifiable' or (found.effects and in_vain(found.gaps)):
        return 'again'
    if found.effects:
        gap = main_gap(found.gaps)
        return 'again' if gap is not None and gap.after > WORSE * gap.before else 'use'
    if found.strained or _tolerances_suffice(found):
        return 'measure'
    strong = any(rung.total > GAIN for step in found.ladder for rung in step)
    return 'again' if strong and found.verdict == 'none' else 'keep'


def _tolerances_suffice(found: Finding) -> bool:
    """Tell whether nothing is missing, but numbers within their tolerances make most errors."""
    gap = main_gap(found.gaps)
    return found.verdict == 'none' and gap is not None and gap.tuned < LOOSE * gap.before


def main_gap(gaps: Sequence[Gap]) -> Gap | None:
    """Return the gap that stands for all: of the position, furthest ahead."""
    finite = [gap for gap in gaps if math.isfinite(gap.before) and math.isfinite(gap.after)]
    place = [gap for gap in finite if gap.channel == 'position'] or finite
    return max(place, key=lambda gap: gap.horizon_s, default=None)


def is_still_named(found: Finding, knob: str) -> bool:
    """Tell whether what a round of the ladder named is still named at the end."""
    told = {name for one in found.effects for name in one.knobs}
    return bool(told & set(components(knob)))
