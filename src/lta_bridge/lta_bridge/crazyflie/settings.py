"""Parameters of the Crazyflie bridge."""

from typing import Literal

from lta_config.settings import setting, Settings


class CrazyflieBridgeSettings(Settings):
    """Which Crazyflie to connect to, and how to command it."""

    uri: str = setting('radio://0/80/2M/E7E7E7E7E7', 'URI of the Crazyflie.', fixed=True)
    vehicle: str = setting('gtmab', 'Vehicle name or file.', fixed=True)
    crazyflie: str = setting(
        '',
        'Crazyflie file with motor wiring, parameters and flight limits, by name or path; empty '
        'for the one of the vehicle.',
        fixed=True,
    )
    command: Literal['', 'setpoint', 'motors'] = setting(
        '',
        'Command mode: setpoint (the controller of the firmware flies) or motors (duties for '
        "LTA's app in the firmware). Empty for the mode in the Crazyflie file.",
        fixed=True,
    )
    blind: bool = setting(
        False,
        'Whether the drone may be armed without a position estimate; then no limit of height and '
        'distance ends its flight.',
        fixed=True,
    )
    allow_other_commanders: bool = setting(
        False,
        'Whether nodes of other names than in the topic table may publish motors, setpoints or '
        'teleop commands, such as your own controller; otherwise they refuse arming and end the '
        'flight.',
        fixed=True,
    )
    watchdog: Literal['setpoint', 'always', 'never'] = setting(
        'setpoint',
        'When the armed drone stops and locks its motors until it is restarted, if it receives no '
        'message from the bridge for 1 s: setpoint (in this command mode; with motor duties, '
        "LTA's app stops them after 0.2 s), always or never.",
        fixed=True,
    )
    patience: float = setting(
        0.0,
        'Time to wait at the start until a program listens at a udp:// URI.',
        unit='s',
        low=0.0,
        high=600.0,
        fixed=True,
    )
    autostart: bool = setting(
        True,
        'Whether the node configures and activates itself at the start; it never arms the drone.',
        fixed=True,
    )
