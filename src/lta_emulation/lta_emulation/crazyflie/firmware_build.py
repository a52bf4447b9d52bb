"""Build options of the emulated firmware that a bridge can observe."""

from typing import Final, NamedTuple

KCONFIG_IDLE = 7000  # CONFIG_MOTORS_DEFAULT_IDLE_THRUST where arming is required (Kconfig)


class FirmwareBuild(NamedTuple):
    """A build of firmware 2026.08."""

    # Whether it has the app of firmware/crazyflie, and with it the out-of-tree controller
    app: bool
    # Whether it must be armed (CONFIG_MOTORS_REQUIRE_ARMING); otherwise it arms itself
    requires_arming: bool
    idle_thrust: int  # default of `powerDist.idleThrust`, of 65535
    # Whether it corrects duties for the battery voltage (CONFIG_ENABLE_THRUST_BAT_COMPENSATED).
    # This is only reported here: the correction is an effect of the body's vehicle, and `motor.m1`
    # to `m4` log the duty before it.
    compensated: bool
    # Hash of the vehicle that it was built for; by default that of GT-MAB
    airframe: int | None = None


AS_SOLD: Final = FirmwareBuild(app=False, requires_arming=False, idle_thrust=0, compensated=True)
ARMING: Final = FirmwareBuild(
    app=False, requires_arming=True, idle_thrust=KCONFIG_IDLE, compensated=True
)
APP: Final = FirmwareBuild(app=True, requires_arming=True, idle_thrust=0, compensated=False)


def select_build(command: str) -> FirmwareBuild:
    """Return the build for a command mode: 'setpoint' or 'motors'."""
    return AS_SOLD if command == 'setpoint' else APP
