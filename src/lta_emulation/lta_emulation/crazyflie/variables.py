"""Log variables and parameters of the emulated Crazyflie, with the firmware's types."""

from functools import cache

from lta_config.schema.crazyflie_file import load_crazyflie
from lta_config.schema.vehicle_file import load_vehicle_file
from lta_config.vehicle_identity import hash_airframe
from lta_emulation.crazyflie.app import VERSION
from lta_emulation.crazyflie.firmware_build import FirmwareBuild
from lta_emulation.crazyflie.table_of_contents import (
    CORE,
    EXTENDED,
    FirmwareParameter,
    LogVariable,
    READ_ONLY,
)

FLOAT, U8, U16, I8 = 7, 1, 2, 4
BYTE, WORD, LONG, REAL = 0x08, 0x09, 0x0A, 0x06  # of parameters
ATTITUDE_GAINS = {'roll': (6.0, 3.0, 0.0), 'pitch': (6.0, 3.0, 0.0), 'yaw': (6.0, 1.0, 0.35)}
ANGLES = ('roll', 'pitch', 'yaw')
COMPLEMENTARY, PID, OUT_OF_TREE = 1, 1, 6  # estimator.h, controller.h

LOG = (
    *(LogVariable(f'acc.{axis}', FLOAT) for axis in 'xyz'),
    *(LogVariable(f'gyro.{axis}', FLOAT) for axis in 'xyz'),
    *(LogVariable(f'stateEstimate.{part}', FLOAT) for part in (*ANGLES, 'x', 'y', 'z')),
    *(LogVariable(f'stabilizer.{angle}', FLOAT) for angle in ANGLES),
    *(LogVariable(f'kalman.state{axis}', FLOAT) for axis in 'XYZ'),
    *(LogVariable(f'kalman.varP{axis}', FLOAT) for axis in 'XYZ'),
    LogVariable('range.zrange', U16),
    LogVariable('baro.pressure', FLOAT),
    LogVariable('pm.vbat', FLOAT),
    LogVariable('pm.state', I8),
    *(LogVariable(f'motor.m{number}', U16) for number in range(1, 5)),
    LogVariable('supervisor.info', U16),
)


def default_controller(build: FirmwareBuild) -> int:
    """Return the controller that a build selects by itself."""
    return OUT_OF_TREE if build.app else PID


def _airframe(build: FirmwareBuild) -> int:
    return _gtmab_airframe() if build.airframe is None else build.airframe


@cache
def _gtmab_airframe() -> int:
    return hash_airframe(load_vehicle_file('gtmab'), load_crazyflie('gtmab'))


def list_parameters(build: FirmwareBuild) -> tuple[FirmwareParameter, ...]:
    """Return the parameters of a build, with the values they have when it is up."""
    app = (
        FirmwareParameter('lta.app', BYTE | READ_ONLY, VERSION),
        FirmwareParameter('lta.compensated', BYTE | READ_ONLY, int(build.compensated)),
        FirmwareParameter('lta.commit', LONG | READ_ONLY, 0),
        FirmwareParameter('lta.vehicle', LONG | READ_ONLY, _airframe(build)),
    )
    return (
        # Time-outs in ms
        FirmwareParameter('supervisor.landedTimeout', WORD | EXTENDED, 3000),
        FirmwareParameter('supervisor.prefltTimeout', WORD | EXTENDED, 30000),
        FirmwareParameter('supervisor.tmblChckEn', BYTE | EXTENDED, 1),
        FirmwareParameter('powerDist.idleThrust', LONG | EXTENDED | CORE, build.idle_thrust),
        FirmwareParameter('stabilizer.controller', BYTE | CORE, default_controller(build)),
        FirmwareParameter('stabilizer.stop', BYTE | CORE, 0),
        FirmwareParameter('motorPowerSet.enable', BYTE | CORE, 0),
        *(FirmwareParameter(f'motorPowerSet.m{number}', WORD | CORE, 0) for number in range(1, 5)),
        *(app if build.app else ()),
        # Stored but not used: what programs of others set or look for
        FirmwareParameter('stabilizer.estimator', BYTE | CORE, COMPLEMENTARY),
        FirmwareParameter('kalman.resetEstimation', BYTE | CORE, 0),
        FirmwareParameter('commander.enHighLevel', BYTE | CORE, 0),
        FirmwareParameter('led.bitmask', BYTE, 0),
        *(
            FirmwareParameter(f'pid_attitude.{angle}_k{term}', REAL | EXTENDED, gain)
            for angle, gains in ATTITUDE_GAINS.items()
            for term, gain in zip('pid', gains, strict=True)
        ),
        # A Flow deck, as it measures range and position, and an LED ring
        FirmwareParameter('deck.bcFlow2', BYTE | CORE | READ_ONLY, 1),
        FirmwareParameter('ring.effect', BYTE | EXTENDED | CORE, 6),
        # In a real firmware, the first digits of the commit
        FirmwareParameter('firmware.revision0', LONG | READ_ONLY, 0x2026_0800),
    )
