"""Parameters of the Crazyflie bridge."""

from typing import Literal

from lta_config.settings import setting, Settings


class CrazyflieBridgeSettings(Settings):
    """Which Crazyflie to connect to, and how to command it."""

    uri: str = setting('radio://0/80/2M/E7E7E7E7E7', 'URI of the Crazyflie.', fixed=True)
    vehicle: str = setting('gtmab', 'Vehicle name or file.', fixed=True)
    crazyflie: str = setting('', "Crazyflie file; empty for the vehicle's.", fixed=True)
    command: Literal['', 'setpoint', 'motors', 'override'] = setting(
        '',
        'Command mode: setpoint, or motors (duties for the app); empty for that of the file. On a '
        "tether also override: duties that bypass the firmware's watchdog, lock and disarming.",
        fixed=True,
    )
    tethered: bool = setting(
        False, 'Whether the drone is tethered to a bench, as override requires.', fixed=True
    )
    watchdog: bool = setting(
        False,
        'Whether the firmware, once armed, stops the motors and locks 1 s after the last message '
        'of the bridge.',
        fixed=True,
    )
    autostart: bool = setting(
        True,
        'Whether to configure and activate at the start; arming is never automatic.',
        fixed=True,
    )
