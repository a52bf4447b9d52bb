"""Convert pydantic errors to one sentence for people who write the files."""

from collections.abc import Mapping, Sequence
from typing import Any

from pydantic import ValidationError

# Messages by pydantic's type of error; braces are filled from the error's context
PLAIN = {
    'int_type': 'must be a whole number',
    'int_parsing': 'must be a whole number',
    'int_from_float': 'must be a whole number',
    'float_type': 'must be a number',
    'float_parsing': 'must be a number',
    'finite_number': 'must be finite',
    'bool_type': 'must be true or false',
    'bool_parsing': 'must be true or false',
    'string_type': 'must be text',
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
        if problem['type'] == 'extra_forbidden' and any(
            problem['loc'][:-1] == other['loc'][:-1] for other in missing
        ):
            continue
        lines.append(_format_problem(problem, problems))
    return lines


def _format_problem(first: Mapping[str, Any], problems: Sequence[Mapping[str, Any]]) -> str:
    """Return one problem as a sentence, taking the others into account."""
    where = locate_problem(first) or 'the file'
    if first['type'] == 'extra_forbidden':
        return f"the key '{where}' is not known; remove it or correct its spelling."
    if first['type'] == 'missing':
        # A misspelt key causes two errors at the same place: a missing and an unknown key
        for other in problems:
            if other['type'] == 'extra_forbidden' and other['loc'][:-1] == first['loc'][:-1]:
                return (
                    f"the key '{where}' is missing and '{locate_problem(other)}' is not known; "
                    f'correct its '
                    'spelling.'
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
    plain = PLAIN.get(problem['type'])
    if plain is None:
        return f'is not valid: {problem["msg"]}'
    numbers = {
        key: f'{value:g}' if isinstance(value, float) else value
        for key, value in problem.get('ctx', {}).items()
    }
    return plain.format(**numbers)
