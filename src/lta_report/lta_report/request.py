# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Declare once what a command takes: a request, a model whose fields are checked at the door.

From a request derive the options and the help of its command, the arguments and the documentation
of its Python function, and the record of what was run. `run` does the work: that of a `Study` or
another `ReportRequest` returns a report, that of an `Action` prints what it does.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
import shlex
from typing import (
    Annotated,
    Any,
    cast,
    ClassVar,
    dataclass_transform,
    Generic,
    get_origin,
    NamedTuple,
    Self,
    TYPE_CHECKING,
    TypeVar,
)

from lta_config.command_line import format_lta_command, relative_path
from lta_config.errors import BadInput, unknown_name_error
from lta_config.files import describe_problem
from lta_config.parameter_override import format_value, parse_assignment, parse_value
from lta_config.quantity import format_with_unit, Quantity, SI_UNITS
from lta_report.study import Study, StudyOptions
from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    field_validator,
    model_validator,
    PlainSerializer,
    ValidationError,
    ValidationInfo,
)
from rich.console import Console

if TYPE_CHECKING:
    from lta_report.report import Report  # it loads Plotly, which an action does without

Value = TypeVar('Value')
Item = TypeVar('Item')
Result = TypeVar('Result')
AnyRequest = TypeVar('AnyRequest', bound='Request')
OUTPUT = frozenset(('out', 'page', 'pictures'))  # fields that say where results go


def option(
    about: str,
    *,
    default: Any = ...,
    low: float | None = None,
    high: float | None = None,
    kw_only: bool = False,
    **declared: Any,
) -> Any:
    """
    Return the declaration of a field that is an option of the command line.

    `about`: its help, with the unit. `low`, `high`: closed bounds, in SI. `kw_only`: whether
    Python takes it only by name. `declared`: `name`, if the option is not named as the field;
    `metavar`; `default_text`; `unit` in which the bounds are told; and `complete`, the kind of the
    shipped files that a shell completes.
    """
    declared |= {'low': low, 'high': high}
    return Field(default, description=about, json_schema_extra=declared)


def argument(about: str, *, default: Any = ..., **declared: Any) -> Any:
    """Return the declaration of a field that the command line takes by its place."""
    return option(about, default=default, positional=True, **declared)


def remove_duplicates(values: tuple[Item, ...]) -> tuple[Item, ...]:
    """Return the values without repetitions, in their order."""
    return tuple(dict.fromkeys(values))


def _parse_folder(path: object) -> object:
    """Refuse empty text, such as an unset variable of a shell, which would mean '.'."""
    if not str(path).strip():
        raise ValueError('is empty; give a folder or file')
    return path


def _parse_changes(values: object) -> object:
    """Return values by path, from a mapping or from texts such as 'vehicle.trim.heaviness=4 g'."""
    if isinstance(values, Mapping):
        return {path: parse_value(value, path) for path, value in values.items()}
    if isinstance(values, str) or not isinstance(values, Sequence):
        raise ValueError(
            f'is {values!r}, but must be values by path, such as '
            "{'vehicle.trim.heaviness': '4 g'}"
        )
    return dict(map(parse_assignment, values))


def _parse_quantity(what: str, example: str, value: object) -> object:
    """Return a quantity in SI, from a number in SI or a text with a unit."""
    if not isinstance(value, str | bool):
        return value
    try:
        # Capacities are written without the space of the unit
        quantity = Quantity.model_validate(str(value).replace('Ah', 'A h'))
    except ValidationError:
        quantity = None
    dimension = Quantity.model_validate(example).dimension
    if quantity is None or quantity.dimension != dimension or len(quantity.vector) != 1:
        raise ValueError(
            f"'{value}' is not a {what}; give a number with a unit, such as '{example}'"
        )
    return quantity.si


def _format_quantity(unit: str, value: float) -> str:
    """Return a number in SI as text with a unit."""
    return format_with_unit(f'{value / SI_UNITS[unit][1]:.12g}', unit)


