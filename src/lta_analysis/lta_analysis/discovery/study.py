"""A study of some flights of one vehicle, from the flights to the finding."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

from lta_analysis.discovery.finding import Finding
from lta_analysis.discovery.linear import Point
from lta_analysis.discovery.linearise import Linearised
from lta_analysis.discovery.nominal import Nominal


@final
@dataclass(frozen=True, slots=True)
class Flown:
    """
    One flight of a study.

    Attributes
    ----------
    name : str
        Of its bag.
    role : str
        'train', 'confirm' or 'holdout'.
    flight : Linearised
        Ready to be replayed.

    """

    name: str
    role: str
    flight: Linearised


@final
@dataclass(frozen=True, slots=True)
class Shown:
    """
    One flight under three models; nothing in them was fitted to it if it was held out.

    Attributes
    ----------
    flown : Flown
        The flight.
    before, tuned, after : Point
        The vehicle file; its tolerances fitted without any effect; with the named effects.

    """

    flown: Flown
    before: Point
    tuned: Point
    after: Point


@final
@dataclass(frozen=True, slots=True)
class Study:
    """
    What was found, with what it takes to draw it.

    Attributes
    ----------
    finding : Finding
        The words and numbers.
    nominal, learned : Nominal
        The vehicle as its file has it, and with the named effects.
    flights : sequence of Flown
        All of them.
    shown : sequence of Shown
        The held-out flights, or the confirming ones where there are none.

    """

    finding: Finding
    nominal: Nominal
    learned: Nominal
    flights: Sequence[Flown]
    shown: Sequence[Shown]
