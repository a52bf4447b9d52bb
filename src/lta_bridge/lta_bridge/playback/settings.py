"""The parameters of the player."""

from lta_config.settings import setting, Settings

FOREVER = 1e9  # s: the end of any recording


class PlayerSettings(Settings):
    """Parameters of the player node."""

    bag: str = setting('', 'The bag: a rosbag2 folder or an .mcap file.', fixed=True)
    robot: str = setting(
        '',
        "Robot in the bag; empty for the player's own namespace, or the only robot.",
        fixed=True,
    )
    nodes: str = setting('', 'Nodes to run again, separated by spaces; empty for all.', fixed=True)
    roles: str = setting(
        '', 'Other nodes whose recorded messages to play, separated by spaces.', fixed=True
    )
    rate: float = setting(
        1.0,
        'Playback rate in real time: bag seconds per wall second.',
        low=1e-3,
        high=1e6,
        fixed=True,
    )
    start: float = setting(
        0.0,
        'Start of the played section, after the first message.',
        unit='s',
        low=0.0,
        high=FOREVER,
        fixed=True,
    )
    end: float = setting(
        FOREVER, 'End of the played section, after the first message.', unit='s',
        low=0.0, high=FOREVER, fixed=True,
    )  # fmt: skip
    loop: bool = setting(False, 'Whether to repeat the section, in real time.', fixed=True)
    paused: bool = setting(False, 'Whether to start paused.', fixed=True)
    answers: str = setting(
        '', "Folder of a bag for the nodes' answers; none if empty.", fixed=True
    )
    patience: float = setting(
        30.0, 'Wall time for the graph to come up, and for an answer in lockstep.', unit='s',
        low=0.1, high=3600.0, fixed=True,
    )  # fmt: skip
    record: bool = setting(False, 'Whether to wait for a recorder.', fixed=True)
