"""
What no library has: kinds of forces that are hidden to see whether they are called unexplained.

One file a kind, written as an effect so that the truth can be composed of it; none is registered,
so that no model knows it.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, final

from lta_analysis.challenge.outside import (
    blown_fin,
    coupling,
    draught,
    flapping,
    gondola,
    inflow,
    layers,
    magnet,
    one_sided,
    skin,
    sloshing,
    sticking,
    tether,
    weathercock,
    wobble,
)
from lta_sim.effects.protocol import WrenchEffect


@final
@dataclass(frozen=True, slots=True)
class Outside:
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

    """

    effect: WrenchEffect
    about: str
    usual: Mapping[str, tuple[float, float]]


OUTSIDE: Final[dict[str, Outside]] = {
    'tether': Outside(
        tether.EFFECT,
        'a rope that drags over the floor',
        {'size': (0.004, 0.01), 'length': (2.0, 4.0), 'rubbing': (0.3, 0.8)},
    ),
    'sloshing': Outside(
        sloshing.EFFECT,
        'ballast that slides',
        {'size': (0.01, 0.03), 'f': (2.0, 6.0), 'damping': (0.03, 0.15)},
    ),
    'flapping': Outside(
        flapping.EFFECT,
        'a loose panel that flaps',
        {'size': (0.01, 0.04), 'f': (3.0, 9.0), 'side': (-0.4, 0.4)},
    ),
    'wobble': Outside(wobble.EFFECT, 'a bent shaft', {'size': (0.1, 0.4), 'f': (8.0, 16.0)}),
    'draught': Outside(
        draught.EFFECT, 'draughts from vents', {'size': (0.004, 0.01), 's': (0.6, 1.5)}
    ),
    'one_sided': Outside(
        one_sided.EFFECT,
        'a flap that opens one way',
        {'size': (0.002, 0.006), 'lever': (2.0, 10.0)},
    ),
    'layers': Outside(layers.EFFECT, 'air in layers', {'size': (0.004, 0.01), 's': (0.15, 0.5)}),
    'blown_fin': Outside(blown_fin.EFFECT, 'a fin in the jet', {'size': (0.03, 0.1)}),
    'skin': Outside(
        skin.EFFECT,
        'a skin with hysteresis',
        {'size': (0.0005, 0.002), 's': (0.03, 0.3)},
    ),
    'gondola': Outside(
        gondola.EFFECT,
        'a gondola on springs',
        {'size': (0.002, 0.006), 'f': (4.0, 9.0), 'damping': (0.03, 0.15)},
    ),
    'sticking': Outside(sticking.EFFECT, 'a rotor that sticks', {'size': (0.2, 0.5)}),
    'magnet': Outside(
        magnet.EFFECT,
        'a magnet aboard',
        {'size': (0.0005, 0.002), 'north': (-3.1, 3.1)},
    ),
}
# What every flight of the row 'structured' has, of either sign.
STRUCTURED: Final[dict[str, Outside]] = {
    'inflow': Outside(inflow.EFFECT, 'thrust lost with speed', {'size': (0.04, 0.12)}),
    'coupling': Outside(coupling.EFFECT, 'pitch by ahead times up', {'size': (-0.02, 0.02)}),
    'weathercock': Outside(weathercock.EFFECT, 'turns into the wind', {'size': (-0.01, 0.01)}),
}
STRANGE: Final[dict[str, Outside]] = {**OUTSIDE, **STRUCTURED}
