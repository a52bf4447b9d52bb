# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Search for gains that fly well over a range of helium losses, by CMA-ES.

CMA-ES needs few evaluations and no gradients, and uses only the ranking of the costs, which may be
discontinuous. Each candidate flies the same test flights with the same seeds. Its cost is the
average of the mean and the worst cost. A candidate outside the bounds is flown at the bound, plus
a penalty for the distance.

It works on any nested `Settings` whose fields declare bounds, so all control laws are tuned in the
same way. A parameter is searched on a logarithmic scale, within a factor of its start value and
within its declared bounds.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
import math
from pathlib import Path
from typing import final, TypeVar

from cmaes import CMA
from lta_config.atomic_file import replace_atomically
from lta_config.errors import BadInput, unknown_name_error
from lta_report.study_store import StudyStore
from lta_report.workers import ItemFailure
from lta_studies.tune.compare import CandidateCosts, refuse_failure
import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel
from pydantic.fields import FieldInfo
import yaml

GAIN_ENDINGS = (
    'kp',
    'ki',
    'kd',
    'gain',
)  # how names of gains end; limits and angles are not gains
SEARCH_REACH = 6.0  # a search covers value / 6 to value * 6

Model = TypeVar('Model', bound=BaseModel)


@final
@dataclass(frozen=True, slots=True)
class TunableParameter:
    """One tunable parameter of a settings object."""

    path: str  # dotted path, for example `climb.kp`
    value: float  # current value
    # Declared bounds
    low: float
    high: float
    # Declared description and unit
    about: str = ''
    unit: str = ''

    def search_bounds(self, reach: float = SEARCH_REACH) -> tuple[float, float]:
        """Return the bounds of the search."""
        return max(self.low, self.value / reach), min(self.high, self.value * reach)


def iterate_parameters(settings: BaseModel, above: str = '') -> Iterator[TunableParameter]:
    """Yield every float of a settings object, depth first."""
    for name, field in type(settings).model_fields.items():
        value = getattr(settings, name)
        if isinstance(value, BaseModel):
            yield from iterate_parameters(value, f'{above}{name}.')
        # Integers and switches have no logarithmic scale, so they are not tuned.
        elif isinstance(value, float):
            extra = field.json_schema_extra
            unit = str(extra.get('unit', '')) if isinstance(extra, dict) else ''
            low, high = _declared_bounds(field)
            yield TunableParameter(
                f'{above}{name}', value, low, high, field.description or '', unit
            )


def _declared_bounds(field: FieldInfo) -> tuple[float, float]:
    """Return the declared closed bounds; infinite where none is declared."""
    low, high = -math.inf, math.inf
    # Pydantic stores bounds as annotated-types `Ge` and `Le`; other rules have neither name.
    for rule in field.metadata:
        low, high = getattr(rule, 'ge', low), getattr(rule, 'le', high)
    return low, high


def select_parameters(settings: BaseModel, names: Sequence[str] = ()) -> list[TunableParameter]:
    """
    Return the parameters to search.

    `settings`: start values. `names`: paths; by default all positive parameters whose names end
    like gains. Raise `BadInput` if a name is unknown, or a value is not positive and so has no
    logarithm.
    """
    by_path = {number.path: number for number in iterate_parameters(settings)}
    if not names:
        return [n for n in by_path.values() if n.value > 0.0 and n.path.endswith(GAIN_ENDINGS)]
    for name in names:
        if name not in by_path:
            raise unknown_name_error('number', name, list(by_path))
        if not by_path[name].value > 0.0:
            raise BadInput(
                f'{name} starts at {by_path[name].value:g}, but the search multiplies it by '
                'factors and needs a value above 0; set one in the start gains.'
            )
    # Duplicates removed, order kept: the order defines the axes of the search.
    return [by_path[name] for name in dict.fromkeys(names)]


def replace_parameters(settings: Model, values: Mapping[str, float]) -> Model:
    """Return validated settings with some values replaced."""
    content = settings.model_dump()
    for path, value in values.items():
        *above, last = path.split('.')
        place = content
        for name in above:
            place = place[name]
        place[last] = float(value)
    # Validation also checks rules between fields, which single bounds cannot.
    return type(settings).model_validate(content)


DIGITS = 4  # significant digits; the search is not more precise


def round_gain(value: float) -> float:
    """Round a gain to the digits that are written."""
    return float(f'{value:.{DIGITS}g}')


def format_gains(gains: BaseModel, about: Sequence[str]) -> str:
    """Return the text of a parameter file; the lines in `about` become the comment on top."""
    lines = [f'# {line}' for line in about]
    lines += ['/**/controller:', '  ros__parameters:', '    gains:']
    for name, value in gains.model_dump().items():
        # Flow style puts each loop on one line; the large width prevents a line break.
        text = yaml.safe_dump(value, default_flow_style=True, sort_keys=False, width=1000)
        # For a bare number `safe_dump` adds a second line '...', which is dropped.
        lines.append(f'      {name}: {text.splitlines()[0]}')
    return '\n'.join(lines) + '\n'


