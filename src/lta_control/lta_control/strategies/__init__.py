# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Registry of the navigation strategies."""

from importlib import import_module

from lta_config.errors import BadInput, unknown_name_error
from lta_config.python_file import is_strategy_file
from lta_control.strategies.protocol import NavigationStrategy
from lta_control.strategies.strategy_file import load_strategy_file

STRATEGY_MODULES = (  # such as homing.py, which has HOMING_STRATEGY
    'bearing_angle',
    'dither',
    'gradient',
    'homing',
)


def _import_strategy(file: str) -> NavigationStrategy:
    strategy = getattr(import_module(f'{__name__}.{file}'), f'{file.upper()}_STRATEGY')
    assert isinstance(strategy, NavigationStrategy)
    return strategy


STRATEGIES: dict[str, NavigationStrategy] = {
    made.name: made for made in map(_import_strategy, STRATEGY_MODULES)
}


def check_route(strategy: NavigationStrategy, lamps: int) -> None:
    """Raise `BadInput` for a strategy that cannot fly a route of several lamps."""
    if lamps > 1 and not strategy.arrives:
        able = [name for name, candidate in STRATEGIES.items() if candidate.arrives]
        raise BadInput(
            f'The strategy {strategy.name} never reports an arrival at a lamp, so it cannot fly '
            f'a route of {lamps} lamps; choose the strategy {" or ".join(able)}.'
        )


def find_navigation_strategy(name: str) -> NavigationStrategy:
    """Return a strategy by name or from a file ./NAME.py; raise `BadInput` for another one."""
    if is_strategy_file(name):
        return load_strategy_file(name)
    if name not in STRATEGIES:
        raise unknown_name_error('strategy', name, list(STRATEGIES))
    return STRATEGIES[name]
