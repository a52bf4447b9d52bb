"""Settings of the simulator node."""

from lta_config.settings import setting, Settings
from lta_model.start_offset import FAR


class SimulatorSettings(Settings):
    """Vehicle, scenario, start and companions of the simulation."""

    vehicle: str = setting('gtmab', 'Vehicle name or file.', fixed=True)
    scenario: str = setting('lamp_room', 'Scenario name or file.', fixed=True)
    seed: int = setting(1, 'Seed of all chance.', low=0, high=2**31 - 1, fixed=True)
    strategy: str = setting(
        '', 'By which the drone finds lamps, for what that takes; empty: nobody looks.', fixed=True
    )
    offset_x: float = setting(
        0.0, "Start, east of the scenario's.", unit='m', low=-FAR, high=FAR, fixed=True
    )
    offset_y: float = setting(
        0.0, "Start, north of the scenario's.", unit='m', low=-FAR, high=FAR, fixed=True
    )
    record: bool = setting(False, 'Whether to wait for a recorder.', fixed=True)
    topics: str = setting('', 'What the recorder records, as it is told.', fixed=True)
    clock: bool = setting(True, 'Whether to tell /clock: one simulator does.', fixed=True)
    peers: str = setting(
        '', 'Namespaces of drones to keep together with in time, with spaces between.', fixed=True
    )
