# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The flights of a sweep: their number, their parameters, and the check that they can be flown.

Flight k is always the same: its grid point, its sample and its seed follow from k.
"""

from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
import hashlib
import json
import math
from pathlib import Path
from typing import Any, final
import zlib

from lta_config.errors import BadInput
from lta_config.parameter_override import format_value, parse_quantity, parse_value
from lta_config.python_file import is_strategy_file
from lta_config.quantity import Quantity, SI_UNITS
from lta_config.schema.sweep_file import (
    CASE_COLUMN,
    Distribution,
    NormalDistribution,
    SweepFile,
    UniformDistribution,
)
from lta_flight.flight_spec import build_loop, FlightSpec, load_spec, SPEC_FILES
import numpy as np
from numpy.random import Generator

MOST_FLIGHTS = 10_000_000  # flights; the table of more does not fit into memory
MOST_TRACKED_FLIGHTS = 12  # flights whose motion is stored for the 3-D view


@final
@dataclass(frozen=True, slots=True)
class SweepJob:
    """One flight of a sweep."""

    # Position in the sweep, and seed
    index: int
    seed: int
    # Varied parameters by path, and the name of the case if there are cases
    values: Mapping[str, Any]
    case: Mapping[str, Any] = field(default_factory=dict)  # parameters that the case sets, by path
    tracked: bool = False  # whether its motion is stored for the 3-D view

    @property
    def changes(self) -> dict[str, Any]:
        """All parameters that differ from the base, by path."""
        varied = {path: value for path, value in self.values.items() if path != CASE_COLUMN}
        return {**self.case, **varied}


@final
class SweepPlan:
    """
    All flights of a sweep.

    Raise `BadInput` if a file cannot be read, a path does not exist or a value is invalid.
    """

    def __init__(self, file: SweepFile) -> None:
        self.file = file
        read = load_spec(file.vehicle, file.scenario, file.strategy, file.gains)
        # Settings hold for all flights, so they are part of the base
        fixed = {path: parse_value(value, path) for path, value in file.settings.items()}
        self.base: FlightSpec = read.with_values(fixed)
        # The name of the case is a column like a varied parameter
        named = {CASE_COLUMN: ''} if file.cases else {}
        varied = {path: self.base.find_unit(path) or self._find_unit(path) for path in file.vary}
        self.units = named | varied
        self.cases = {
            name: {path: parse_value(value, path) for path, value in case.items()}
            for name, case in file.cases.items()
        }
        lists = {
            path: [parse_value(value, path) for value in how]
            for path, how in file.vary.items()
            if isinstance(how, list)
        }
        self.lists = ({CASE_COLUMN: list(self.cases)} if named else {}) | lists
        # Grids multiply, so a few long lists are enough to exceed the limit
        if self.count > MOST_FLIGHTS:
            raise BadInput(
                f'The sweep has {self.count} flights, but at most {MOST_FLIGHTS} are '
                f'allowed; vary fewer '
                'parameters, or give fewer values.'
            )

    @property
    def count(self) -> int:
        """Return the number of flights."""
        # Distributions do not multiply the grid; they are drawn at each of its points
        return math.prod(map(len, self.lists.values())) * self.file.draws_per_point

    @cached_property
    def identity(self) -> str:
        """Hash of everything that determines the flights."""
        content = {
            'strategy': self.base.strategy,
            **self._read_strategy_files(),
            'contents': self.base.contents,
            'named': self._collect_file_contents(),
            # The description may change without making old flights invalid
            'sweep': self.file.model_dump(exclude={'about'}),
        }
        # Sorted keys, so that the order in a file does not matter
        text = json.dumps(content, sort_keys=True, default=str)
        return hashlib.sha256(text.encode()).hexdigest()

    def _collect_file_contents(self) -> dict[str, Any]:
        """Return the contents of files that are varied as a whole."""
        return {
            f'{path} {name}': self.base.with_values({path: name}).contents[path]
            for path, name in sorted(self._list_names(SPEC_FILES))
        }

    def _read_strategy_files(self) -> dict[str, str]:
        """Return the texts of strategies that are files."""
        names = {self.base.strategy, *(name for _, name in self._list_names(('strategy',)))}
        return {
            name: Path(name).read_text(encoding='utf-8')
            for name in sorted(filter(is_strategy_file, names))
        }

    def _list_names(self, paths: Collection[str]) -> set[tuple[str, Any]]:
        """Return path and name of everything that is varied as a whole."""
        ways = self.file.vary.items()
        choices = {path: how.choice or [] for path, how in ways if isinstance(how, Distribution)}
        varied = self.lists | choices
        single = [{path: value} for path in paths for value in varied.get(path, ())]
        assignments = [*self.cases.values(), *single]
        return {(path, values[path]) for values in assignments for path in paths if path in values}

    def build_job(self, index: int) -> SweepJob:
        """Return one flight by index; the samples or seeds of a grid point are consecutive."""
        # `turn` selects the sample and the seed within a grid point
        point, turn = divmod(index, self.file.draws_per_point)
        values = {}
        # A mixed-radix number: the last list varies fastest
        for path in reversed(self.units):
            how = self.file.vary.get(path)
            if isinstance(how, Distribution):
                values[path] = sample_parameter(how, path, self.file.seeds.first, turn)
            else:
                point, place = divmod(point, len(self.lists[path]))
                values[path] = self.lists[path][place]
        ordered = {path: values[path] for path in self.units}
        case = self.cases[ordered[CASE_COLUMN]] if self.cases else {}
        # Flights at even distances come from all parts of the grid
        tracked = index % math.ceil(self.count / MOST_TRACKED_FLIGHTS) == 0
        return SweepJob(index, self.file.seeds.first + turn, ordered, case, tracked)

    def iterate_jobs(self, done: set[int]) -> Iterator[SweepJob]:
        """Yield the flights that have not been flown yet."""
        for index in range(self.count):
            if index not in done:
                yield self.build_job(index)

    def check(self, build: Callable[[FlightSpec, int], object] = build_loop) -> None:
        """
        Build a flight for each value separately, and for the extremes of each distribution.

        Values that are valid separately can still be invalid together; such a flight fails on its
        own.

        Raise `BadInput` if one cannot be built; nothing has been flown then.
        """
        build(self.base, self.file.seeds.first)
        for name, case in self.cases.items():
            self._check_values(build, case, f'In the case {name}')
        for path in self.file.vary:
            for value in self._select_check_values(path):
                self._check_values(build, {path: value}, f'With {path} at {format_value(value)}')

    def _check_values(
        self, build: Callable[[FlightSpec, int], object], values: Mapping[str, Any], where: str
    ) -> None:
        try:
            build(self.base.with_values(values), self.file.seeds.first)
        except BadInput as error:
            raise BadInput(f'{where}: {error}') from None

    def _select_check_values(self, path: str) -> list[Any]:
        how = self.file.vary[path]
        # Every value of a list is built
        if not isinstance(how, Distribution):
            return list(self.lists[path])
        if how.choice is not None:
            return [parse_value(value, path) for value in how.choice]
        samples = [
            sample_parameter(how, path, self.file.seeds.first, k)
            for k in range(self.file.draws_per_point)
        ]
        numbers = [convert_to_si(value) for value in samples]
        # The least and the greatest number that will really be drawn
        return [samples[numbers.index(end(numbers))] for end in (min, max)]

    def _find_unit(self, path: str) -> str:
        """Return the SI unit of a parameter that the files omit."""
        how = self.file.vary[path]
        values = how if isinstance(how, list) else list(iterate_distribution_values(how))
        quantity = parse_quantity(parse_value(values[0], path))
        return '' if quantity is None else SI_UNITS.get(quantity['unit'], ('',))[0]


def iterate_distribution_values(how: Distribution) -> Iterator[Any]:
    """Yield the values that define a distribution."""
    for name in type(how).model_fields:
        kind = getattr(how, name)
        if isinstance(kind, list):
            yield from kind
        elif kind is not None:
            yield from (getattr(kind, field) for field in type(kind).model_fields)


def convert_to_si(value: Any) -> Any:
    """Return a value as in the table: numbers in SI, anything else unchanged."""
    quantity = parse_quantity(value)
    if quantity is None:
        return value
    numbers = Quantity.model_validate(quantity)
    return list(numbers.vector) if isinstance(numbers.value, tuple) else numbers.si


NORMAL_TRIES = 10_000  # draws of a bounded normal distribution before it is an error


def sample_parameter(how: Distribution, path: str, seed: int, sample: int) -> Any:
    """
    Return the value of one parameter in one sample, as a file would hold it.

    `path`: path of the parameter. `seed`: seed of the sweep. `sample`: index of the sample. Raise
    `BadInput` if the distribution is invalid.
    """
    # CRC-32, because Python's own hash of a text differs between processes
    chance = np.random.default_rng([seed, zlib.crc32(path.encode()), sample])
    if how.choice is not None:
        return parse_value(how.choice[int(chance.integers(len(how.choice)))], path)
    if how.normal is not None:
        return _draw_normal(how.normal, path, chance)
    if how.uniform is not None:
        low, high, unit = _parse_bounds(how.uniform, path)
        return _build_quantity(float(chance.uniform(low, high)), unit)
    if how.loguniform is None:
        raise BadInput(f'{path} has no distribution; give uniform, loguniform, normal or choice.')
    low, high, unit = _parse_bounds(how.loguniform, path)
    if low <= 0.0:
        raise BadInput(
            f'{path} has a loguniform distribution from {low:g} {unit}; low must be above 0.'
        )
    # Uniform in the logarithm
    return _build_quantity(float(np.exp(chance.uniform(np.log(low), np.log(high)))), unit)


def _draw_normal(how: NormalDistribution, path: str, chance: Generator) -> Any:
    numbers = [how.mean, how.deviation, how.low, how.high]
    (mean, deviation, low, high), unit = _convert_to_common_unit(numbers, path)
    if mean is None or deviation is None or deviation < 0.0:
        raise BadInput(
            f'{path} has the standard deviation {format_value(how.deviation)}; it must be at '
            'least 0.'
        )
    for _ in range(NORMAL_TRIES):
        sample = float(chance.normal(mean, deviation))
        if (low is None or sample >= low) and (high is None or sample <= high):
            return _build_quantity(sample, unit)
    raise BadInput(
        f'The normal distribution of {path} gives almost no values between low and high; change '
        'mean, low or high.'
    )


def _parse_bounds(how: UniformDistribution, path: str) -> tuple[float, float, str]:
    (low, high), unit = _convert_to_common_unit([how.low, how.high], path)
    if low is None or high is None or not low < high:
        raise BadInput(
            f'{path} is drawn from {format_value(how.low)} to {format_value(how.high)}; low must '
            'be below high.'
        )
    return low, high, unit


def _convert_to_common_unit(items: list[Any], path: str) -> tuple[list[float | None], str]:
    """Return numbers in the unit of the first, and that unit; '' for plain numbers."""
    values = [None if item is None else parse_value(item, path) for item in items]
    first = parse_quantity(values[0])
    unit = '' if first is None else str(first['unit'])
    if unit and unit not in SI_UNITS:
        raise BadInput(f'{path} has the unknown unit "{unit}"; known: {", ".join(SI_UNITS)}.')
    return [
        None if value is None else _convert_number(value, unit, path) for value in values
    ], unit


def _convert_number(value: Any, unit: str, path: str) -> float:
    quantity = parse_quantity(value)
    number = value if quantity is None else quantity['value']
    plain = isinstance(number, int | float) and not isinstance(number, bool)
    if not plain or (quantity is None) != (unit == ''):
        raise BadInput(
            f'{path} has {format_value(value)} in its distribution; give all numbers '
            'either with or without a unit.'
        )
    # No conversion, to avoid a rounding error
    if quantity is None or quantity['unit'] == unit:
        return float(number)
    if quantity['unit'] not in SI_UNITS or SI_UNITS[quantity['unit']][0] != SI_UNITS[unit][0]:
        raise BadInput(f'{path} mixes {unit} and {quantity["unit"]}; use compatible units.')
    return float(number) * SI_UNITS[quantity['unit']][1] / SI_UNITS[unit][1]


def _build_quantity(number: float, unit: str) -> Any:
    return {'value': number, 'unit': unit} if unit else number
