# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Extract the source of plain functions, with everything they use, from their modules.

The text is what gets compiled and what the cache is keyed by, so that neither an edit of a
function nor of anything that it calls, in whichever file, can leave old physics behind.

Three constructs of plain Python that numba does not support are rewritten:

- a member of an `IntEnum` becomes its number;
- `value._replace(field=...)`, where `value` is an argument annotated with a named tuple, becomes a
  call of that type;
- an argument that is bound to an object (`SourceExtract(strategy=STRATEGIES['bag'])`) disappears
  from every function, and its attributes become functions and numbers of the source. A
  `GeneratedFunction` stands for a function that the caller adds to the source itself.
"""

import ast
import builtins
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from enum import IntEnum
from functools import cache
import inspect
import math
from pathlib import Path
from threading import Lock
from types import FunctionType, ModuleType
from typing import Any, final, NamedTuple, TypeGuard

from lta_config.errors import BadInput

TUPLE_PREFIX = 'core'  # prefix of the named tuples
REPLACE_METHOD = '_replace'
PARSING = Lock()  # Python 3.11 fails with SystemError if two threads parse (cpython issue 106905)


def _parse(source: bytes | str) -> ast.Module:
    with PARSING:
        return ast.parse(source)


@cache
def _read_definitions(path: Path, changed_ns: int, size: int) -> dict[str, ast.FunctionDef]:
    """
    Return the top-level functions of a file by name.

    Time and size are only keys: an edited file is read again.
    """
    del changed_ns, size
    return {
        node.name: _strip_annotations(node)
        for node in _parse(path.read_bytes()).body
        if isinstance(node, ast.FunctionDef)
    }


def _strip_annotations(node: ast.FunctionDef) -> ast.FunctionDef:
    """Return the function without annotations and decorators, which compiling ignores."""
    node.decorator_list, node.returns = [], None
    kinds = {}
    for argument in [*node.args.args, *node.args.posonlyargs, *node.args.kwonlyargs]:
        if isinstance(argument.annotation, ast.Name):
            kinds[argument.arg] = argument.annotation.id
        argument.annotation = None
    return _MarkReplace(kinds).visit(node)  # type: ignore[no-any-return]


class _MarkReplace(ast.NodeTransformer):
    """Turn `value._replace(field=...)` of an argument into `Kind(_replace, value, field=...)`."""

    def __init__(self, kinds: Mapping[str, str]) -> None:
        self._kinds = kinds

    def visit_Call(self, node: ast.Call) -> ast.AST:
        """Return the marked call."""
        self.generic_visit(node)
        called = node.func
        if (
            isinstance(called, ast.Attribute)
            and called.attr == REPLACE_METHOD
            and isinstance(called.value, ast.Name)
            and called.value.id in self._kinds
        ):
            kind = ast.Name(self._kinds[called.value.id], ast.Load())
            return ast.Call(
                kind, [ast.Name(REPLACE_METHOD, ast.Load()), called.value], node.keywords
            )
        return node


def _is_named_tuple(value: object) -> TypeGuard[type[Any]]:
    return isinstance(value, type) and issubclass(value, tuple) and hasattr(value, '_fields')


def _is_literal(value: object) -> bool:
    """Return whether a value is a number or a nested tuple of numbers."""
    if isinstance(value, tuple):
        return all(_is_literal(item) for item in value)
    return isinstance(value, bool | int | float)


class _Rewriter(NamedTuple):
    """Copies a part of a tree with the names and attributes of the extracted source."""

    names: Mapping[str, str]
    attributes: Mapping[str, str]  # source text of `Phase.REST` or `strategy.steer`
    fields: Mapping[str, tuple[str, ...]]  # of the named tuples, by name in the module
    bound: Collection[str]

    def copy(self, part: Any) -> Any:
        """Return the rewritten copy."""
        if isinstance(part, list):
            return [self.copy(each) for each in part if not self._is_bound(each)]
        if not isinstance(part, ast.AST):
            return part
        if isinstance(part, ast.Attribute) and isinstance(part.value, ast.Name):
            text = self.attributes.get(f'{part.value.id}.{part.attr}')
            if text is not None:
                return _parse(text).body[0].value  # type: ignore[attr-defined]
        if isinstance(part, ast.Call) and _is_marked(part):
            part = self._write_out_replace(part)
        if isinstance(part, ast.arguments):
            part = self._without_bound_defaults(part)
        new = {key: self.copy(value) for key, value in vars(part).items()}
        if isinstance(part, ast.Name):
            new['id'] = self.names.get(part.id, part.id)
        return type(part)(**new)

    def _is_bound(self, part: object) -> bool:
        """Return whether an item of a list is a bound argument, in a signature or a call."""
        if isinstance(part, ast.keyword):
            part = part.value
        name = part.arg if isinstance(part, ast.arg) else getattr(part, 'id', None)
        return name in self.bound

    def _write_out_replace(self, call: ast.Call) -> ast.Call:
        """Return `Kind(_replace, value, field=...)` as a call with all fields."""
        value, changed = call.args[1], {item.arg: item.value for item in call.keywords}
        items = [
            changed.get(name) or ast.Attribute(value, name, ast.Load())
            for name in self.fields[ast.unparse(call.func)]
        ]
        return ast.Call(call.func, items, [])

    def _without_bound_defaults(self, arguments: ast.arguments) -> ast.arguments:
        """Return arguments of which the bound ones have no default."""
        names = [item.arg for item in [*arguments.posonlyargs, *arguments.args]]
        pairs = zip(names[::-1], arguments.defaults[::-1], strict=False)
        left = [value for name, value in pairs if name not in self.bound][::-1]
        return ast.arguments(**{**vars(arguments), 'defaults': left})


def _is_marked(call: ast.Call) -> bool:
    """Return whether a call stands for `_replace`, see `_MarkReplace`."""
    first = call.args[0] if call.args else None
    return isinstance(first, ast.Name) and first.id == REPLACE_METHOD


@final
@dataclass(frozen=True, slots=True)
class GeneratedFunction:
    """A function that only exists in compiled source, under this name."""

    name: str

    def __call__(self, *arguments: object) -> Any:
        """Raise `TypeError`: there is no such function in Python."""
        raise TypeError(
            f'{self.name} exists only in compiled code and cannot be called from Python; call it '
            'only in functions that are compiled.'
        )


def _find_definition(function: FunctionType) -> ast.FunctionDef:
    """Return the syntax tree of a function, which is shared."""
    path = Path(inspect.getsourcefile(function) or '')
    state = path.stat()
    definitions = _read_definitions(path, state.st_mtime_ns, state.st_size)
    if function.__qualname__ in definitions:
        return definitions[function.__qualname__]
    raise BadInput(
        f'{function.__name__} cannot be compiled, because it is not defined at the top level of '
        f'{path}; move it there.'
    )


def _list_globals(node: ast.FunctionDef, variables: tuple[str, ...]) -> list[str]:
    """Return the sorted names that a function with these variables takes from its module."""
    names = [item for item in ast.walk(node) if isinstance(item, ast.Name)]
    # Variables of a comprehension are not in co_varnames
    bound = {item.id for item in names if isinstance(item.ctx, ast.Store)}
    return sorted({item.id for item in names} - bound - {*variables, REPLACE_METHOD})


def _list_attributes(node: ast.FunctionDef, name: str) -> list[str]:
    """Return the attributes of a name that a function uses."""
    return sorted(
        {
            item.attr
            for item in ast.walk(node)
            if isinstance(item, ast.Attribute) and getattr(item.value, 'id', None) == name
        }
    )


def _describe_clash(own: str) -> str:
    return f'Two functions or constants of the compiled code have the name {own}; rename one.'


class SourceExtract:
    """
    A growing text of functions without imports other than `math`.

    Each function is called `<prefix>_<name>` in it, and `prefix` also goes before the constants
    and functions that it uses. Where two files use a name for different things, the second is
    called `<prefix>_<file>_<name>`. Named tuples are called `core_<name>` under every prefix.

    Parameters
    ----------
    bound : object
        Arguments that are replaced by these objects, by name.

    """

    def __init__(self, **bound: object) -> None:
        self._pieces: dict[str, str] = {}
        self._owners: dict[str, object] = {}  # what each name stands for
        self._bound = bound

    def add_function(self, function: Callable[..., Any], prefix: str) -> str:
        """
        Add a function and everything it uses; return its name in the text.

        Raise `BadInput` if it uses anything but `math`, numbers and plain functions.
        """
        if not isinstance(function, FunctionType):
            raise BadInput(
                f'{function!r} of {prefix} cannot be compiled, because it is not a plain '
                'function; define it with def.'
            )
        node = _find_definition(function)
        own = self._claim_name(prefix, function.__name__, function.__module__, node)
        if own in self._pieces:
            return own
        names, attributes, fields = {}, {}, {}
        for name in _list_globals(node, function.__code__.co_varnames):
            value = function.__globals__.get(name)
            if isinstance(value, type) and issubclass(value, IntEnum):
                for member in _list_attributes(node, name):
                    attributes[f'{name}.{member}'] = str(int(value[member]))
                continue
            names[name] = self._add_global(function, name, prefix)
            if _is_named_tuple(value):
                fields[name] = value._fields
        code = function.__code__
        arguments = code.co_varnames[: code.co_argcount + code.co_kwonlyargcount]
        bound = [name for name in self._bound if name in arguments]
        for name in bound:
            for attribute in _list_attributes(node, name):
                text = self._add_bound(name, attribute)
                if text in code.co_varnames:
                    raise BadInput(
                        f'{function.__name__} of {function.__module__} has a variable {text}, '
                        f'but the compiled code uses this name for {name}.{attribute}; rename the '
                        'variable.'
                    )
                attributes[f'{name}.{attribute}'] = text
        copy = _Rewriter(names, attributes, fields, bound).copy(node)
        copy.name = own
        self._pieces[own] = ast.unparse(copy)
        return own

    def _add_bound(self, name: str, attribute: str) -> str:
        """Return what an attribute of a bound argument is called, having taken it along."""
        value = getattr(self._bound[name], attribute)
        if isinstance(value, GeneratedFunction):
            return value.name
        if isinstance(value, FunctionType):
            return self.add_function(value, name)
        if _is_literal(value):
            return self._render_literal(value)
        raise BadInput(
            f'{name}.{attribute} is {value!r}, which cannot be compiled; use a plain function, a '
            'number or a tuple of numbers.'
        )

    def _render_literal(self, value: Any) -> str:
        """Return the text of a number or a nest of tuples, whose types are added."""
        if isinstance(value, tuple):
            items = ''.join(f'{self._render_literal(item)}, ' for item in value)
            kind = self.add_named_tuple(type(value)) if hasattr(value, '_fields') else ''
            return f'{kind}({items})'
        if isinstance(value, IntEnum):
            return str(int(value))
        if isinstance(value, float) and not math.isfinite(value):
            # Not a literal of Python
            return 'math.nan' if math.isnan(value) else 'math.inf' if value > 0.0 else '-math.inf'
        # A number of numpy has a repr of its own
        return repr(float(value)) if isinstance(value, float) else repr(value)

    def add_named_tuple(self, kind: type[Any]) -> str:
        """Add a named tuple type and return its name in the text."""
        # One type for all prefixes: values pass between functions of different prefixes.
        own = f'{TUPLE_PREFIX}_{kind.__name__}'
        return self._add_piece(own, f'{own} = namedtuple({kind.__name__!r}, {kind._fields!r})')

    def _add_global(self, function: FunctionType, name: str, prefix: str) -> str:
        """Add a global and return its name in the text."""
        value = function.__globals__.get(name, getattr(builtins, name, None))
        # `math` and builtins such as min exist in compiled code under their own names
        if value is math or value is getattr(builtins, name, math):
            return name
        if isinstance(value, FunctionType):
            return self.add_function(value, prefix)
        # A function imported by `from math import ...`
        if getattr(math, getattr(value, '__name__', ''), None) is value:
            return f'math.{value.__name__}'  # type: ignore[union-attr]
        if _is_named_tuple(value):
            return self.add_named_tuple(value)
        if _is_literal(value):
            text = self._render_literal(value)
            own = self._claim_name(prefix, name, function.__module__, text)
            return self._add_piece(own, f'{own} = {text}')
        kind = 'a module' if isinstance(value, ModuleType) else repr(value)
        raise BadInput(
            f'{function.__module__}.{function.__name__} uses {name}, {kind}, which cannot be '
            'compiled; use only numbers, plain functions and the functions of the module math.'
        )

    def _claim_name(self, prefix: str, name: str, module: str, meaning: object) -> str:
        """Return the name in the text of what a module calls `name`."""
        for own in (f'{prefix}_{name}', f'{prefix}_{module.rpartition(".")[2]}_{name}'):
            if self._owners.setdefault(own, meaning) == meaning:
                return own
        raise BadInput(_describe_clash(own))

    def _add_piece(self, own: str, piece: str) -> str:
        """Store a piece under its name; two different pieces cannot share a name."""
        if self._pieces.setdefault(own, piece) != piece:
            raise BadInput(_describe_clash(own))
        return own

    def render_pieces(self, decorator: str, entry: str = '', entries: Collection[str] = ()) -> str:
        """Return all pieces, the functions with `decorator`, those in `entries` with `entry`."""
        return '\n\n\n'.join(
            f'{entry if own in entries else decorator}\n{piece}'
            if piece.startswith('def ')
            else piece
            for own, piece in self._pieces.items()
        )
