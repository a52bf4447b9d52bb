"""The parameters of the player."""

from lta_config.errors import BadInput
from lta_config.settings import setting, Settings

FOREVER = 1e9  # s: the end of any recording


class PlayerSettings(Settings):
    """Parameters of the player node."""

    bag: str = setting('', 'The bag: a rosbag2 folder or an .mcap file.', fixed=True)
    robot: str = setting(
        '',
        "Namespace of the robot in the bag to play; empty for the player's own namespace, or for "
        'the only robot of the bag.',
        fixed=True,
    )
    nodes: str = setting(
        '',
        'Nodes to run again, separated by spaces; their recorded messages are not played. If '
        'empty, all run again.',
        fixed=True,
    )
    roles: str = setting(
        '',
        'Nodes whose recorded messages are played in addition to those of the vehicle, separated '
        'by spaces.',
        fixed=True,
    )
    rate: float = setting(
        1.0,
        'Playback speed in real time: seconds of the bag per second; no effect in lockstep.',
        low=1e-3,
        high=1e6,
        fixed=True,
    )
    start: float = setting(
        0.0,
        'Start of the section to play, counted from the first message.',
        unit='s',
        low=0.0,
        high=FOREVER,
        fixed=True,
    )
    end: float = setting(
        FOREVER, 'End of the section to play, counted from the first message.', unit='s',
        low=0.0, high=FOREVER, fixed=True,
    )  # fmt: skip
    answers: str = setting(
        '',
        'Folder of a new bag with the messages of the nodes that run again; empty for no bag.',
        fixed=True,
    )
    patience: float = setting(
        30.0, 'How long to wait for the nodes to start, and in lockstep for an answer.', unit='s',
        low=0.1, high=3600.0, fixed=True,
    )  # fmt: skip
    record: bool = setting(False, 'Whether playback waits until a recorder runs.', fixed=True)


def check_playback(settings: PlayerSettings) -> None:
    """Raise `BadInput` without a bag."""
    if not settings.bag:
        raise BadInput('The player has no bag to play; name one, as in bag:=runs/flight/bag.')
