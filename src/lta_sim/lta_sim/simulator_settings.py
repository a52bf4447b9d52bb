"""Settings of the simulator node."""

from lta_config.errors import unknown_name_error
from lta_config.settings import setting, Settings
from lta_config.topics import TopicTable
from lta_model.scenario import LARGEST_OFFSET

WAIT_FOR_DEFAULT = 'default'  # value of `wait_for`
DESCRIPTION = 'description'  # another: a role that reads nothing of the simulator's


class DroneSettings(Settings):
    """One drone and its flight."""

    vehicle: str = setting('gtmab', fixed=True)
    """Vehicle name or file."""
    scenario: str = setting('lamp_room', fixed=True)
    """Scenario name or file."""
    seed: int = setting(1, low=0, high=2**31 - 1, fixed=True)
    """Random seed."""
    strategy: str = setting('', fixed=True)
    """
    Navigation strategy. The power of its sensors and its computation is simulated. Empty: none.
    """
    offset_x: float = setting(0.0, 'm', -LARGEST_OFFSET, LARGEST_OFFSET, fixed=True)
    """Offset of the start position along x (east) from that of the scenario."""
    offset_y: float = setting(0.0, 'm', -LARGEST_OFFSET, LARGEST_OFFSET, fixed=True)
    """Offset of the start position along y (north) from that of the scenario."""
    commanded: bool = setting(False, fixed=True)
    """
    Whether the flight is commanded by actions: then neither a reached lamp nor the time limit of
    the scenario ends it.
    """


class SimulatorSettings(DroneSettings):
    """Parameters of the simulator node."""

    robots: str = setting('', fixed=True)
    """
    Namespaces of the drones, separated by spaces; empty for one, in that of the simulator. With
    several, parameters such as lta2.seed are those of each drone.
    """
    wait_for: str = setting(WAIT_FOR_DEFAULT, fixed=True)
    """
    Nodes to wait for before the flight starts, by their roles in the topic table and separated by
    spaces; empty: none. "default": in lockstep every node that reads an output of the simulator by
    the topic table, in real time none. "description": the publishers of URDF, scene and fixed
    frames.
    """
    record: bool = setting(False, fixed=True)
    """Whether the simulator waits for a recorder before it starts the flight."""
    topics: str = setting('', fixed=True)
    """Topics that the recorder records; must equal the setting of the recorder."""

    def list_awaited_roles(self, table: TopicTable, *, lockstep: bool) -> set[str]:
        """Return the roles to wait for; raise `BadInput` for an unknown one."""
        names = set(self.wait_for.split())
        roles = [WAIT_FOR_DEFAULT, DESCRIPTION, *table.roles]
        for name in sorted(names.difference(roles)):
            raise unknown_name_error('role in wait_for', name, roles)
        if WAIT_FOR_DEFAULT in names and lockstep:
            outputs = table.published_by('vehicle')
            names.update(role for name in outputs for role in table[name].subscribers)
        return names - {WAIT_FOR_DEFAULT}