def write_gains(gains: BaseModel, about: Sequence[str], path: Path) -> None:
    """Write a parameter file; raise `BadInput` if that fails."""
    try:
        # An interrupt leaves either the old file or the whole new one.
        with replace_atomically(path) as part:
            part.write_text(format_gains(gains, about), encoding='utf-8')
    except OSError as error:
        raise BadInput(
            f"The gains cannot be written to '{path}' ({error.strerror}); choose another --out."
        ) from None


FIRST_SEARCH_STEP = (
    0.35  # of log(gain): the first generation changes gains by a factor of about 1.4
)
OUTSIDE = 0.1  # penalty per squared unit of log(gain) beyond a bound

Numbers = Mapping[str, float]
Fly = Callable[[Numbers], list[float] | ItemFailure]
Vector = NDArray[np.float64]


@final
@dataclass(frozen=True, slots=True)
class GainSearchResult:
    """Result of a gain search."""

    numbers: Numbers  # best parameter values, by path
    # Cost of the best candidate and of the start
    cost: float
    first: float
    history: tuple[float, ...]  # lowest cost so far, after each candidate
    stopped: bool  # whether the search was interrupted


def robust_cost(costs: Sequence[float]) -> float:
    """Return the average of the mean and the worst cost of a candidate's test flights."""
    return 0.5 * (sum(costs) / len(costs) + max(costs))


def search_gains(
    numbers: Sequence[TunableParameter],
    fly: Fly,
    store: StudyStore[CandidateCosts],
    budget: int,
    seed: int,
    tell: Callable[[int, float], None] = lambda count, best: None,
) -> GainSearchResult:
    """
    Search for the best gains within a budget of candidates.

    Parameters
    ----------
    numbers : sequence of TunableParameter
        Parameters to search, with their start values.
    fly : callable
        Returns the cost of each test flight of a candidate, or the failure of one.
    store : StudyStore
        Earlier evaluations; new ones are added.
    budget : int
        Number of candidates, including the start.
    tell : callable
        Progress callback: number of candidates flown, lowest cost so far.

    """
    judge = _CandidateEvaluator(numbers, fly, store, tell)
    stopped = False
    try:
        start = np.log([number.value for number in numbers])
        # The start gains count as the first candidate, so the result is never worse than them.
        judge.evaluate_costs([start])
        search = CMA(start, FIRST_SEARCH_STEP, seed=seed)
        while len(judge.history) < budget:
            # The budget may cut the last generation short
            count = min(search.population_size, budget - len(judge.history))
            points = [search.ask() for _ in range(count)]
            costs = judge.evaluate_costs(points)
            if count == search.population_size:
                search.tell(list(zip(points, costs, strict=True)))
    # Ctrl-C ends the search with the best candidate so far.
    except KeyboardInterrupt:
        stopped = True
        if judge.best is None:
            raise
    assert judge.best is not None
    cost, best = judge.best
    return GainSearchResult(best, cost, judge.history[0], tuple(judge.history), stopped)


@final
class _CandidateEvaluator:
    """Evaluates candidates (logarithms of the parameters) and stores the best."""

    def __init__(
        self,
        numbers: Sequence[TunableParameter],
        fly: Fly,
        store: StudyStore[CandidateCosts],
        tell: Callable[[int, float], None],
    ) -> None:
        self._paths = [number.path for number in numbers]
        self._ends = np.log([number.search_bounds() for number in numbers])
        self._fly, self._store, self._tell = fly, store, tell
        self.best: tuple[float, dict[str, float]] | None = None
        self.history: list[float] = []

    def evaluate_costs(self, points: Sequence[Vector]) -> list[float]:
        """Return the costs of candidates, including penalties for exceeded bounds."""
        inside = [np.clip(point, self._ends[:, 0], self._ends[:, 1]) for point in points]
        values = [dict(zip(self._paths, np.exp(p).tolist(), strict=True)) for p in inside]
        costs = []
        evaluations = _fly_candidates(values, self._fly, self._store)
        for value, cases in zip(values, evaluations, strict=True):
            cost = robust_cost(cases)
            costs.append(cost)
            if self.best is None or cost < self.best[0]:
                self.best = (cost, value)
            self.history.append(self.best[0])
            self._tell(len(self.history), self.best[0])
        # Only the search sees the penalty; history and result hold the flown cost.
        beyond = [float(((a - b) ** 2).sum()) for a, b in zip(points, inside, strict=True)]
        return [cost + OUTSIDE * far for cost, far in zip(costs, beyond, strict=True)]


def _fly_candidates(
    values: Sequence[dict[str, float]], fly: Fly, store: StudyStore[CandidateCosts]
) -> Iterator[list[float]]:
    """Yield the costs of candidates; take them from the store where possible."""
    for value in values:
        numbers = tuple(value.values())
        if numbers not in store:
            costs = fly(value)
            # Stored before the next is flown, so that an interrupt loses one.
            store.add(
                numbers,
                costs if isinstance(costs, ItemFailure) else CandidateCosts(numbers, costs),
            )
        yield refuse_failure(store.failures.get(numbers) or store.results[numbers]).costs
