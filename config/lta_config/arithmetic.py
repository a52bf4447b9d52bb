"""Evaluate arithmetic in text, `7.3 / 8.4`: numbers, pi, + - * / ** and brackets."""

import ast
from collections.abc import Callable
import math
import operator
from typing import Final

BINARY: Final[dict[type[ast.operator], Callable[[float, float], float]]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: operator.pow,
}


def evaluate_expression(text: str) -> float:
    """Return the value of an arithmetic expression; raise `ValueError` if the text is not one."""
    try:
        # Only the node types below are evaluated, so a file cannot run code as with `eval`
        return _evaluate_node(ast.parse(text, mode='eval').body)
    except (SyntaxError, ZeroDivisionError, OverflowError):
        raise ValueError(_describe_misfit(text)) from None


def _evaluate_node(node: ast.expr) -> float:
    match node:
        case ast.Constant(value=int() | float() as number):
            return float(number)
        case ast.Name(id='pi'):
            return math.pi
        case ast.UnaryOp(op=ast.USub(), operand=inner):
            return -_evaluate_node(inner)
        case ast.BinOp(left=left, op=op, right=right) if type(op) in BINARY:
            return BINARY[type(op)](_evaluate_node(left), _evaluate_node(right))
    raise ValueError(_describe_misfit(ast.unparse(node)))


def _describe_misfit(text: str) -> str:
    return f'cannot evaluate "{text}"; use only numbers, pi, + - * / ** and brackets'
