"""
Find the project's files by name and read them strictly.

A name (`gtmab`) means a file that LTA ships; anything with a suffix or a slash is a path. Every
file is checked whole against its pydantic model before anything starts.
"""

from collections.abc import Hashable, Iterable
import copy
from functools import cache, lru_cache
import io
import os
from pathlib import Path
import re
from typing import Any, TypeVar

from lta_config.errors import BadInput, unknown_name
from lta_config.limits import YAML_BYTES, YAML_DEPTH, YAML_DIGITS
from lta_config.validation_errors import format_error
from pydantic import BaseModel, ConfigDict, ValidationError
import yaml

# What the YAML reader raises beside its own errors: no such date, a tag that does not fit.
MISFITS = (ValueError, ArithmeticError, LookupError, TypeError, AttributeError)
YAML_KEPT = 50_000  # characters; larger texts are not cached
NUMERAL = re.compile('[-+.:_0-9A-Fa-fxXoO]+')  # what YAML may read a number from

# Where the files of each kind are shipped.
FOLDERS = {
    'aero': 'aero',
    'tunnel': 'tunnels',
    'vehicle': 'vehicles',
    'scenario': 'scenarios',
    'gains': 'control',
    'launch file': 'launch',
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
    'crazyflie': 'crazyflies',
    'row of the paper': 'paper',
}


class StrictModel(BaseModel):
    """Base of everything read from a file: immutable, nothing unknown, nothing coerced."""

    model_config = ConfigDict(frozen=True, extra='forbid', strict=True)


Model = TypeVar('Model', bound=BaseModel)


class _UniqueKeys(yaml.CSafeLoader):
    """A safe YAML loader to which a repeated key is an error instead of a silent override."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        seen: dict[Hashable, int] = {}
        for key_node, _ in node.value:
            key = self.construct_object(key_node, deep=True)
            if not isinstance(key, Hashable):
                raise BadInput(f'{key_node.start_mark.name}: the key {key} must be one word.')
            line = key_node.start_mark.line + 1
            if key in seen:
                raise BadInput(
                    f"{key_node.start_mark.name}: the key '{key}' stands twice "
                    f'({_format_lines(seen[key], line)}); merge them.'
                )
            seen[key] = line
        return super().construct_mapping(node, deep)


def _format_lines(first: int, second: int) -> str:
    """Return the places of two keys, as one finds them in an editor."""
    return f'lines {first} and {second}' if first != second else f'line {first}'


@cache
def share_folder() -> Path:
    """Return the folder with LTA's own data: topics.yaml, vehicles/, scenarios/, launch/ ..."""
    here = Path(__file__).resolve()
    for parent in here.parents:
        for folder in (parent, parent / 'share' / 'lta_config'):
            if (folder / 'topics.yaml').is_file():
                return folder
    raise BadInput(f'LTA cannot find its data beside {here}; build the workspace again (make).')


def list_shipped(folder: str, suffix: str = '.yaml') -> list[str]:
    """Return the names of the files that LTA ships in one folder of `share_folder()`."""
    return sorted(
        path.name.removesuffix(suffix) for path in (share_folder() / folder).glob(f'*{suffix}')
    )


def find_file(kind: str, name: str, suffix: str = '.yaml') -> Path:
    """
    Return the file that a name or a path means.

    Parameters
    ----------
    kind : str
        What the file describes: a key of `FOLDERS`.
    name : str
        A shipped name, or a path (it has a slash or ends in `.yaml`).

    Raises
    ------
    BadInput
        If there is no such file; shipped names are listed.

    """
    if '/' in name or name.endswith(('.yaml', '.yml')):
        path = Path(os.path.expanduser(name))  # noqa: PTH111 - Path's own fails for ~nobody
        if not path.is_file():
            raise BadInput(
                f'There is no {kind.removesuffix(" file")} file {path}; check the path.'
            )
        return path
    folder = FOLDERS[kind]
    names = list_shipped(folder, suffix)
    if name not in names:
        raise unknown_name(kind, name, names)
    return share_folder() / folder / f'{name}{suffix}'


def load_yaml(path: Path) -> Any:  # noqa: ANN401 - YAML holds anything
    """
    Return what a YAML file holds; errors as `parse_yaml`, or if it cannot be read at all.

    Raises
    ------
    BadInput
        If the file cannot be read as YAML.

    """
    if path.exists() and not path.is_file():  # a pipe would be waited for, a device has no end
        raise BadInput(f'{path} cannot be read: it is no plain file; give one.')
    try:
        with path.open('rb') as stream:
            # One byte more tells a larger file, and no more of it is read.
            data = stream.read(YAML_BYTES + 1)
        return parse_yaml(data.decode('utf-8') if len(data) <= YAML_BYTES else data, str(path))
    except (OSError, UnicodeDecodeError) as error:
        raise BadInput(f'{path} cannot be read: {error}.') from None


