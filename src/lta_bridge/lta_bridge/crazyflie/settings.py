"""What the Crazyflie bridge is told: which drone, and how to command it."""

from typing import Literal

from lta_config.settings import setting, Settings


class CrazyflieBridgeSettings(Settings):
    """Which Crazyflie, and how it is commanded."""

    uri: str = setting('radio://0/80/2M/E7E7E7E7E7', 'Where the Crazyflie is.', fixed=True)
    vehicle: str = setting('gtmab', 'Vehicle name or file.', fixed=True)
    crazyflie: str = setting('', "Crazyflie file; the vehicle's where empty.", fixed=True)
    command: Literal['', 'setpoint', 'motors', 'override'] = setting(
        '',
        "What is sent: setpoints, or duties for the app; the file's where empty. On a tether also "
        "override: duties past the firmware's watchdog, lock and disarming.",
        fixed=True,
    )
    tethered: bool = setting(
        False, 'Whether the drone is tethered to a bench, which override wants.', fixed=True
    )
    watchdog: bool = setting(
        False,
        'Whether the firmware stops for good 1 s after it last heard of the bridge, once armed.',
        fixed=True,
    )
    autostart: bool = setting(
        True, 'Whether to configure and activate by itself; it never arms.', fixed=True
    )
