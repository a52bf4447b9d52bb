"""Settings of the simulator node."""

from lta_config.settings import setting, Settings
from lta_model.start_offset import FAR


class SimulatorSettings(Settings):
    """Parameters of the simulator node."""

    vehicle: str = setting('gtmab', 'Vehicle name or file.', fixed=True)
    scenario: str = setting('lamp_room', 'Scenario name or file.', fixed=True)
    seed: int = setting(1, 'Random seed.', low=0, high=2**31 - 1, fixed=True)
    strategy: str = setting(
        '', 'Navigation strategy, for its power consumption; empty: none.', fixed=True
    )
    offset_x: float = setting(
        0.0,
        "Start, relative to the scenario's, eastward.",
        unit='m',
        low=-FAR,
        high=FAR,
        fixed=True,
    )
    offset_y: float = setting(
        0.0,
        "Start, relative to the scenario's, northward.",
        unit='m',
        low=-FAR,
        high=FAR,
        fixed=True,
    )
    record: bool = setting(False, 'Whether the simulator waits until a recorder runs.', fixed=True)
    topics: str = setting('', "Topics that are recorded; the recorder's setting.", fixed=True)
    clock: bool = setting(
        True, 'Whether to publish /clock; exactly one simulator must.', fixed=True
    )
    peers: str = setting(
        '', 'Namespaces of drones to stay synchronised with, separated by spaces.', fixed=True
    )
