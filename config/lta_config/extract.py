"""
Take the source of plain functions, with all that they use, out of their modules.

The text is what gets compiled and what the cache is keyed by, so that neither an edit of a
function nor of anything that it calls, in whichever file, can leave old physics behind.
"""

import ast
import builtins
from collections.abc import Callable, Collection
import copy
from functools import cache
import inspect
import math
from pathlib import Path
from types import FunctionType, ModuleType
from typing import Any

from lta_config.errors import BadInput


@cache
def _definitions(path: Path, changed_ns: int, size: int) -> dict[str, ast.FunctionDef]:
    """Return the functions at the top of a file as it stood at that time."""
    tree = ast.parse(path.read_text(encoding='utf-8'))
    return {node.name: node for node in tree.body if isinstance(node, ast.FunctionDef)}


def _definition(function: FunctionType) -> ast.FunctionDef:
    """Return the syntax tree of a function at the top of its module."""
    path = Path(inspect.getsourcefile(function) or '')
    file = path.stat()
    node = _definitions(path, file.st_mtime_ns, file.st_size).get(function.__qualname__)
    if node is not None:
        return copy.deepcopy(node)
    raise BadInput(
        f'No function {function.__name__} stands at the top of {path}; define it there.'
    )


def _bare(node: ast.FunctionDef) -> ast.FunctionDef:
    """Return the function without annotations and decorators, which mean nothing compiled."""
    node.decorator_list, node.returns = [], None
    for argument in [*node.args.args, *node.args.posonlyargs, *node.args.kwonlyargs]:
        argument.annotation = None
    return node


def _literal(value: object) -> bool:
    """Return whether a value is a number or a tuple of such."""
    if isinstance(value, tuple):
        return all(_literal(item) for item in value)
    return isinstance(value, bool | int | float)


class _Rename(ast.NodeTransformer):
    """Give every global of a function its name in the extracted text."""

    def __init__(self, names: dict[str, str]) -> None:
        self._names = names

    def visit_Name(self, node: ast.Name) -> ast.AST:
        """Return the name as the text knows it."""
        return ast.Name(self._names.get(node.id, node.id), node.ctx)


class Extract:
    """
    A growing text of functions without imports other than `math`.

    Each function is called `<prefix>_<name>` in it, and `prefix` also goes before the constants
    and functions that it uses, so that files may use the same names for different things.
    """

    def __init__(self) -> None:
        self._pieces: dict[str, str] = {}

    def add(self, function: Callable[..., Any], prefix: str) -> str:
        """
        Take a function and all that it uses; return its name in the text.

        Raises
        ------
        BadInput
            If it uses something other than `math`, numbers and plain functions.

        """
        if not isinstance(function, FunctionType):
            raise BadInput(f'{function!r} of {prefix} is no plain function; write it with def.')
        own = f'{prefix}_{function.__name__}'
        node = _bare(_definition(function))
        names_in = [item for item in ast.walk(node) if isinstance(item, ast.Name)]
        # What a comprehension binds is in no list of the function's own variables.
        local = {item.id for item in names_in if isinstance(item.ctx, ast.Store)}
        local.update(function.__code__.co_varnames)
        used = {item.id for item in names_in} - local
        names = {name: self._global(function, name, prefix) for name in sorted(used)}
        _Rename(names).visit(node)
        node.name = own
        return self._put(own, ast.unparse(node))

    def _global(self, function: FunctionType, name: str, prefix: str) -> str:
        """Return what a global is called in the text, having taken it along."""
        value = function.__globals__.get(name, getattr(builtins, name, None))
        own = f'{prefix}_{name}'
        if value is math or value is getattr(builtins, name, math):
            return name
        if isinstance(value, FunctionType):
            return self.add(value, prefix)
        if getattr(math, getattr(value, '__name__', ''), None) is value:
            return f'math.{value.__name__}'  # type: ignore[union-attr]
        if isinstance(value, type) and issubclass(value, tuple) and hasattr(value, '_fields'):
            return self._put(own, f'{own} = namedtuple({value.__name__!r}, {value._fields!r})')
        if _literal(value):
            return self._put(own, f'{own} = {value!r}')
        kind = 'a module' if isinstance(value, ModuleType) else repr(value)
        raise BadInput(
            f'{function.__module__}.{function.__name__} uses {name}, {kind}, which cannot be '
            'compiled; use math, numbers and plain functions only.'
        )

    def _put(self, own: str, piece: str) -> str:
        """Keep a piece under its name; two different ones cannot share it."""
        if self._pieces.setdefault(own, piece) != piece:
            raise BadInput(f'Two different things are called {own} in the kernel; rename one.')
        return own

    def mentions(self, prefix: str, text: str) -> bool:
        """Tell whether a text stands in the pieces of one prefix."""
        return any(
            text in piece for own, piece in self._pieces.items() if own.startswith(f'{prefix}_')
        )

    def text(self, decorator: str, entry: str = '', entries: Collection[str] = ()) -> str:
        """Return all pieces, the functions under `decorator`, some under `entry` instead."""
        return '\n\n\n'.join(
            f'{entry if own in entries else decorator}\n{piece}'
            if piece.startswith('def ')
            else piece
            for own, piece in self._pieces.items()
        )
