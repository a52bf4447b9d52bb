"""Define a kind of force that is not in the effect library."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import final

from lta_model.effects.protocol import WrenchEffect


@final
@dataclass(frozen=True, slots=True)
class OutsideKind:
    """A kind of force outside the library."""

    effect: WrenchEffect  # the effect; its strength is proportional to its first parameter, `size`
    about: str  # description
    # Ranges of the parameters; the size is then scaled to the intended strength
    usual: Mapping[str, tuple[float, float]]
    # Whether it was written independently and not used before discovery was finished
    late: bool = False