def parse_yaml(text: str | bytes, where: str) -> Any:  # noqa: ANN401 - YAML holds anything
    """
    Return what a YAML text holds; strict about repeated keys, size, nesting, aliases and syntax.

    Parameters
    ----------
    text : str or bytes
        Whoever wrote it.
    where : str
        What the text is, as the subject of the sentence.

    Raises
    ------
    BadInput
        If it cannot be read as YAML, or would take more memory than its size.

    """
    if len(text) > YAML_BYTES:
        raise BadInput(f'{where} is larger than {YAML_BYTES} bytes; that is no file of ours.')
    if len(text) > YAML_KEPT:
        return _parse_strict(text, where)
    return copy.deepcopy(_parse_cached(text, where))  # callers may change it


def _parse_strict(text: str | bytes, where: str) -> Any:  # noqa: ANN401 - YAML holds anything
    try:
        _check_shape(where, yaml.parse(_open_named(text, where), Loader=_UniqueKeys))
        return yaml.load(_open_named(text, where), Loader=_UniqueKeys)
    except BadInput:
        raise
    except (yaml.YAMLError, *MISFITS) as error:
        reason = ' '.join(str(error).split())
        raise BadInput(f'{where} is not valid YAML: {reason}.') from None


@lru_cache(maxsize=64)
def _parse_cached(text: str | bytes, where: str) -> Any:  # noqa: ANN401 - YAML holds anything
    """Parse a short text once: copying the result takes a twentieth of the time."""
    return _parse_strict(text, where)


def _open_named(text: str | bytes, where: str) -> io.StringIO | io.BytesIO:
    """Return a text as a stream whose name the reader puts into its complaints."""
    stream = io.StringIO(text) if isinstance(text, str) else io.BytesIO(text)
    stream.name = where
    return stream


def _check_shape(where: str, events: Iterable[yaml.Event]) -> None:
    """Refuse what is nested too deeply, or grows too large where aliases are written out."""
    open_: list[tuple[str | None, int]] = []  # anchor, and how much there was before it
    sizes: dict[str, int] = {}
    total = 0
    for event in events:
        if isinstance(event, yaml.CollectionEndEvent):
            anchor, before = open_.pop()
            if anchor is not None:
                sizes[anchor] = total - before
            continue
        alias = event.anchor if isinstance(event, yaml.AliasEvent) else None
        if alias is not None and any(anchor == alias for anchor, _ in open_):
            raise BadInput(f"{where} has the alias '{alias}' in itself; write it out.")
        total += 1 if alias is None else sizes.get(alias, 1)
        if isinstance(event, yaml.CollectionStartEvent):
            open_.append((event.anchor, total))
        elif isinstance(event, yaml.ScalarEvent):
            _check_number(where, event)
            if event.anchor is not None:
                sizes[event.anchor] = 1
        if len(open_) > YAML_DEPTH:
            raise BadInput(f'{where} is nested more than {YAML_DEPTH} deep; flatten it.')
        if total > YAML_BYTES:
            raise BadInput(f'{where} holds more than {YAML_BYTES} values; use fewer aliases.')


def _check_number(where: str, event: yaml.ScalarEvent) -> None:
    """Refuse a number whose reading would take minutes: YAML 1.1 counts to the base of 60, too."""
    quoted = event.implicit[1]
    if not quoted and len(event.value) > YAML_DIGITS and NUMERAL.fullmatch(event.value):
        raise BadInput(f'{where} holds a number of more than {YAML_DIGITS} digits; shorten it.')


def load_file(model: type[Model], path: Path) -> Model:
    """
    Return a file's content, checked against its model.

    Raises
    ------
    BadInput
        One sentence on the first thing that is wrong: where, what, and how to write it.

    """
    return validate_content(model, load_yaml(path), str(path))


def validate_content(model: type[Model], content: Any, where: str) -> Model:  # noqa: ANN401 - YAML holds anything
    """
    Return what a file held, checked against its model; errors as `load_file`.

    Parameters
    ----------
    model : type
        The file's schema.
    content : Any
        What the file held.
    where : str
        The file, as the subject of a sentence.

    """
    if not isinstance(content, dict):
        raise BadInput(f'{where} holds no mapping of keys; compare it with a shipped file.')
    try:
        return model.model_validate(content)
    except ValidationError as error:
        raise BadInput(f'{where}: {format_error(error)}') from None
