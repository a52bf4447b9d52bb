"""
What we learn: bag tables, reports and the lta command.

For notebooks: `flight = lta_analysis.open('runs/.../bag')`, then `flight['odom']`; see
`lta_data.bag.recording`.
"""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from lta_data.bag.recording import open_recording as open

__all__ = ['open']


def __getattr__(name: str) -> object:
    """Return `open`, loaded when it is first asked for: the package itself imports nothing."""
    if name == 'open':
        from lta_data.bag.recording import open_recording

        return open_recording
    raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
