"""
Open recordings, simulate, sweep, discover and forecast in notebooks.

Use `flight = lta_analysis.open()`, then `flight['odom']`; see `lta_data.bag.recorded_flight`.
`simulate`, `sweep`, `discover` and `forecast` are in `lta_analysis.flights`.
"""

from importlib import import_module
from typing import TYPE_CHECKING

# Type checkers and editors see the functions without the imports at run time
if TYPE_CHECKING:
    from lta_analysis.flights import discover, forecast, simulate, sweep
    from lta_data.bag.recorded_flight import open_flight as open

__all__ = ['discover', 'forecast', 'open', 'simulate', 'sweep']


def __getattr__(name: str) -> object:
    """Return a function of `__all__`, imported at its first use."""
    # Lazy imports keep `import lta_analysis` fast: readers of bags load numpy, flights numba
    if name == 'open':
        from lta_data.bag.recorded_flight import open_flight

        return open_flight
    if name in __all__:
        return getattr(import_module('lta_analysis.flights'), name)
    # The message of Python for a missing attribute of a module
    raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