Folder = Annotated[Path, BeforeValidator(_parse_folder)]
Names = Annotated[tuple[str, ...], AfterValidator(remove_duplicates)]
Changes = Annotated[dict[str, Any], BeforeValidator(_parse_changes)]  # new values by path
# In SI; as text with a unit
Mass = Annotated[
    float,
    BeforeValidator(partial(_parse_quantity, 'mass', '6 g')),
    PlainSerializer(partial(_format_quantity, 'g')),
]
Length = Annotated[
    float,
    BeforeValidator(partial(_parse_quantity, 'length', '50 cm')),
    PlainSerializer(partial(_format_quantity, 'm')),
]
Force = Annotated[
    float,
    BeforeValidator(partial(_parse_quantity, 'force', '0.1 N')),
    PlainSerializer(partial(_format_quantity, 'N')),
]
Charge = Annotated[
    float,
    BeforeValidator(partial(_parse_quantity, 'charge', '250 mA h')),
    PlainSerializer(partial(_format_quantity, 'mA h')),
]
# Fields that many commands have
VEHICLE: Any = option('Vehicle name or file.', default='gtmab', complete='vehicle')
VEHICLE_NAME: Any = argument(
    'Name of a shipped vehicle, or path of a vehicle file.', metavar='VEHICLE', complete='vehicle'
)
CHANGES: Any = option(
    'Override a parameter; repeatable.', default={}, name='set', metavar='PATH=VALUE'
)
ROBOT: Any = option('Robot; needed if a bag has several.', default=None)


@dataclass_transform(field_specifiers=(option, argument))
class Request(BaseModel):
    """What a command takes; the docstring of a subclass is the help of its command."""

    model_config = ConfigDict(frozen=True, extra='forbid', validate_default=True, defer_build=True)
    command: ClassVar[str]  # its words, such as 'energy budget'

    def __init_subclass__(cls, *, command: str = '', **rest: Any) -> None:
        """Store what is declared with the class."""
        super().__init_subclass__(**rest)
        cls.command = command

    @model_validator(mode='before')
    @classmethod
    def _accept_python(cls, values: Mapping[str, Any]) -> dict[str, Any]:
        """Accept paths for names, numbers and arrays of numpy, and one value for several."""
        plain = {}
        for name, value in values.items():
            one = str(value) if isinstance(value, Path) else value
            one = one.tolist() if hasattr(one, 'tolist') else one
            info = cls.model_fields.get(name)
            several = info is not None and get_origin(info.annotation) is tuple
            plain[name] = (one,) if several and isinstance(one, str | int | float) else one
        return plain

    @field_validator('*')
    @classmethod
    def _check_bounds(cls, value: Any, info: ValidationInfo) -> Any:
        """Refuse a number, or one of several, that is out of bounds."""
        declared = cls.read_declaration(info.field_name or '')
        low, high, unit = declared['low'], declared['high'], declared.get('unit', '1')
        factor = SI_UNITS[unit][1]
        for each in value if isinstance(value, tuple) else (value,):
            if each is None or isinstance(each, str) or (low is None and high is None):
                continue
            if not (low is None or each >= low) or not (high is None or each <= high):
                bounds = ' and '.join(
                    f'{format_with_unit(f"{bound / factor:g}", unit)} or {word}'
                    for bound, word in ((low, 'more'), (high, 'less'))
                    if bound is not None
                )
                own = format_with_unit(f'{each / factor:g}', unit)
                raise ValueError(f'is {own}, but must be {bounds}')
        return value

    def replace(self, **values: Any) -> Self:
        """Return a request with other values, which are not checked again."""
        return self.model_copy(update=values)

    @classmethod
    def list_fields(cls) -> list[str]:
        """Return the names of the fields: its own, then those that it shares with others."""
        bases = [base for base in cls.__mro__ if issubclass(base, Request)]
        names = [name for base in bases for name in base.__annotations__]
        return list(dict.fromkeys(name for name in names if name in cls.model_fields))

    @classmethod
    def describe(cls, field: str) -> str:
        """Return the help of a field."""
        return cls.model_fields[field].description or ''

    @classmethod
    def name_option(cls, field: str) -> str:
        """Return the name of a field on the command line."""
        declared = cls.read_declaration(field)
        name: str = declared.get('name') or field.replace('_', '-')
        return field.upper() if declared.get('positional') else f'--{name}'

    @classmethod
    def read_declaration(cls, field: str) -> dict[str, Any]:
        """Return what `option` declares of a field, besides type, default and help."""
        return cast('dict[str, Any]', cls.model_fields[field].json_schema_extra)

    def format_command(self, **instead: object) -> str:
        """Return the command line of the values that were set, some of them replaced."""
        words = self.command.split()
        values = {**self.model_dump(mode='json', include=self.model_fields_set), **instead}
        for name in self.list_fields():
            value, word = values.get(name), self.name_option(name)
            if isinstance(value, bool):
                words.append(word if value else word.replace('--', '--no-', 1))
                continue
            if isinstance(value, dict):
                value = [f'{path}={format_value(each)}' for path, each in value.items()]
            for each in value if isinstance(value, list) else [value]:
                if each is not None:
                    words += ([word] if word.startswith('--') else []) + [str(each)]
        return format_lta_command(*words)


