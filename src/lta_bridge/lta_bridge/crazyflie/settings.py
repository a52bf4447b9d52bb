"""Parameters of the Crazyflie bridge."""

from typing import Literal

from lta_config.settings import setting, Settings


class CrazyflieBridgeSettings(Settings):
    """Which Crazyflie to connect to, and how to command it."""

    uri: str = setting('radio://0/80/2M/E7E7E7E7E7', fixed=True)
    """URI of the Crazyflie."""
    vehicle: str = setting('gtmab', fixed=True)
    """Vehicle name or file."""
    crazyflie: str = setting('', fixed=True)
    """
    Crazyflie file with motor wiring, parameters and flight limits, by name or path; empty for the
    one of the vehicle.
    """
    command: Literal['', 'setpoint', 'motors'] = setting('', fixed=True)
    """
    Command mode: setpoint (the controller of the firmware flies) or motors (duties for LTA's app
    in the firmware). Empty for the mode in the Crazyflie file.
    """
    blind: bool = setting(False, fixed=True)
    """
    Whether the drone may be armed without a position estimate; then no limit of height and
    distance ends its flight.
    """
    allow_other_commanders: bool = setting(False, fixed=True)
    """
    Whether nodes of other names than in the topic table may publish motors, setpoints or teleop
    commands, such as your own controller; otherwise they refuse arming and end the flight.
    """
    watchdog: Literal['setpoint', 'always', 'never'] = setting('setpoint', fixed=True)
    """
    When the armed drone stops and locks its motors until it is restarted, if it receives no
    message from the bridge for 1 s: setpoint (in this command mode; with motor duties, LTA's app
    stops them after 0.2 s), always or never.
    """
    patience: float = setting(0.0, 's', 0.0, 600.0, fixed=True)
    """Time to wait at the start until a program listens at a udp:// URI."""
    autostart: bool = setting(True, fixed=True)
    """Whether the node configures and activates itself at the start; it never arms the drone."""
