"""Settings of the simulator node."""

from lta_config.settings import setting, Settings
from lta_model.start_offset import FAR


class SimulatorSettings(Settings):
    """Parameters of the simulator node."""

    vehicle: str = setting('gtmab', 'Vehicle name or file.', fixed=True)
    scenario: str = setting('lamp_room', 'Scenario name or file.', fixed=True)
    seed: int = setting(1, 'Random seed.', low=0, high=2**31 - 1, fixed=True)
    strategy: str = setting(
        '', 'Navigation strategy whose power consumption is simulated; empty: none.', fixed=True
    )
    offset_x: float = setting(
        0.0,
        "Eastward distance of the start from the scenario's start.",
        unit='m',
        low=-FAR,
        high=FAR,
        fixed=True,
    )
    offset_y: float = setting(
        0.0,
        "Northward distance of the start from the scenario's start.",
        unit='m',
        low=-FAR,
        high=FAR,
        fixed=True,
    )
    record: bool = setting(False, 'Whether the simulator waits until a recorder runs.', fixed=True)
    topics: str = setting('', 'Topics that are recorded, as set for the recorder.', fixed=True)
    clock: bool = setting(
        True, 'Whether to publish /clock; exactly one simulator must.', fixed=True
    )
    peers: str = setting(
        '', 'Namespaces of the drones to synchronise with, separated by spaces.', fixed=True
    )
