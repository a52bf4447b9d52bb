# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Load a navigation strategy from the user's own Python file."""

from dataclasses import replace
from functools import cache
import math
from pathlib import Path
from typing import Any, Final

from lta_config.errors import BadInput
from lta_config.python_file import describe_python_error, PYTHON_SUFFIX, run_python_file
from lta_control.strategies.protocol import LightMeasurement, NavigationStrategy, SteeringCommand
from lta_control.strategies.settings import StrategySettings

TRIAL_DIODES: Final = 8  # of the trial's light
# What every strategy must answer: no light, light to the left, light ahead after a while
TRIAL: Final = tuple(
    LightMeasurement(seen, bearing, 0.2, (amplitude,) * TRIAL_DIODES, interval, 0.1, amplitude)
    for seen, bearing, amplitude, interval in (
        (False, 0.0, 0.0, 0.1), (True, 0.5, 20.0, 0.1), (True, -0.1, 40.0, 5.0),
    )
)  # fmt: skip


def load_strategy_file(name: str) -> NavigationStrategy:
    """
    Return the `STRATEGY` of a Python file, named like the file.

    Raise `BadInput` if the file cannot be read or run, or what it defines is not a strategy.
    """
    path = Path(name)
    if path.suffix != PYTHON_SUFFIX:
        raise BadInput(
            f"The strategy '{name}' is not a Python file; name a file that ends in .py."
        )
    try:
        changed = path.stat()
    except OSError as error:
        raise BadInput(
            f"The strategy '{name}' cannot be read: {error.strerror}; check its path."
        ) from None
    return _load_cached(path.absolute(), changed.st_mtime_ns, changed.st_size)


@cache
def _load_cached(path: Path, changed_ns: int, size: int) -> NavigationStrategy:
    """Return the strategy of a file; its time and size are only keys of the cache."""
    del changed_ns, size
    strategy = getattr(run_python_file(path, 'a strategy'), 'STRATEGY', None)
    if not isinstance(strategy, NavigationStrategy):
        raise BadInput(
            f"'{path}' defines no strategy; end it with STRATEGY = NavigationStrategy("
            f"'{path.stem}', start, steer), as docs/strategies.md shows."
        )
    try:
        _try_strategy(strategy)
    except BadInput as error:
        raise BadInput(f"The strategy '{path}' {error}") from None
    except Exception as error:
        raise BadInput(
            f"The strategy '{path}' fails on a trial: {describe_python_error(error, path)}; "
            'correct it.'
        ) from error
    return replace(strategy, name=path.stem, file=f'{path}')


def explain_failure(strategy: NavigationStrategy, error: BaseException) -> BadInput:
    """Return the sentence about an error of a strategy from a file in flight."""
    reason = describe_python_error(error, Path(strategy.file))
    return BadInput(f"The strategy '{strategy.file}' fails in flight: {reason}; correct it.")


def _try_strategy(strategy: NavigationStrategy) -> None:
    """Run a strategy on a few blocks of light; raise `BadInput` for a wrong result."""
    settings = StrategySettings()
    memory = _check_memory('start', strategy.start(0.2))
    for sight in TRIAL:
        memory = _check_memory('watch', strategy.watch(settings, memory, sight))
        answer = strategy.steer(settings, memory, sight)
        if not isinstance(answer, tuple) or len(answer) != 2:
            raise BadInput(
                f'returns {answer!r} from steer; let it return a SteeringCommand and the memory.'
            )
        course, memory = answer
        _check_course(course)
        _check_memory('steer', memory)
    _check_memory('onward', strategy.onward(memory))
    if not isinstance(distance := strategy.distance(memory), float):
        raise BadInput(f'returns {distance!r} from distance; let it return a float.')


def _check_memory(function: str, memory: Any) -> tuple[Any, ...]:
    """Return a memory that begins with a heading."""
    first = memory[0] if isinstance(memory, tuple) and memory else None
    if not isinstance(first, float) or not math.isfinite(first):
        raise BadInput(
            f'returns the memory {memory!r} from {function}; let it be a tuple of floats that '
            'begins with the commanded heading.'
        )
    return memory  # type: ignore[no-any-return]


def _check_course(course: object) -> None:
    """Refuse a course that is not a finite heading and speed."""
    if not isinstance(course, SteeringCommand) or not all(
        isinstance(number, float | int) and math.isfinite(number) for number in course[:2]
    ):
        raise BadInput(
            f'returns the course {course!r} from steer; let it be a SteeringCommand of a finite '
            'heading and speed.'
        )
