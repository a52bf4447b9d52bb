"""
A sweep's flights: which there are, what each is made of, and that all can be flown.

Flight k of a sweep is always the same flight: its point in the grid, its sample and its seed
follow from k alone.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
import hashlib
import json
import math
from typing import Any, final

from lta_config.errors import BadInput
from lta_config.parameter_override import format_value, parse_quantity, parse_value
from lta_config.quantity import Quantity, UNITS
from lta_config.schema.sweep_file import CASE, Distribution, SweepFile
from lta_flight.flight_spec import build_loop, FILES, FlightSpec, load_spec
from lta_flight.sweep.sampling import draw_value

MOST = 10_000_000  # flights; more do not fit a table that one machine reads


@final
@dataclass(frozen=True, slots=True)
class SweepJob:
    """
    One flight of a sweep.

    Attributes
    ----------
    index, seed : int
        Its place in the sweep, and its seed.
    values : mapping
        What is varied, by path; the name of its case, where there are cases.
    case : mapping
        What its case sets, by path.

    """

    index: int
    seed: int
    values: Mapping[str, Any]
    case: Mapping[str, Any] = field(default_factory=dict)

    @property
    def changes(self) -> dict[str, Any]:
        """What the flight changes of what all have in common, by path."""
        varied = {path: value for path, value in self.values.items() if path != CASE}
        return {**self.case, **varied}


@final
class SweepPlan:
    """
    All flights of a sweep.

    Parameters
    ----------
    file : SweepFile
        What is varied how.

    Raises
    ------
    BadInput
        If a file cannot be read, a path leads nowhere or a value does not fit.

    """

    def __init__(self, file: SweepFile) -> None:
        self.file = file
        read = load_spec(file.vehicle, file.scenario, file.strategy, file.gains)
        fixed = {path: parse_value(value, path) for path, value in file.settings.items()}
        self.base: FlightSpec = read.with_values(fixed)
        named = {CASE: ''} if file.cases else {}
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
        self.lists = ({CASE: list(self.cases)} if named else {}) | lists
        if self.count > MOST:
            raise BadInput(f'The sweep has {self.count} flights; at most {MOST} can be flown.')

    @property
    def count(self) -> int:
        """How many flights there are."""
        return math.prod(map(len, self.lists.values())) * self.file.draws_per_point

    @cached_property
    def identity(self) -> str:
        """Hash of all that decides the flights."""
        content = {
            'strategy': self.base.strategy,
            'contents': self.base.contents,
            'named': self._collect_file_contents(),
            'sweep': self.file.model_dump(exclude={'about'}),
        }
        text = json.dumps(content, sort_keys=True, default=str)
        return hashlib.sha256(text.encode()).hexdigest()

    def _collect_file_contents(self) -> dict[str, Any]:
        """Return what the files hold that are varied as a whole."""
        ways = self.file.vary.items()
        drawn = {path: how.choice or [] for path, how in ways if isinstance(how, Distribution)}
        single = [{path: value} for path in FILES for value in (self.lists | drawn).get(path, ())]
        given = [*self.cases.values(), *single]
        whole = {(path, values[path]) for values in given for path in FILES if path in values}
        return {
            f'{path} {name}': self.base.with_values({path: name}).contents[path]
            for path, name in sorted(whole)
        }

    def build_job(self, index: int) -> SweepJob:
        """Return one flight, from 0; the samples or seeds of a grid point follow each other."""
        point, turn = divmod(index, self.file.draws_per_point)
        values = {}
        for path in reversed(self.units):
            how = self.file.vary.get(path)
            if isinstance(how, Distribution):
                values[path] = draw_value(how, path, self.file.seeds.first, turn)
            else:
                point, place = divmod(point, len(self.lists[path]))
                values[path] = self.lists[path][place]
        ordered = {path: values[path] for path in self.units}
        case = self.cases[ordered[CASE]] if self.cases else {}
        return SweepJob(index, self.file.seeds.first + turn, ordered, case)

    def iterate_jobs(self, done: set[int]) -> Iterator[SweepJob]:
        """Yield the flights that are not done yet."""
        for index in range(self.count):
            if index not in done:
                yield self.build_job(index)

    def check(self, build: Callable[[FlightSpec, int], object] = build_loop) -> None:
        """
        Build every kind of flight once, each value alone: the ends of what is drawn, too.

        Values that fit alone can still not fit together; such a flight is kept as failed.

        Raises
        ------
        BadInput
            If one cannot be flown; nothing has been flown then.

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
        if not isinstance(how, Distribution):
            return list(self.lists[path])
        if how.choice is not None:
            return [parse_value(value, path) for value in how.choice]
        drawn = [
            draw_value(how, path, self.file.seeds.first, k)
            for k in range(self.file.draws_per_point)
        ]
        numbers = [convert_to_si(value) for value in drawn]
        return [drawn[numbers.index(end(numbers))] for end in (min, max)]

    def _find_unit(self, path: str) -> str:
        """Return the SI unit in which a parameter is given that the files leave out."""
        how = self.file.vary[path]
        given = how if isinstance(how, list) else list(iterate_numbers(how))
        found = parse_quantity(parse_value(given[0], path))
        return '' if found is None else UNITS.get(found['unit'], ('',))[0]


def iterate_numbers(how: Distribution) -> Iterator[Any]:
    """Yield what a distribution is given by."""
    for name in type(how).model_fields:
        kind = getattr(how, name)
        if isinstance(kind, list):
            yield from kind
        elif kind is not None:
            yield from (getattr(kind, field) for field in type(kind).model_fields)


def convert_to_si(value: Any) -> Any:  # noqa: ANN401 - what YAML holds
    """Return a value as it stands in the table: numbers in SI, anything else as it is."""
    found = parse_quantity(value)
    if found is None:
        return value
    numbers = Quantity.model_validate(found)
    return list(numbers.vector) if isinstance(numbers.value, tuple) else numbers.si
