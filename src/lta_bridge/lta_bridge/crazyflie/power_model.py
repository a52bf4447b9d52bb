"""
Model the cell current from the reported duties, because a Crazyflie does not measure it.

The rotors' power by duty and voltage comes from Bitcraze's bench table (`electrical.loads`), the
power of the electronics from the vehicle file. The energy monitor is only as accurate as this
model.
"""

from collections.abc import Sequence
from typing import NamedTuple, Self

from lta_config.schema.vehicle_energy import EnergyBlock
from lta_model.electrical.loads import LoadModel, power_at_duty


class CrazyfliePowerModel(NamedTuple):
    """Power of the electronics [W]; of a rotor: offset at zero thrust [W], slope [W/N]."""

    electronics: float
    offset: float
    slope: float

    @classmethod
    def from_energy(cls, energy: EnergyBlock) -> Self:
        """Return the model of a vehicle file, with radio and light board on."""
        loads, sensing = LoadModel.from_energy(energy), energy.loads.sensing
        board = 0.0 if sensing is None else sensing.si
        return cls(loads.idle + loads.transmitting + board, loads.rotor_offset, loads.rotor_slope)

    def cell_current(self, duties: Sequence[float], voltage: float) -> float:
        """
        Return the current into the cell, negative because it discharges. [A]

        `duties`: duty of each motor, 0 to 1. `voltage`: cell voltage under this load, above 0 [V].
        """
        rotors = sum(power_at_duty(duty, voltage, self.offset, self.slope) for duty in duties)
        return -(self.electronics + rotors) / voltage
