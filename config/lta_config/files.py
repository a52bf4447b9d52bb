"""
Find the project's files by name and read them strictly.

A name (`gtmab`) means a file that LTA ships; anything with a suffix or a slash is a path. Every
file is checked whole against its pydantic model before anything starts.
"""

from collections.abc import Hashable, Iterable
from functools import cache
import os
from pathlib import Path
from typing import Any, TypeVar

from lta_config.errors import BadInput, unknown
from pydantic import BaseModel, ConfigDict, ValidationError
import yaml

SIZE_LIMIT = 1_000_000  # bytes; no file that people write by hand comes near it
DEPTH_LIMIT = 50  # levels of nesting; thousands of them overflow the C stack of the YAML reader


# Where the files of each kind are shipped.
FOLDERS = {
    'vehicle': 'vehicles',
    'scenario': 'scenarios',
    'gains': 'control',
    'launch file': 'launch',
}


class Record(BaseModel):
    """Base of everything read from a file: immutable, nothing unknown, nothing coerced."""

    model_config = ConfigDict(frozen=True, extra='forbid', strict=True)


Model = TypeVar('Model', bound=BaseModel)


class _UniqueKeys(yaml.CSafeLoader):
    """A safe YAML loader to which a repeated key is an error instead of a silent override."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        seen = set()
        for key_node, _ in node.value:
            key = self.construct_object(key_node, deep=True)
            if not isinstance(key, Hashable):
                raise BadInput(f'{key_node.start_mark.name}: the key {key} must be one word.')
            if key in seen:
                raise BadInput(f"{key_node.start_mark.name}: the key '{key}' stands twice.")
            seen.add(key)
        return super().construct_mapping(node, deep)


@cache
def share() -> Path:
    """Return the folder with LTA's own data: topics.yaml, vehicles/, scenarios/, launch/ ..."""
    here = Path(__file__).resolve()
    for parent in here.parents:
        for folder in (parent, parent / 'share' / 'lta_config'):
            if (folder / 'topics.yaml').is_file():
                return folder
    raise BadInput(f'LTA cannot find its data beside {here}; build the workspace again (make).')


def known(folder: str, suffix: str = '.yaml') -> list[str]:
    """Return the names of the files that LTA ships in one folder of `share()`."""
    return sorted(path.name.removesuffix(suffix) for path in (share() / folder).glob(f'*{suffix}'))


def find(kind: str, name: str, suffix: str = '.yaml') -> Path:
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
            raise BadInput(f'There is no {kind} file {path}; check the path.')
        return path
    folder = FOLDERS[kind]
    names = known(folder, suffix)
    if name not in names:
        raise unknown(kind, name, names)
    return share() / folder / f'{name}{suffix}'


def load_yaml(path: Path) -> Any:  # noqa: ANN401 - YAML holds anything
    """
    Return what a YAML file holds; strict about repeated keys, size and syntax.

    Raises
    ------
    BadInput
        If the file cannot be read as YAML.

    """
    try:
        if path.stat().st_size > SIZE_LIMIT:
            raise BadInput(f'{path} is larger than {SIZE_LIMIT} bytes; that is no file of ours.')
        with path.open(encoding='utf-8') as stream:
            _check_depth(path, yaml.parse(stream, Loader=_UniqueKeys))
            stream.seek(0)
            return yaml.load(stream, Loader=_UniqueKeys)
    except BadInput:
        raise
    except (OSError, UnicodeDecodeError) as error:
        raise BadInput(f'{path} cannot be read: {error}.') from None
    except (yaml.YAMLError, ValueError) as error:  # ValueError: no such date or number
        where = ' '.join(str(error).split())
        raise BadInput(f'{path} is not valid YAML: {where}.') from None


def _check_depth(path: Path, events: Iterable[yaml.Event]) -> None:
    depth = 0
    for event in events:
        depth += isinstance(event, yaml.CollectionStartEvent)
        depth -= isinstance(event, yaml.CollectionEndEvent)
        if depth > DEPTH_LIMIT:
            raise BadInput(f'{path} is nested more than {DEPTH_LIMIT} deep; flatten it.')


def load(model: type[Model], path: Path) -> Model:
    """
    Return a file's content, checked against its model.

    Raises
    ------
    BadInput
        One sentence on the first thing that is wrong: where, what, and how to write it.

    """
    content = load_yaml(path)
    if not isinstance(content, dict):
        raise BadInput(f'{path} holds no mapping of keys; compare it with a shipped file.')
    try:
        return model.model_validate(content)
    except ValidationError as error:
        raise BadInput(f'{path}: {sentence(error)}') from None


def sentence(error: ValidationError) -> str:
    """Return the first problem of a pydantic error as one sentence."""
    first = error.errors()[0]
    where = '.'.join(str(part) for part in first['loc']) or 'the file'
    if first['type'] == 'extra_forbidden':
        return f"the key '{where}' is not known; remove it or correct its spelling."
    if first['type'] == 'missing':
        return f"the key '{where}' is missing; add it."
    text = first['msg'].removeprefix('Value error, ')
    given = first.get('input')
    if first['type'] == 'value_error' or isinstance(given, dict | list):
        return f'{where} {text}.' if first['type'] == 'value_error' else f'{where}: {text}.'
    return f'{where} is {given!r}: {text[:1].lower()}{text[1:]}.'
