"""Keep the energy balance: harvested, consumed, lost and stored energy, and the residual."""

from dataclasses import dataclass
from typing import final


@final
@dataclass(frozen=True, slots=True)
class EnergyBalance:
    """
    Energy since the start. [J]

    Attributes
    ----------
    harvested : float
        From the panel.
    consumed : float
        By electronics and rotors.
    lost : float
        As heat in cell and charger.
    stored : float
        Change of the energy in the cell; negative after a net discharge.

    """

    harvested: float = 0.0
    consumed: float = 0.0
    lost: float = 0.0
    stored: float = 0.0

    @property
    def imbalance(self) -> float:
        """Residual of the balance: harvested - consumed - lost - stored. [J]"""
        return self.harvested - self.consumed - self.lost - self.stored


def add_interval(
    books: EnergyBalance, harvest: float, load: float, loss: float, stored: float, dt: float
) -> EnergyBalance:
    """
    Add one interval to the balance.

    Parameters
    ----------
    harvest, load, loss : float
        Mean power from the panel, to the loads, and lost as heat. [W]
    stored : float
        Change of the cell's energy. [J]
    dt : float
        Length of the interval. [s]

    """
    return EnergyBalance(
        harvested=books.harvested + harvest * dt,
        consumed=books.consumed + load * dt,
        lost=books.lost + loss * dt,
        stored=books.stored + stored,
    )
