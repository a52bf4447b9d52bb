# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Find the project's files by name, read them strictly, and say in one sentence what is wrong.

A name (`gtmab`) refers to a file that LTA ships; anything with a suffix or a slash is a path.
Every file is validated as a whole against its pydantic model before anything starts.
"""

from collections.abc import Hashable, Iterable, Mapping, Sequence
import copy
from difflib import get_close_matches
from functools import cache, lru_cache
import io
import os
from pathlib import Path
import re
from typing import Annotated, Any, Literal, TypeVar

from lta_config.errors import BadInput, unknown_name_error
from lta_config.limits import YAML_BYTES, YAML_DEPTH, YAML_DIGITS
from pydantic import AliasChoices, BaseModel, ConfigDict, Field, ValidationError
import yaml

# Messages by pydantic's type of error; braces are filled from the error's context
PROBLEM_TEXTS = {
    'int_type': 'must be a whole number',
    'int_parsing': 'must be a whole number',
    'int_from_float': 'must be a whole number',
    'float_type': 'must be a number',
    'float_parsing': 'must be a number',
    'finite_number': 'must be finite',
    'bool_type': 'must be true or false',
    'bool_parsing': 'must be true or false',
    'string_type': 'must be text',
    'path_type': 'must be a path',
    'literal_error': 'must be {expected}',
    'enum': 'must be {expected}',
    'greater_than': 'must be above {gt}',
    'greater_than_equal': 'must be at least {ge}',
    'less_than': 'must be below {lt}',
    'less_than_equal': 'must be at most {le}',
    'string_pattern_mismatch': 'must match {pattern}',
    'too_short': 'must have {min_length} or more entries',
    'too_long': 'must have {max_length} or fewer entries',
    'model_type': 'must be a mapping (key: value)',
    'mapping_type': 'must be a mapping (key: value)',
    'dict_type': 'must be a mapping (key: value)',
    'list_type': 'must be a list',
    'tuple_type': 'must be a list',
}


def format_error(error: ValidationError) -> str:
    """Return the first problem of a pydantic error as one sentence."""
    problems = error.errors()
    return _format_problem(problems[0], problems)


def format_errors(error: ValidationError) -> list[str]:
    """Return every problem as a sentence; a misspelt key gives only one."""
    problems = error.errors()
    missing = [problem for problem in problems if problem['type'] == 'missing']
    lines = []
    for problem in problems:
        if any(_is_misspelt(problem, other) for other in missing):
            continue
        lines.append(_format_problem(problem, problems))
    return lines


def _is_misspelt(problem: Mapping[str, Any], missing: Mapping[str, Any]) -> bool:
    """Return whether an unknown key is probably meant as a missing one at the same place."""
    if problem['type'] != 'extra_forbidden' or problem['loc'][:-1] != missing['loc'][:-1]:
        return False
    return bool(get_close_matches(str(missing['loc'][-1]), [str(problem['loc'][-1])]))


def _format_problem(first: Mapping[str, Any], problems: Sequence[Mapping[str, Any]]) -> str:
    """Return one problem as a sentence, taking the others into account."""
    where = locate_problem(first) or 'the file'
    if first['type'] == 'extra_forbidden':
        return f"the key '{where}' is not known; remove it or correct its spelling."
    if first['type'] == 'missing':
        # A misspelt key causes two errors at the same place: a missing and an unknown key
        for other in problems:
            if _is_misspelt(other, first):
                return (
                    f"the key '{where}' is missing and '{locate_problem(other)}' is not known; "
                    'correct its spelling.'
                )
        return f"the key '{where}' is missing; add it."
    if first['type'] == 'value_error':
        # Our validators write the predicate; pydantic adds the prefix
        return f'{where} {first["msg"].removeprefix("Value error, ")}.'
    value: Any = first.get('input')
    # Do not print a whole block as the value
    if isinstance(value, Mapping | list | tuple):
        return f'{where} {describe_problem(first)}.'
    return f'{where} is {value!r}, but {describe_problem(first)}.'


def locate_problem(problem: Mapping[str, Any]) -> str:
    """Return the place of a problem as a dotted name."""
    return '.'.join(str(part) for part in problem['loc'])


def describe_problem(problem: Mapping[str, Any]) -> str:
    """Return what is wrong as a predicate."""
    plain = PROBLEM_TEXTS.get(problem['type'])
    if plain is None:
        return f'is not valid: {problem["msg"]}'
    numbers = {
        key: f'{value:g}' if isinstance(value, float) else value
        for key, value in problem.get('ctx', {}).items()
    }
    return plain.format(**numbers)


# The YAML reader also raises these, for example for an invalid date or tag
READER_ERRORS = (ValueError, ArithmeticError, LookupError, TypeError, AttributeError)
CACHED_LENGTH = 50_000  # characters; larger texts are not cached
NUMERAL = re.compile('[-+.:_0-9A-Fa-fxXoO]+')  # text that YAML may read as a number
# Folders of the shipped files, by kind as error messages name it
KIND_FOLDERS = {
    'aero': 'aero',
    'tunnel': 'tunnels',
    'vehicle': 'vehicles',
    'scenario': 'scenarios',
    'gains': 'control',
    'sweep': 'sweeps',
    'manoeuvre': 'manoeuvres',
    'mount': 'mounts',
    'comparison': 'comparisons',
    'import mapping': 'imports',
    'floor plan': 'floor_plans',
    'light of the day': 'light_days',
    'mission': 'missions',
    'cell': 'cells',
    'cell table': 'cell_tables',
    'spectrum': 'spectra',
    'spectral response': 'spectral_responses',
    'crazyflie': 'crazyflies',
    'row of the paper': 'paper',
}


class StrictModel(BaseModel):
    """Base of everything read from a file: immutable, without unknown keys and type coercion."""

    model_config = ConfigDict(frozen=True, extra='forbid', strict=True, defer_build=True)


Model = TypeVar('Model', bound=BaseModel)
# Of every file: the version of its schema, and its name
SchemaVersion = Annotated[Literal[1], Field(validation_alias=AliasChoices('schema'))]
Name = Annotated[str, Field(pattern=r'^[a-z][a-z0-9_]*$')]


def check_exactly_one(model: BaseModel, *names: str) -> None:
    """Raise `ValueError` unless exactly one of some keys is given."""
    if sum(getattr(model, name) is not None for name in names) != 1:
        *others, last = (f'"{name}"' for name in names)
        raise ValueError(f'needs exactly one of {", ".join(others)} and {last}')


class _UniqueKeys(yaml.CSafeLoader):
    """A safe YAML loader that rejects repeated keys, which YAML silently overrides."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        seen: dict[Hashable, int] = {}
        for key_node, _ in node.value:
            key = self.construct_object(key_node, deep=True)
            # YAML allows lists and mappings as keys, which Python does not
            if not isinstance(key, Hashable):
                raise BadInput(
                    f'{key_node.start_mark.name}: the key {key} is a list or mapping; use a '
                    'single word as the key.'
                )
            line = key_node.start_mark.line + 1
            if key in seen:
                raise BadInput(
                    f"{key_node.start_mark.name}: the key '{key}' appears twice "
                    f'({_format_lines(seen[key], line)}); merge them.'
                )
            seen[key] = line
        return super().construct_mapping(node, deep)