def build_request(
    model: Callable[..., AnyRequest],
    values: Mapping[str, object],
    name_field: Callable[[str], str] = str,
) -> AnyRequest:
    """
    Return a request; raise `BadInput`, in one sentence, for a value that it does not take.

    `name_field`: returns how the user calls a field.
    """
    try:
        return model(**values)
    except ValidationError as error:
        fault = error.errors()[0]
        cause = fault.get('ctx', {}).get('error')
        if isinstance(cause, BadInput):
            raise cause from None
        raise _describe_fault(fault, cast('type[Request]', model), name_field) from None


def _describe_fault(
    fault: Any,
    model: type[Request],
    name_field: Callable[[str], str],
) -> BadInput:
    """Return the error for a value that a field does not take."""
    field = str(fault['loc'][0])
    if fault['type'] == 'extra_forbidden':
        return unknown_name_error('argument', field, model.list_fields())
    if fault['type'] == 'missing':
        return BadInput(f'{name_field(field)} is missing: {model.describe(field)}')
    reason = fault['msg'].removeprefix('Value error, ')
    if reason != fault['msg']:
        return BadInput(f'{name_field(field)} {reason}.')
    return BadInput(f'{name_field(field)} is {fault["input"]!r}, but {describe_problem(fault)}.')


class Outcome(NamedTuple, Generic[Value]):
    """What an action has done."""

    value: Value  # what Python gets
    data: Any = None  # content of --json; the value by default
    status: int = 0  # exit status of the command

    def to_json(self) -> Any:
        """Return the content of --json; None if nothing is to be printed."""
        return self.value if self.data is None else self.data


class Action(Request):
    """A request that prints what it does; with `json`, its command has --json."""

    prints_json: ClassVar[bool]

    def __init_subclass__(cls, *, json: bool = False, **rest: Any) -> None:
        """Store what is declared with the class."""
        super().__init_subclass__(**rest)
        cls.prints_json = json

    def run(self, console: Console) -> Outcome[Any]:
        """Do it, and return the outcome."""
        raise NotImplementedError


