"""Parameters of the recorder: bag, topics, limits, and the origin to store in the bag."""

from lta_bridge.provenance import collect_provenance
from lta_config.settings import setting, Settings


class RobotOrigin(Settings):
    """The origin of a robot's data to store in the bag."""

    vehicle: str = setting('gtmab', fixed=True)
    """Vehicle name or file."""
    scenario: str = setting('lamp_room', fixed=True)
    """Scenario name or file."""
    gains: str = setting('gtmab', fixed=True)
    """Name or file of the controller's gains."""
    strategy: str = setting('homing', fixed=True)
    """Navigation strategy."""
    commanded: bool = setting(False, fixed=True)
    """Whether the drone flies by actions, whose goals are not in the bag."""
    seed: int = setting(1, low=0, high=2**31 - 1, fixed=True)
    """Random seed."""
    offset_x: float = setting(0.0, 'm', -1e3, 1e3, fixed=True)
    """Distance of the start position to the east of that in the scenario."""
    offset_y: float = setting(0.0, 'm', -1e3, 1e3, fixed=True)
    """Distance of the start position to the north of that in the scenario."""

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

    bag: str = setting('runs/bag', fixed=True)
    """Folder of the bag; must be empty or not exist yet."""
    robots: str = setting('', fixed=True)
    """
    Namespaces of the robots to record, separated by spaces; empty for that of the recorder. With
    several robots, parameters such as lta2.seed give the origin of each.
    """
    replay: str = setting('', fixed=True)
    """
    Path of the bag that is replayed; the new bag copies from it whether the data was simulated or
    measured (only with source:=replay).
    """
    topics: str = setting('', fixed=True)
    """
    Topics to record: relative or absolute names, separated by spaces; 'all' for every topic of the
    graph; empty for those marked as recorded in docs/topics.md.
    """
    queue_size: float = setting(64.0, 'MB', 1.0, 1e5, fixed=True)
    """Memory limit for messages that wait to be written to the disk."""
