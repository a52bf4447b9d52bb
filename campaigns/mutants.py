"""
The mutants of a source file: one small change each, made by cosmic-ray.

An operator stays out where its mutants say nothing of the tests:

- `RemoveDecorator`: here decorators compile, cache or make a class of a list of fields.
- shifts, bits, `%`, `//` and `**` in place of arithmetic: a float raises TypeError at the first
  call, so whatever runs the line kills such a mutant, and the score would flatter.
- `is` in place of `==`, and comparisons other than the neighbour and the opposite.
- a number of 100 or more made one larger or smaller: tolerances are there to pass that.

A place stays out where no behaviour is decided: annotations and type aliases, the texts of
messages and exceptions, what `setting`, `EffectParameter` and `Field` declare, which the generated
pages repeat and test/contract compares, and guards against a mistake in the code itself:
`frozen=` and `slots=` of a dataclass, `strict=` of `zip`.
"""

import ast
from collections.abc import Iterator
from functools import cache
from typing import Any, Final, NamedTuple

COMPARED: Final = (
    ('Eq', 'NotEq'), ('NotEq', 'Eq'), ('Is', 'IsNot'), ('IsNot', 'Is'),
    ('Lt', 'LtE'), ('Lt', 'GtE'), ('LtE', 'Lt'), ('LtE', 'Gt'),
    ('Gt', 'GtE'), ('Gt', 'LtE'), ('GtE', 'Gt'), ('GtE', 'Lt'),
)  # fmt: skip
COMPUTED: Final = (
    ('Add', 'Sub'), ('Add', 'Mul'), ('Sub', 'Add'), ('Sub', 'Mul'),
    ('Mul', 'Div'), ('Mul', 'Add'), ('Div', 'Mul'), ('Div', 'Sub'),
    ('FloorDiv', 'Mul'), ('FloorDiv', 'Div'), ('Mod', 'Mul'), ('Mod', 'FloorDiv'),
    ('Pow', 'Mul'), ('Pow', 'Div'), ('LShift', 'RShift'), ('RShift', 'LShift'),
    ('BitAnd', 'BitOr'), ('BitOr', 'BitAnd'), ('BitXor', 'BitAnd'), ('BitXor', 'BitOr'),
)  # fmt: skip
OPERATORS: Final = (
    *(f'ReplaceComparisonOperator_{old}_{new}' for old, new in COMPARED),
    *(f'ReplaceBinaryOperator_{old}_{new}' for old, new in COMPUTED),
    'ReplaceUnaryOperator_USub_UAdd',
    'ReplaceUnaryOperator_Delete_Not',
    'AddNot',
    'ReplaceTrueWithFalse',
    'ReplaceFalseWithTrue',
    'ReplaceAndWithOr',
    'ReplaceOrWithAnd',
    'ReplaceBreakWithContinue',
    'ReplaceContinueWithBreak',
    'ExceptionReplacer',
    'NumberReplacer',
    'ZeroIterationForLoop',
)
LARGE: Final = 100
DECLARED: Final = ('setting', 'EffectParameter', 'Field', 'TypeVar')
GUARDS: Final = ('frozen', 'slots', 'strict')
MISSING: Final = (
    'cosmic-ray makes the mutants and is not here: '
    '.venv/bin/pip install -c constraints.txt -r requirements-mutation.txt'
)
Place = tuple[tuple[int, int], tuple[int, int]]  # begin and end, each line and column


class Spot(NamedTuple):
    """A place that an operator can change, and the how manieth of its places that is."""

    place: Place
    operator: str
    occurrence: int


def spots(source: str) -> Iterator[Spot]:
    """
    Yield where the mutants of a text can be made, always in the same order.

    Raises
    ------
    ModuleNotFoundError
        Where cosmic-ray is not installed.

    """
    from cosmic_ray.ast import ast_nodes, get_ast

    left_out, nodes = undecided(source), list(ast_nodes(get_ast(source)))
    for name in OPERATORS:
        places = (place for node in nodes for place in operator(name).mutation_positions(node))
        for occurrence, (begin, end) in enumerate(places):
            if not any(first <= begin and end <= last for first, last in left_out):
                yield Spot((begin, end), name, occurrence)


def mutant(source: str, spot: Spot) -> str:
    """Return the text with one change; empty where that leaves no Python or the same program."""
    from cosmic_ray.mutating import mutate_code

    text = mutate_code(source, operator(spot.operator), spot.occurrence) or ''
    try:
        same = ast.dump(ast.parse(text)) == ast.dump(ast.parse(source))
    except SyntaxError:
        return ''
    return '' if same else text


def changed(source: str, text: str) -> tuple[str, str]:
    """Return the first line that differs, before and after."""
    pairs = zip(source.splitlines(), text.splitlines(), strict=False)
    before, after = next((old, new) for old, new in pairs if old != new)
    return ' '.join(before.split()), ' '.join(after.split())


@cache
def operator(name: str) -> Any:
    """Return one of cosmic-ray's operators."""
    from cosmic_ray.plugins import get_operator

    return get_operator(f'core/{name}')()


def undecided(source: str) -> list[Place]:
    """Return the places where no behaviour is decided."""
    found: list[Place] = []
    for node in ast.walk(ast.parse(source)):
        match node:
            case ast.arg(annotation=ast.expr() as kept):
                found.append(place_of(kept))
            case ast.FunctionDef(returns=ast.expr() as kept):
                found.append(place_of(kept))
            case ast.AnnAssign():
                found.append(place_of(node.annotation))
            case ast.Raise() | ast.JoinedStr():
                found.append(place_of(node))
            case ast.Constant(value=int() | float() as number) if abs(number) >= LARGE:
                found.append(place_of(node))
            case ast.Call(func=ast.Name(id=name)) if name in DECLARED:
                found.append(place_of(node))
            case ast.Call(func=ast.Name(id='zip' | 'dataclass')):
                found += [place_of(one) for one in node.keywords if one.arg in GUARDS]
            case ast.Module():
                found += [place_of(one) for one in node.body if is_alias(one)]
    return found


def place_of(node: Any) -> Place:
    """Return where a node begins and ends."""
    return (node.lineno, node.col_offset), (node.end_lineno, node.end_col_offset)


def is_alias(node: ast.stmt) -> bool:
    """Tell whether a statement of a module names a type, such as `Kernel = One | Other`."""
    return isinstance(node, ast.Assign) and (
        isinstance(node.value, ast.Subscript)
        or (isinstance(node.value, ast.BinOp) and isinstance(node.value.op, ast.BitOr))
    )