@dataclass(slots=True)
class StudyRun:
    """What a request runs in: its console, and its results folder."""

    console: Console  # for progress; it writes to stderr if the results are printed as JSON
    # Results folder, absolute. A study that resumes or names it calls `open_folder`.
    folder: Path
    out: Path | None = None  # the folder that the user has chosen
    options: StudyOptions = field(default_factory=StudyOptions)
    writes: bool = True  # whether the report is stored

    def open_folder(self, default: Path) -> Path:
        """Set and return the results folder: the user's, or a default one."""
        self.folder = (self.out or default).absolute()
        return self.folder

    def run_study(
        self, study: Study[Item, Result], identity: str, items: Sequence[Item]
    ) -> list[Result]:
        """Run the items of a study that its folder does not hold, and return all results."""
        return study.run(items, self.folder, identity, self.options, self.console).require_all()


class ReportRequest(Request):
    """A request whose result is a report; `folder` names it: runs/<time>-<folder>."""

    folder: ClassVar[str]
    resumes: ClassVar[bool] = False  # whether finished work is in the folder, which may then exist
    out: Folder | None = option(
        'Folder of the results; in runs/ by default.', default=None, metavar='FOLDER', kw_only=True
    )
    page: bool = option('Write an HTML report.', default=True, kw_only=True)
    pictures: Path | None = option(
        'Write each figure as PNG to this folder; needs Chromium.', default=None,
        metavar='FOLDER', kw_only=True,
    )  # fmt: skip

    def __init_subclass__(cls, *, folder: str = '', **rest: Any) -> None:
        """Store what is declared with the class."""
        super().__init_subclass__(**rest)
        cls.folder = folder or cls.command.split()[-1] if cls.command else ''

    def run(self, run: StudyRun) -> 'Report':
        """Return the report; nothing but stored work is written before."""
        raise NotImplementedError

    def format_repetition(self, folder: Path) -> str:
        """Return the command that repeats it; a study that resumes goes on in its folder."""
        own = self.model_fields_set - OUTPUT
        again = {'out': str(relative_path(folder))} if self.resumes else {}
        return self.model_construct(own, **dict(self)).format_command(**again)


class LocalStudyRequest(ReportRequest):
    """A request that computes many items on this machine, and resumes if `resumes`."""

    # What --quick sets, unless it is given; or what it says of a study that reads `quick` itself
    preset: ClassVar[Mapping[str, Any] | str] = ''
    quick: bool = option('', default=False, kw_only=True)
    workers: int | None = option(
        'Number of worker processes; one per processor by default.', default=None, low=1,
        kw_only=True,
    )  # fmt: skip
    retry_failed: bool = option(
        'Repeat what failed in an earlier run.', default=False, kw_only=True
    )

    def __init_subclass__(
        cls, *, quick: Mapping[str, Any] | str = '', resumes: bool = True, **rest: Any
    ) -> None:  # fmt: skip
        """Store what is declared with the class."""
        super().__init_subclass__(**rest)
        cls.preset, cls.resumes = quick, resumes

    @classmethod
    def describe(cls, field: str) -> str:
        """Return the help of a field; that of `quick` says what it sets."""
        if field != 'quick':
            return super().describe(field)
        if isinstance(cls.preset, str):
            return cls.preset
        words = [word for key, value in cls.preset.items() for word in (f'--{key}', f'{value}')]
        return f'The same as {shlex.join(words)}.'

    @property
    def options(self) -> StudyOptions:
        """Who computes the items."""
        return StudyOptions(self.workers, retry_failed=self.retry_failed)

    def shorten(self) -> Self:
        """Return what is run: with --quick, the values that it presets."""
        if not self.quick or isinstance(self.preset, str):
            return self
        values = {key: self.preset[key] for key in self.preset.keys() - self.model_fields_set}
        return self.replace(**values)


class StudyRequest(LocalStudyRequest):
    """A request that computes many items on this machine or on a cluster."""

    scheduler: str | None = option(
        'Use a Dask cluster; address of its scheduler, such as tcp://127.0.0.1:8786.',
        default=None, metavar='ADDRESS', kw_only=True,
    )  # fmt: skip

    @property
    def options(self) -> StudyOptions:
        """Who computes the items."""
        return StudyOptions(self.workers, self.scheduler, self.retry_failed)
