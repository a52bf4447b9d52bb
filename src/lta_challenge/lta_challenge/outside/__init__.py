"""
What no library has: kinds of forces that are hidden to see whether they are called unexplained.

One file a kind, written as an effect so that the truth can be composed of it; none is registered,
so that no model knows it. Those that are late were written by somebody who had not seen how
discovery works, and kept from it until it was finished.
"""

from typing import Final

from lta_challenge.outside import (
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
from lta_challenge.outside.shared.kind import OutsideKind


def _index_kinds(*kinds: OutsideKind) -> dict[str, OutsideKind]:
    """Return kinds under the names of their effects."""
    return {kind.effect.name: kind for kind in kinds}


OUTSIDE: Final = _index_kinds(
    tether.KIND,
    sloshing.KIND,
    flapping.KIND,
    wobble.KIND,
    draught.KIND,
    one_sided.KIND,
    layers.KIND,
    blown_fin.KIND,
    skin.KIND,
    gondola.KIND,
    sticking.KIND,
    magnet.KIND,
    leash.KIND,
    seam.KIND,
    stall.KIND,
    plume.KIND,
    charged.KIND,
    tray.KIND,
    desync.KIND,
    drying.KIND,
)
# What every flight of the row 'structured' has, of either sign.
STRUCTURED: Final = _index_kinds(inflow.KIND, coupling.KIND, weathercock.KIND)
STRANGE: Final = {**OUTSIDE, **STRUCTURED}
