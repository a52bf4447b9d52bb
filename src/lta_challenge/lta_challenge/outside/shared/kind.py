"""Define a kind of force that is not in the effect library."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import final

from lta_model.effects.protocol import WrenchEffect


@final
@dataclass(frozen=True, slots=True)
class OutsideKind:
    """
    One kind.

    Attributes
    ----------
    effect : WrenchEffect
        Its first parameter, `size`, is what its strength goes with.
    about : str
        What it is, in words.
    usual : mapping of str to pair of float
        Between which its parameters are drawn; its size is then set by what it comes to.
    late : bool
        Whether it was kept from discovery until that was finished.

    """

    effect: WrenchEffect
    about: str
    usual: Mapping[str, tuple[float, float]]
    late: bool = False