def _format_lines(first: int, second: int) -> str:
    """Return the line numbers of two keys."""
    return f'lines {first} and {second}' if first != second else f'line {first}'


@cache
def share_folder() -> Path:
    """Return the folder with LTA's own data: topics.yaml, vehicles/, scenarios/ ..."""
    here = Path(__file__).resolve()
    for parent in here.parents:
        # The source tree has topics.yaml next to the package, an installation in share/
        for folder in (parent, parent / 'share' / 'lta_config'):
            if (folder / 'topics.yaml').is_file():
                return folder
    raise BadInput(
        f'LTA cannot find its data files (topics.yaml) in the folders above {here}; '
        'build the workspace again with make.'
    )


def list_shipped_names(folder: str, suffix: str = '.yaml') -> list[str]:
    """Return the names of the files in one folder of `share_folder()`."""
    return sorted(
        path.name.removesuffix(suffix) for path in (share_folder() / folder).glob(f'*{suffix}')
    )


def find_file(kind: str, name: str, suffix: str = '.yaml') -> Path:
    """
    Return the path of a file given by name or path.

    `kind`: what it describes: a key of `KIND_FOLDERS`. `name`: a shipped name, or a path (it has
    a slash or ends in `.yaml`). Raise `BadInput` if there is no such file; the message lists the
    shipped names.
    """
    if '/' in name or name.endswith((suffix, '.yaml', '.yml')):
        path = Path(os.path.expanduser(name))  # noqa: PTH111 - Path's own fails for ~nobody
        if not path.is_file():
            raise BadInput(f'There is no {kind} file {path}; check the path.')
        return path
    folder = KIND_FOLDERS[kind]
    names = list_shipped_names(folder, suffix)
    if name not in names:
        own = Path(f'{name}{suffix}')
        if own.is_file():
            raise BadInput(f"No {kind} '{name}' is shipped; for the file here, give './{own}'.")
        raise unknown_name_error(kind, name, names)
    return share_folder() / folder / f'{name}{suffix}'


def load_yaml(path: Path) -> Any:
    """
    Return the content of a YAML file; see `parse_yaml`.

    Raise `BadInput` if the file cannot be read, or not as YAML.
    """
    if path.exists() and not path.is_file():  # reading a pipe could block, a device never ends
        raise BadInput(f'{path} is not a regular file; give the path of a YAML file.')
    try:
        with path.open('rb') as stream:
            # Reading one byte more than allowed shows that a file is too large
            data = stream.read(YAML_BYTES + 1)
        return parse_yaml(data.decode('utf-8') if len(data) <= YAML_BYTES else data, str(path))
    except (OSError, UnicodeDecodeError) as error:
        raise BadInput(f'{path} cannot be read: {error}.') from None


