"""
Extract the source of plain functions, with everything they use, from their modules.

The text is compiled and is the key of the cache, so an edit of a function, or of anything it calls
in any file, never runs stale code.
"""

import ast
import builtins
from collections.abc import Callable, Collection, Mapping
from functools import cache
import inspect
import math
from pathlib import Path
from types import FunctionType, ModuleType
from typing import Any, NamedTuple

from lta_config.errors import BadInput


@cache
def _parse_definitions(path: Path, changed_ns: int, size: int) -> dict[str, ast.FunctionDef]:
    """Return the top-level functions of a file, without annotations."""
    # Time and size are only keys of the cache: an edited file is parsed again
    tree = ast.parse(path.read_text(encoding='utf-8'))
    return {
        node.name: _strip_annotations(node)
        for node in tree.body
        if isinstance(node, ast.FunctionDef)
    }


def _strip_annotations(node: ast.FunctionDef) -> ast.FunctionDef:
    """Return the function without annotations and decorators, which compiling ignores."""
    node.decorator_list, node.returns = [], None
    for argument in [*node.args.args, *node.args.posonlyargs, *node.args.kwonlyargs]:
        argument.annotation = None
    return node


def _is_literal(value: object) -> bool:
    """Return whether a value is a number or a nested tuple of numbers."""
    if isinstance(value, tuple):
        return all(_is_literal(item) for item in value)
    return isinstance(value, bool | int | float)


def _rename_names(part: Any, names: Mapping[str, str]) -> Any:  # noqa: ANN401 - any field of a node
    """Return a copy of a syntax tree with names replaced."""
    if isinstance(part, list):
        return [_rename_names(each, names) for each in part]
    if not isinstance(part, ast.AST):
        return part
    # A copy, because the parsed tree is shared through the cache
    new = {key: _rename_names(value, names) for key, value in vars(part).items()}
    if isinstance(part, ast.Name):
        new['id'] = names.get(part.id, part.id)
    return type(part)(**new)


class _FunctionSource(NamedTuple):
    """Where a function is defined: its name, its file and the file's state."""

    path: Path
    changed_ns: int
    size: int
    name: str

    @property
    def node(self) -> ast.FunctionDef:
        """The function's syntax tree, which is shared."""
        return _parse_definitions(self.path, self.changed_ns, self.size)[self.name]


def _locate_source(function: FunctionType) -> _FunctionSource:
    """Return where a function is defined."""
    path = Path(inspect.getsourcefile(function) or '')
    file = path.stat()
    source = _FunctionSource(path, file.st_mtime_ns, file.st_size, function.__qualname__)
    if source.name in _parse_definitions(path, file.st_mtime_ns, file.st_size):
        return source
    raise BadInput(f'{function.__name__} is not at the top level of {path}; define it there.')


@cache
def _list_globals(source: _FunctionSource, variables: tuple[str, ...]) -> list[str]:
    """Return the sorted names that a function with these variables takes from its module."""
    names = [item for item in ast.walk(source.node) if isinstance(item, ast.Name)]
    # Variables of a comprehension are not in co_varnames
    bound = {item.id for item in names if isinstance(item.ctx, ast.Store)}
    return sorted({item.id for item in names} - bound - {*variables})


@cache
def _render_function(source: _FunctionSource, own: str, names: tuple[tuple[str, str], ...]) -> str:
    """Return the text of a function under a new name, with its globals renamed."""
    node = _rename_names(source.node, dict(names))
    node.name = own
    return ast.unparse(node)


class SourceExtract:
    """
    A growing text of functions without imports other than `math`.

    Each function is called `<prefix>_<name>` in it. The constants and functions that it uses get
    the same prefix, so that different modules may use the same names.
    """

    def __init__(self) -> None:
        self._pieces: dict[str, str] = {}

    def add_function(self, function: Callable[..., Any], prefix: str) -> str:
        """
        Add a function and everything it uses; return its name in the text.

        Raises
        ------
        BadInput
            If it uses anything but `math`, numbers and plain functions.

        """
        if not isinstance(function, FunctionType):
            raise BadInput(f'{function!r} of {prefix} is not a plain function; write it with def.')
        own = f'{prefix}_{function.__name__}'
        source = _locate_source(function)
        names = {
            name: self._add_global(function, name, prefix)
            for name in _list_globals(source, function.__code__.co_varnames)
        }
        return self._add_piece(own, _render_function(source, own, tuple(names.items())))

    def _add_global(self, function: FunctionType, name: str, prefix: str) -> str:
        """Add a global and return its name in the text."""
        value = function.__globals__.get(name, getattr(builtins, name, None))
        own = f'{prefix}_{name}'
        # `math` and builtins such as min exist in compiled code under their own names
        if value is math or value is getattr(builtins, name, math):
            return name
        if isinstance(value, FunctionType):
            return self.add_function(value, prefix)
        # A function imported by `from math import ...`
        if getattr(math, getattr(value, '__name__', ''), None) is value:
            return f'math.{value.__name__}'  # type: ignore[union-attr]
        # Methods of a NamedTuple class are lost; compiled code only needs the fields
        if isinstance(value, type) and issubclass(value, tuple) and hasattr(value, '_fields'):
            return self._add_piece(
                own, f'{own} = namedtuple({value.__name__!r}, {value._fields!r})'
            )
        if _is_literal(value):
            return self._add_piece(own, f'{own} = {value!r}')
        kind = 'a module' if isinstance(value, ModuleType) else repr(value)
        raise BadInput(
            f'{function.__module__}.{function.__name__} uses {name}, {kind}, which cannot be '
            'compiled; use math, numbers and plain functions only.'
        )

    def _add_piece(self, own: str, piece: str) -> str:
        """Store a piece under its name; two different pieces cannot share a name."""
        if self._pieces.setdefault(own, piece) != piece:
            raise BadInput(f'Two different things are called {own} in the kernel; rename one.')
        return own

    def has_text(self, prefix: str, text: str) -> bool:
        """Return whether a text occurs in the pieces of one prefix."""
        return any(
            text in piece for own, piece in self._pieces.items() if own.startswith(f'{prefix}_')
        )

    def render(self, decorator: str, entry: str = '', entries: Collection[str] = ()) -> str:
        """Return all pieces, the functions with `decorator`, those in `entries` with `entry`."""
        return '\n\n\n'.join(
            f'{entry if own in entries else decorator}\n{piece}'
            if piece.startswith('def ')
            else piece
            for own, piece in self._pieces.items()
        )
