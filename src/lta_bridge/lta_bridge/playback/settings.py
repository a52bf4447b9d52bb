"""The parameters of the player."""

from lta_config.errors import BadInput
from lta_config.settings import setting, Settings

FOREVER = 1e9  # s: the end of any recording


class PlayerSettings(Settings):
    """Parameters of the player node."""

    bag: str = setting('', fixed=True)
    """The bag: a rosbag2 folder or an .mcap file."""
    robot: str = setting('', fixed=True)
    """
    Namespace of the robot in the bag to play; empty for the player's own namespace, or for the
    only robot of the bag.
    """
    nodes: str = setting('', fixed=True)
    """
    Nodes to run again, separated by spaces; their recorded messages are not played. If empty, all
    run again.
    """
    roles: str = setting('', fixed=True)
    """
    Nodes whose recorded messages are played in addition to those of the vehicle, separated by
    spaces.
    """
    rate: float = setting(1.0, low=1e-3, high=1e6, fixed=True)
    """Playback speed in real time: seconds of the bag per second; no effect in lockstep."""
    start: float = setting(0.0, 's', 0.0, FOREVER, fixed=True)
    """Start of the section to play, counted from the first message."""
    end: float = setting(FOREVER, 's', 0.0, FOREVER, fixed=True)
    """End of the section to play, counted from the first message."""
    answers: str = setting('', fixed=True)
    """Folder of a new bag for what the nodes that run again publish; empty for no bag."""
    patience: float = setting(30.0, 's', 0.1, 3600.0, fixed=True)
    """How long to wait for the nodes to start, and in lockstep for an answer."""
    record: bool = setting(False, fixed=True)
    """Whether playback waits until a recorder runs."""


def check_playback(settings: PlayerSettings) -> None:
    """Raise `BadInput` without a bag."""
    if not settings.bag:
        raise BadInput('The player has no bag to play; name one, as in bag:=runs/flight/bag.')
