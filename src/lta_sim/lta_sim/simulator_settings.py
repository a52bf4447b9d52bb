"""Settings of the simulator node."""

from lta_config.settings import setting, Settings
from lta_model.scenario import LARGEST_OFFSET

WAIT_FOR_DEFAULT = 'default'  # value of `wait_for`
# Another: a node that publishes once, so that nobody waits for more
WAIT_FOR_DESCRIPTION = 'description'


class SimulatorSettings(Settings):
    """Parameters of the simulator node."""

    vehicle: str = setting('gtmab', 'Vehicle name or file.', fixed=True)
    scenario: str = setting('lamp_room', 'Scenario name or file.', fixed=True)
    seed: int = setting(1, 'Random seed.', low=0, high=2**31 - 1, fixed=True)
    strategy: str = setting(
        '',
        'Navigation strategy. The power of its sensors and its computation is simulated. '
        'Empty: none.',
        fixed=True,
    )
    offset_x: float = setting(
        0.0,
        'Offset of the start position along x (east) from that of the scenario.',
        unit='m',
        low=-LARGEST_OFFSET,
        high=LARGEST_OFFSET,
        fixed=True,
    )
    offset_y: float = setting(
        0.0,
        'Offset of the start position along y (north) from that of the scenario.',
        unit='m',
        low=-LARGEST_OFFSET,
        high=LARGEST_OFFSET,
        fixed=True,
    )
    commanded: bool = setting(
        False,
        'Whether the flight is commanded by actions: then neither a reached lamp nor the time '
        'limit of the scenario ends it.',
        fixed=True,
    )
    wait_for: str = setting(
        WAIT_FOR_DEFAULT,
        'Nodes to wait for before the flight starts, by their roles in the topic table and '
        'separated by spaces; empty: none. "default": in lockstep every node that reads an output '
        'of the simulator by the topic table, in real time none. "description": the publishers of '
        'URDF, scene and fixed frames.',
        fixed=True,
    )
    record: bool = setting(
        False,
        'Whether the simulator waits for a recorder before it starts the flight.',
        fixed=True,
    )
    topics: str = setting(
        '', 'Topics that the recorder records; must equal the setting of the recorder.', fixed=True
    )
    clock: bool = setting(
        True,
        'Whether to publish /clock. With several drones, exactly one simulator must.',
        fixed=True,
    )
    peers: str = setting(
        '', 'Namespaces of the other drones to synchronise with, separated by spaces.', fixed=True
    )
