"""Parameters of the recorder: bag, topics, limits, and the origin to store in the bag."""

from lta_bridge.provenance import collect_provenance
from lta_config.settings import setting, Settings


class RobotOrigin(Settings):
    """The origin of a robot's data to store in the bag."""

    vehicle: str = setting('gtmab', 'Vehicle name or file.', fixed=True)
    scenario: str = setting('lamp_room', 'Scenario name or file.', fixed=True)
    gains: str = setting('gtmab', "Name or file of the controller's gains.", fixed=True)
    strategy: str = setting('homing', 'Navigation strategy.', fixed=True)
    commanded: bool = setting(
        False, 'Whether the drone flies by actions, whose goals are not in the bag.', fixed=True
    )
    seed: int = setting(1, 'Random seed.', low=0, high=2**31 - 1, fixed=True)
    offset_x: float = setting(
        0.0,
        'Distance of the start position to the east of that in the scenario.',
        unit='m',
        low=-1e3,
        high=1e3,
        fixed=True,
    )
    offset_y: float = setting(
        0.0,
        'Distance of the start position to the north of that in the scenario.',
        unit='m',
        low=-1e3,
        high=1e3,
        fixed=True,
    )

    def to_provenance(self, *, lockstep: bool) -> dict[str, str]:
        """Return the origin as it is stored in the bag."""
        moved = {'offset_x': self.offset_x, 'offset_y': self.offset_y}
        return collect_provenance(
            self.vehicle,
            self.scenario,
            self.gains,
            strategy=self.strategy,
            seed=str(self.seed),
            time='lockstep' if lockstep else 'realtime',
            **({'commanded': 'true'} if self.commanded else {}),
            **{name: str(value) for name, value in moved.items() if value},
        )


class RecorderSettings(RobotOrigin):
    """Parameters of the recorder node."""

    bag: str = setting(
        'runs/bag', 'Folder of the bag; must be empty or not exist yet.', fixed=True
    )
    robots: str = setting(
        '',
        'Namespaces of the robots to record, separated by spaces; empty for that of the recorder. '
        'With several robots, parameters such as lta2.seed give the origin of each.',
        fixed=True,
    )
    replay: str = setting(
        '',
        'Path of the bag that is replayed; the new bag copies from it whether the data was '
        'simulated or measured (only with source:=replay).',
        fixed=True,
    )
    topics: str = setting(
        '',
        "Topics to record: relative or absolute names, separated by spaces; 'all' for every topic "
        'of the graph; empty for those marked as recorded in docs/topics.md.',
        fixed=True,
    )
    split_size: float = setting(
        0.0, 'File size at which the recorder starts a new file; 0 for a single file.', unit='MB',
        low=0.0, high=1e6, fixed=True,
    )  # fmt: skip
    split_duration: float = setting(
        0.0, 'Duration after which the recorder starts a new file; 0 for a single file.', unit='s',
        low=0.0, high=1e6, fixed=True,
    )  # fmt: skip
    queue_size: float = setting(
        64.0, 'Memory limit for messages that wait to be written to the disk.', unit='MB',
        low=1.0, high=1e5, fixed=True,
    )  # fmt: skip
