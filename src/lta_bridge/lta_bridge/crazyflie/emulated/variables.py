"""The variables and parameters that the emulated Crazyflie knows, with the firmware's types."""

from lta_bridge.crazyflie.emulated.contents import EXTENDED, LogVariable, Parameter, READ_ONLY

FLOAT, U8, U16, I8, I16 = 7, 1, 2, 4, 5

LOG = (
    *(LogVariable(f'acc.{axis}', FLOAT) for axis in 'xyz'),
    *(LogVariable(f'gyro.{axis}', FLOAT) for axis in 'xyz'),
    *(LogVariable(f'stateEstimate.{angle}', FLOAT) for angle in ('roll', 'pitch', 'yaw', 'z')),
    LogVariable('range.zrange', U16),
    LogVariable('baro.pressure', FLOAT),
    LogVariable('pm.vbat', FLOAT),
    LogVariable('pm.state', I8),
    *(LogVariable(f'motor.m{number}', U16) for number in range(1, 5)),
    LogVariable('supervisor.info', U16),
)
PARAMETERS = (
    Parameter('supervisor.landedTimeout', 0x09 | EXTENDED, 3000),
    Parameter('supervisor.prefltTimeout', 0x09, 30000),
    Parameter('supervisor.tmblChckEn', 0x08 | EXTENDED, 1),
    Parameter('stabilizer.controller', 0x08, 1),
    Parameter('stabilizer.stop', 0x08, 0),
    Parameter('motorPowerSet.enable', 0x08, 0),
    *(Parameter(f'motorPowerSet.m{number}', 0x09, 0) for number in range(1, 5)),
    Parameter('lta.app', 0x08 | READ_ONLY, 1),
    Parameter('firmware.revision0', 0x0A | READ_ONLY, 0x2026_0800),
)
