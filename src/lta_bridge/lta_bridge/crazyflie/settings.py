"""Parameters of the Crazyflie bridge."""

from typing import Literal

from lta_config.settings import setting, Settings


class CrazyflieBridgeSettings(Settings):
    """Which Crazyflie to connect to, and how to command it."""

    uri: str = setting('radio://0/80/2M/E7E7E7E7E7', 'URI of the Crazyflie.', fixed=True)
    vehicle: str = setting('gtmab', 'Vehicle name or file.', fixed=True)
    crazyflie: str = setting(
        '',
        'Name or file of the Crazyflie configuration; empty for that of the vehicle.',
        fixed=True,
    )
    command: Literal['', 'setpoint', 'motors', 'override'] = setting(
        '',
        'Command mode: setpoint (for the controller of the firmware), or motors (duties for our '
        'app on the drone); empty for the mode in the Crazyflie file. On a tether also override: '
        "duties that bypass the firmware's watchdog, lock and disarming.",
        fixed=True,
    )
    tethered: bool = setting(
        False,
        'Whether the drone is tethered to a bench; command:=override requires it.',
        fixed=True,
    )
    watchdog: bool = setting(
        False,
        'Whether the firmware, once armed, stops the motors and locks 1 s after the last message '
        'of the bridge.',
        fixed=True,
    )
    autostart: bool = setting(
        True,
        'Whether the node configures and activates itself at the start; it never arms the drone.',
        fixed=True,
    )
