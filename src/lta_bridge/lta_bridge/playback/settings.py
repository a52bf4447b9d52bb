"""The parameters of the player."""

from lta_config.settings import setting, Settings

FOREVER = 1e9  # s: the end of any recording


class PlayerSettings(Settings):
    """What is played to whom, and how."""

    bag: str = setting('', 'The bag: a rosbag2 folder or an .mcap file.', fixed=True)
    robot: str = setting('', 'Robot in the bag; the own name, or the only one.', fixed=True)
    nodes: str = setting(
        '', 'Nodes that are run again, with spaces between; all where empty.', fixed=True
    )
    roles: str = setting(
        '', 'Other nodes whose recorded messages are played, with spaces between.', fixed=True
    )
    rate: float = setting(
        1.0, 'Bag seconds a wall second, in real time.', low=1e-3, high=1e6, fixed=True
    )
    start: float = setting(
        0.0,
        'Where to begin, after the first message.',
        unit='s',
        low=0.0,
        high=FOREVER,
        fixed=True,
    )
    end: float = setting(
        FOREVER, 'Where to end, after the first message.', unit='s', low=0.0, high=FOREVER,
        fixed=True,
    )  # fmt: skip
    loop: bool = setting(False, 'Whether to begin again at the end, in real time.', fixed=True)
    paused: bool = setting(False, 'Whether to begin with a pause.', fixed=True)
    answers: str = setting(
        '', "Folder of a bag for the nodes' answers; none if empty.", fixed=True
    )
    patience: float = setting(
        30.0, 'Wall time for the graph to come up, and for an answer in lockstep.', unit='s',
        low=0.1, high=3600.0, fixed=True,
    )  # fmt: skip
    record: bool = setting(False, 'Whether to wait for a recorder.', fixed=True)
