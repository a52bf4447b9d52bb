"""
What no library has: kinds of forces that are hidden to see whether they are called unexplained.

One file a kind, written as an effect so that the truth can be composed of it; none is registered,
so that no model knows it. Those that are late were written by somebody who had not seen how
discovery works, and kept from it until it was finished.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, final

from lta_analysis.challenge.outside import (
    blown_fin,
    charged,
    coupling,
    desync,
    draught,
    drying,
    flapping,
    gondola,
    inflow,
    layers,
    leash,
    magnet,
    one_sided,
    plume,
    seam,
    skin,
    sloshing,
    stall,
    sticking,
    tether,
    tray,
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
    late : bool
        Whether it was kept from discovery until that was finished.

    """

    effect: WrenchEffect
    about: str
    usual: Mapping[str, tuple[float, float]]
    late: bool = False


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
    'leash': Outside(
        leash.EFFECT,
        'a leash on a reel that comes taut',
        {'size': (0.005, 0.02), 'length': (0.9, 1.5), 'east': (-0.6, 0.6), 'north': (-0.6, 0.6)},
        late=True,
    ),
    'seam': Outside(
        seam.EFFECT,
        'a seam that buckles and springs back',
        {'size': (0.002, 0.006), 'half': (0.04, 0.1), 'lever': (-0.15, 0.15)},
        late=True,
    ),
    'stall': Outside(
        stall.EFFECT,
        'rotors that stall in their own wash',
        {'size': (0.3, 0.7), 'middle': (0.02, 0.06), 'half': (0.01, 0.03)},
        late=True,
    ),
    'plume': Outside(
        plume.EFFECT,
        'warm air over patches of the floor',
        {'size': (0.005, 0.02), 'wide': (0.4, 0.8), 'east': (-1.5, 1.5), 'north': (-1.5, 1.5)},
        late=True,
    ),
    'charged': Outside(
        charged.EFFECT,
        'a charged hull among curtains',
        {'size': (0.01, 0.04), 'leak': (10.0, 60.0), 'normal': (-3.1, 3.1), 'away': (0.5, 2.5)},
        late=True,
    ),
    'tray': Outside(
        tray.EFFECT,
        'a battery that slides in its tray',
        {'size': (0.1, 0.4), 'half': (0.005, 0.02), 'grip': (0.01, 0.04)},
        late=True,
    ),
    'desync': Outside(
        desync.EFFECT,
        'a motor that loses step',
        {'size': (0.3, 0.8), 'jump': (0.06, 0.14), 'back': (0.2, 0.8)},
        late=True,
    ),
    'drying': Outside(
        drying.EFFECT,
        'a wet hull that dries',
        {'size': (0.01, 0.03), 'takes': (30.0, 90.0)},
        late=True,
    ),
}
# What every flight of the row 'structured' has, of either sign.
STRUCTURED: Final[dict[str, Outside]] = {
    'inflow': Outside(inflow.EFFECT, 'thrust lost with speed', {'size': (0.04, 0.12)}),
    'coupling': Outside(coupling.EFFECT, 'pitch by ahead times up', {'size': (-0.02, 0.02)}),
    'weathercock': Outside(weathercock.EFFECT, 'turns into the wind', {'size': (-0.01, 0.01)}),
}
STRANGE: Final[dict[str, Outside]] = {**OUTSIDE, **STRUCTURED}
