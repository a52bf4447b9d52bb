"""
The current of a cell that nobody measures, from the duties that the drone reports.

A Crazyflie measures its cell's voltage and not its current. The rotors' power by duty and voltage
is that of Bitcraze's bench table (`lta_energy.rotor`), the electronics' that of the vehicle file;
so the current is a model's, and what the energy monitor makes of it is as good as the model.
"""

from collections.abc import Sequence
from typing import NamedTuple, Self

from lta_config.schema.vehicle_energy import EnergyBlock
from lta_energy.rotor import power_at_duty
from lta_model.electrical.loads import LoadModel


class CrazyfliePowerModel(NamedTuple):
    """Power of the electronics [W]; of a rotor: at vanishing thrust [W], and by thrust [W/N]."""

    electronics: float
    offset: float
    slope: float

    @classmethod
    def from_energy(cls, energy: EnergyBlock) -> Self:
        """Return that of a vehicle file: radio on, light board on."""
        loads, sensing = LoadModel.from_energy(energy), energy.loads.sensing
        board = 0.0 if sensing is None else sensing.si
        return cls(loads.idle + loads.transmitting + board, loads.rotor_offset, loads.rotor_slope)

    def cell_current(self, duties: Sequence[float], voltage: float) -> float:
        """
        Return the current into the cell, negative because it discharges. [A]

        Parameters
        ----------
        duties : sequence of float
            Of each motor, 0 to 1.
        voltage : float
            Of the cell under this load, above 0. [V]

        """
        rotors = sum(power_at_duty(duty, voltage, self.offset, self.slope) for duty in duties)
        return -(self.electronics + rotors) / voltage
