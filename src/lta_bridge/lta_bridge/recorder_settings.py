"""What a recorder is told: where to write, what to take, and what the bag says of its origin."""

from lta_bridge.provenance import collect_provenance
from lta_config.settings import setting, Settings


class RobotOrigin(Settings):
    """What the bag says of a robot's origin."""

    vehicle: str = setting('gtmab', 'Vehicle name or file.', fixed=True)
    scenario: str = setting('lamp_room', 'Scenario name or file.', fixed=True)
    gains: str = setting('gtmab', "Name or file of the controller's gains.", fixed=True)
    strategy: str = setting('bag', 'Navigation strategy.', fixed=True)
    seed: int = setting(1, 'Seed of all chance.', low=0, high=2**31 - 1, fixed=True)
    offset_x: float = setting(
        0.0, "Start, east of the scenario's.", unit='m', low=-1e3, high=1e3, fixed=True
    )
    offset_y: float = setting(
        0.0, "Start, north of the scenario's.", unit='m', low=-1e3, high=1e3, fixed=True
    )

    def to_provenance(self, *, lockstep: bool) -> dict[str, str]:
        """Return the origin as the bag tells it."""
        moved = {'offset_x': self.offset_x, 'offset_y': self.offset_y}
        return collect_provenance(
            self.vehicle,
            self.scenario,
            self.gains,
            strategy=self.strategy,
            seed=str(self.seed),
            time='lockstep' if lockstep else 'realtime',
            **{name: str(value) for name, value in moved.items() if value},
        )


class RecorderSettings(RobotOrigin):
    """Where to, what, and what the bag says of its origin."""

    bag: str = setting('bag', 'Folder of the bag; it must not exist yet or be empty.', fixed=True)
    robots: str = setting(
        '',
        'Namespaces of the robots to record, with spaces between; the own one where empty. Of '
        'several, lta2.seed and so on tell the origin of each.',
        fixed=True,
    )
    replay: str = setting(
        '', 'With source:=replay, what is played; the bag then tells its origin.', fixed=True
    )
    topics: str = setting(
        '',
        "What to record: names, relative or absolute, with spaces between; 'all' for whatever is "
        'on the graph; what the topic table marks where empty.',
        fixed=True,
    )
    split_size: float = setting(
        0.0, 'Size at which the next file begins; 0 is never.', unit='MB', low=0.0, high=1e6,
        fixed=True,
    )  # fmt: skip
    split_duration: float = setting(
        0.0, 'Time after which the next file begins; 0 is never.', unit='s', low=0.0, high=1e6,
        fixed=True,
    )  # fmt: skip
    snapshot: float = setting(
        0.0,
        'How much to keep in memory until recorder/snapshot or a fault asks for it; 0 records '
        'everything to the disk.',
        unit='s',
        low=0.0,
        high=1e5,
        fixed=True,
    )
    snapshot_size: float = setting(
        200.0, 'Most memory of snapshots, compressed.', unit='MB', low=1.0, high=1e5, fixed=True
    )
    queue_size: float = setting(
        64.0, 'Most memory of messages that wait for the disk.', unit='MB', low=1.0, high=1e5,
        fixed=True,
    )  # fmt: skip