def parse_yaml(text: str | bytes, where: str) -> Any:
    """
    Return the content of a YAML text, with limits on size, nesting, aliases and repeated keys.

    `text`: untrusted text. `where`: what the text is, as the subject of an error message. Raise
    `BadInput` if it is not valid YAML, or would take more memory than its size suggests.
    """
    if len(text) > YAML_BYTES:
        raise BadInput(
            f'{where} is larger than {YAML_BYTES} bytes, the limit for YAML files; shorten it.'
        )
    if len(text) > CACHED_LENGTH:
        return _parse_strict(text, where)
    return copy.deepcopy(_parse_cached(text, where))  # callers may modify the result


def _parse_strict(text: str | bytes, where: str) -> Any:
    try:
        # Check the events first: loading an alias bomb would exhaust the memory
        _check_shape(where, yaml.parse(_open_named(text, where), Loader=_UniqueKeys))
        return yaml.load(_open_named(text, where), Loader=_UniqueKeys)
    except BadInput:
        raise
    except (yaml.YAMLError, *READER_ERRORS) as error:
        # PyYAML's messages have several lines
        reason = ' '.join(str(error).split())
        raise BadInput(f'{where} is not valid YAML: {reason}.') from None


@lru_cache(maxsize=64)
def _parse_cached(text: str | bytes, where: str) -> Any:
    """Parse a short text once; copying the result takes a twentieth of the time."""
    return _parse_strict(text, where)


def _open_named(text: str | bytes, where: str) -> io.StringIO | io.BytesIO:
    """Return a text as a stream with the name that the YAML reader puts into its errors."""
    stream = io.StringIO(text) if isinstance(text, str) else io.BytesIO(text)
    stream.name = where
    return stream


def _check_shape(where: str, events: Iterable[yaml.Event]) -> None:
    """Reject YAML that is nested too deeply, or grows too large when aliases are expanded."""
    open_: list[tuple[str | None, int]] = []  # anchor of each open collection, and total before it
    sizes: dict[str, int] = {}  # number of values below each anchor
    total = 0  # number of values with all aliases expanded
    for event in events:
        if isinstance(event, yaml.CollectionEndEvent):
            anchor, before = open_.pop()
            if anchor is not None:
                sizes[anchor] = total - before
            continue
        alias = event.anchor if isinstance(event, yaml.AliasEvent) else None
        if alias is not None and any(anchor == alias for anchor, _ in open_):
            raise BadInput(
                f"{where} uses the alias '*{alias}' inside the value that it stands for "
                f"('&{alias}'); write the value instead of the alias."
            )
        total += 1 if alias is None else sizes.get(alias, 1)
        if isinstance(event, yaml.CollectionStartEvent):
            open_.append((event.anchor, total))
        elif isinstance(event, yaml.ScalarEvent):
            _check_number(where, event)
            if event.anchor is not None:
                sizes[event.anchor] = 1
        if len(open_) > YAML_DEPTH:
            raise BadInput(
                f'{where} is nested more than {YAML_DEPTH} levels deep; use fewer levels.'
            )
        if total > YAML_BYTES:
            raise BadInput(
                f'{where} has more than {YAML_BYTES} values after its aliases are expanded; use '
                'fewer aliases.'
            )


def _check_number(where: str, event: yaml.ScalarEvent) -> None:
    """Reject very long numbers, which take minutes to read: YAML 1.1 has base 60, too."""
    # PyYAML's flags are for a plain and for a quoted scalar
    quoted = event.implicit[1]
    if not quoted and len(event.value) > YAML_DIGITS and NUMERAL.fullmatch(event.value):
        raise BadInput(
            f'{where} has a number with more than {YAML_DIGITS} digits; shorten the number.'
        )


def load_file(model: type[Model], path: Path) -> Model:
    """
    Return a file's content, validated by its model.

    Raises
    ------
    BadInput
        One sentence on the first problem: where it is, what it is, and how to correct it.

    """
    return validate_content(model, load_yaml(path), str(path))


def validate_content(model: type[Model], content: Any, where: str) -> Model:
    """
    Return a file's content, validated by its model; errors as `load_file`.

    `model`: the file's schema. `content`: the content as YAML has it. `where`: the file, as the
    subject of an error message.
    """
    if not isinstance(content, dict):
        raise BadInput(
            f'{where} is not a YAML mapping (key: value); compare it with a shipped file.'
        )
    try:
        return model.model_validate(content)
    except ValidationError as error:
        raise BadInput(f'{where}: {format_error(error)}') from None
