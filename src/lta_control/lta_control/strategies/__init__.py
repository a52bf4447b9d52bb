"""Navigation strategies by name."""

from lta_config.errors import unknown
from lta_control.strategies import bearing_angle
from lta_control.strategies.protocol import Strategy

STRATEGIES: dict[str, Strategy] = {'bag': bearing_angle.STRATEGY}


def strategy(name: str) -> Strategy:
    """Return a strategy; an unknown name is a `BadInput` that lists the known ones."""
    if name not in STRATEGIES:
        raise unknown('strategy', name, list(STRATEGIES))
    return STRATEGIES[name]
