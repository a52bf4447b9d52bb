"""
Open recordings in notebooks.

Use `flight = lta_analysis.open('runs/.../bag')`, then `flight['odom']`; see
`lta_data.bag.recording`.
"""

from typing import TYPE_CHECKING

# Type checkers and editors see the function without the import at run time
if TYPE_CHECKING:
    from lta_data.bag.recording import open_recording as open

__all__ = ['open']


def __getattr__(name: str) -> object:
    """Return `open`, imported at its first use."""
    if name == 'open':
        # A lazy import keeps `import lta_analysis` fast: readers of bags load numpy
        from lta_data.bag.recording import open_recording

        return open_recording
    # The message of Python for a missing attribute of a module
    raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
