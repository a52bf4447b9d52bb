"""Score one case: compare the finding with the answer."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Final, final

from lta_challenge.effect_injection import effect_of
from lta_challenge.other.unlisted import UNLISTED
from lta_challenge.outside import STRANGE
from lta_challenge.rows import find_challenge_row, Kind, parse_case_kind
from lta_discovery.model.candidates import expand_vectors
from lta_discovery.selection.equivalence_classes import load_class_map

FAR: Final = 3.0  # s; forecast horizon at which a model is compared with the oracle


@final
@dataclass(frozen=True, slots=True)
class ParameterInterval:
    """An estimated parameter with its true value."""

    name: str  # EFFECT.PARAMETER
    # True value, value of the vehicle file, and estimate
    true: float
    nominal: float
    value: float
    ci95: tuple[float, float]  # reported 95 % interval

    @property
    def covers(self) -> bool:
        """Whether the truth is in the interval."""
        return self.ci95[0] <= self.true <= self.ci95[1]

    @property
    def error(self) -> float:
        """Error of the estimate, relative to the change from the vehicle file to the truth."""
        apart = abs(self.true - self.nominal)
        return abs(self.value - self.true) / apart if apart > 0.0 else float('inf')


@final
@dataclass(frozen=True, slots=True)
class ScoredCase:
    """The score of one case."""

    # Identification of the case
    number: int
    kind: Kind
    row: str
    # Hidden and named parameters
    hidden: tuple[str, ...]
    named: tuple[str, ...]
    # Hidden but not named, and named but not hidden; indistinguishable ones count as one
    missed: tuple[str, ...]
    wrong: tuple[str, ...]
    outside: str  # hidden kind outside the library, or ''
    floors: float  # its strength in the flights that discovery learns from, in noise floors
    verdict: str  # verdict of the study
    refused: str  # reason why there is no result, or ''
    sigma: Mapping[str, float]  # strength of each hidden parameter in standard deviations
    intervals: tuple[ParameterInterval, ...]  # parameters of the correctly named effects
    # Position errors at the horizon: before, tuned, after, oracle, coast, noise [m]
    errors: Mapping[str, float]
    seconds: float  # processor time of the study [s]
    promised: tuple[str, ...] = ()  # missed parameters that exceed the reported detection limit
    contradictions: tuple[str, ...] = ()  # contradictions between the outputs of the study
    # Size of the largest force that was reported as unexplained, in noise floors; 0 if none
    remainder: float = 0.0
    traceback: str = ''  # of a study that ended with one, or ''
    # Errors 'tuned' and 'after' on the flights of the fit, by those of the vehicle file: the
    # larger ratio of position and attitude
    training: Mapping[str, float] = field(default_factory=dict)
    # Whether a law is proposed; None where none was sought
    law: bool | None = None
    # Errors at the horizon by those of an oracle that knows the equation outside the library: the
    # larger ratio of position and attitude. 'before' of the vehicle file, 'tuned' without a law,
    # 'law' with the law if one is proposed
    oracle_ratios: Mapping[str, float] = field(default_factory=dict)

    @property
    def flagged(self) -> bool:
        """Whether the verdict reports an unexplained force."""
        return 'unexplained' in self.verdict

    @property
    def late(self) -> bool:
        """Whether the kind outside the library was written independently of discovery."""
        return self.outside in UNLISTED or (self.outside in STRANGE and STRANGE[self.outside].late)

    @property
    def exact(self) -> bool:
        """Whether all hidden effects were named, and nothing else."""
        return not self.missed and not self.wrong and bool(self.hidden)

    @property
    def weakest(self) -> float:
        """Strength of the weakest hidden effect; 0 if unknown."""
        return min((self.sigma.get(name, 0.0) for name in self.hidden), default=0.0)

    @property
    def outcome(self) -> str:
        """One word: 'exact', 'part', 'wrong', 'silent' or 'refused'."""
        if self.refused:
            return 'refused'
        # A wrong name outweighs correct ones
        if self.wrong:
            return 'wrong'
        if self.hidden and not self.missed:
            return 'exact'
        return 'part' if self.named else 'silent'


def score_case(number: int, answer: Mapping[str, Any], result: Mapping[str, Any]) -> ScoredCase:
    """
    Score one case.

    `answer`, `result`: answer of the case, and result of `trial.run_trial`.
    """
    one = load_class_map(find_challenge_row(answer['row']).data)

    def name_of(knob: str) -> str:
        # Parameters that the data cannot distinguish share the name of their class
        return one.get(knob, knob)

    hidden = tuple(each['knob'] for each in answer['hidden'])
    named = tuple(knob for effect in result['effects'] for knob in effect['knobs'])
    true = {name_of(knob) for knob in hidden}
    named_classes = {name_of(knob) for knob in named}
    # A vector that was found may have a further component: every vehicle deviates in both
    beside = expand_vectors({*hidden} & {*named})
    oracle = result.get('oracle', {})
    missed = tuple(knob for knob in hidden if name_of(knob) not in named_classes)
    return ScoredCase(
        number,
        parse_case_kind(answer['kind']),
        answer['row'],
        hidden,
        named,
        missed,
        tuple(knob for knob in named if name_of(knob) not in true and knob not in beside),
        answer['outside'],
        # Challenges of earlier versions have the strength in the training flight only
        float(answer.get('size', answer['floors'])),
        result['verdict'],
        result['refused'],
        oracle.get('sigma', {}),
        _collect_intervals(answer, result, hidden),
        _collect_position_errors(result.get('gaps', []), oracle.get('gaps', [])),
        float(result['cpu_s']),
        _find_detectable_misses(answer, result, missed),
        tuple(result.get('contradictions', ())),
        max((float(one['floors']) for one in result.get('remains', ())), default=0.0),
        result.get('traceback', ''),
        _compare_training_errors(result.get('training', [])),
        None if result.get('law') is None else bool(result['law']['proposed']),
        _compare_with_law_oracle(result),
    )


def _compare_with_law_oracle(result: Mapping[str, Any]) -> dict[str, float]:
    """Return the errors of each model by those of the oracle that knows the equation."""
    oracle = result.get('oracle', {}).get('law', [])
    best = {one['channel']: one['after'] for one in oracle if one['horizon_s'] == FAR}
    if not best:
        return {}
    law = result.get('law') or {}
    own = law['errors'] if law.get('proposed') else oracle
    with_law = 'after' if law.get('proposed') else 'tuned'

    def largest_ratio(errors: list[Mapping[str, Any]], model: str) -> float:
        far = [one for one in errors if one['horizon_s'] == FAR]
        return max(float(one[model]) / float(best[one['channel']]) for one in far)

    return {
        'before': largest_ratio(oracle, 'before'),
        'tuned': largest_ratio(oracle, 'tuned'),
        'law': largest_ratio(own, with_law),
    }


def _compare_training_errors(errors: list[Mapping[str, Any]]) -> dict[str, float]:
    """Return the errors on the flights of the fit, by those of the vehicle file."""
    near = [one for one in errors if one['horizon_s'] <= FAR]
    longest = {one['channel']: max(e['horizon_s'] for e in near if e['channel'] == one['channel'])
               for one in near}  # fmt: skip
    last = [one for one in near if one['horizon_s'] == longest[one['channel']]]
    return {
        model: max(float(one[model]) / float(one['before']) for one in last)
        for model in ('tuned', 'after')
        if last
    }


def _find_detectable_misses(
    answer: Mapping[str, Any], result: Mapping[str, Any], missed: tuple[str, ...]
) -> tuple[str, ...]:
    """Return the missed parameters that exceed the reported detection limit."""
    size = {each['knob']: abs(float(each['value'])) for each in answer['hidden']}
    least = result.get('detectable', {})
    # Parameters without a reported limit are not counted as detectable
    return tuple(knob for knob in missed if size[knob] >= least.get(knob, float('inf')))


def _collect_intervals(
    answer: Mapping[str, Any], result: Mapping[str, Any], hidden: tuple[str, ...]
) -> tuple[ParameterInterval, ...]:
    """Return the parameters of the correctly named effects."""
    out, true_values = [], answer['nominal']['given']
    for effect in result['effects']:
        # Parameters of this effect that were hidden and named
        moved = {knob.partition('.')[2] for knob in effect['knobs'] if knob in hidden}
        # A name without a dot, such as motor_lag, stands for all parameters of the effect
        whole = any(knob in hidden and '.' not in knob for knob in effect['knobs'])
        for each in effect['parameters']:
            if each['name'] in moved or whole:
                true = true_values.get(effect['name'], {}).get(each['name'])
                if true is not None:
                    name = f'{effect["name"]}.{each["name"]}'
                    low, high = each['ci95']
                    out.append(
                        ParameterInterval(name, true, each['before'], each['value'], (low, high))
                    )
    return tuple(out)


def _collect_position_errors(
    gaps: list[Mapping[str, Any]], oracle: list[Mapping[str, Any]]
) -> dict[str, float]:
    """Return the position errors at the horizon, by model."""

    def select_horizon(some: list[Mapping[str, Any]]) -> Mapping[str, Any]:
        fits = [g for g in some if g['channel'] == 'position' and g['horizon_s'] == FAR]
        return fits[0] if fits else {}

    own, best = select_horizon(gaps), select_horizon(oracle)
    out = {name: float(own[name]) for name in ('before', 'tuned', 'after', 'coast') if own}
    if own:
        out['noise'] = float(own['noise_floor'])
    if best:
        out['oracle'] = float(best['after'])
    return out


def confusion_cell(one: ScoredCase) -> tuple[str, str]:
    """Return the cell of a case in the confusion matrix: hidden and named effect."""
    hidden = effect_of(one.hidden[0]) if one.hidden else one.outside or 'nothing'
    if one.refused:
        return hidden, 'no answer'
    if one.wrong:
        return hidden, effect_of(one.wrong[0])
    if one.named:
        return hidden, effect_of(one.hidden[0])
    return hidden, 'unexplained' if one.flagged else 'nothing'
