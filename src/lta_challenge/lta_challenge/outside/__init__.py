"""
Forces outside the effect library, which discovery should report as unexplained.

Each kind is a file with an effect for the truth simulator that no model registers. The author of
the late kinds had not seen how discovery works, and these kinds were not used before discovery
was finished.
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
from lta_challenge.outside.reserved import (
    ceiling_fans,
    dented_nose,
    fin_stall,
    relief_valve,
    stirred_air,
    thermal_lag,
)
from lta_challenge.outside.shared.kind import OutsideKind


def _index_kinds(*kinds: OutsideKind) -> dict[str, OutsideKind]:
    """Return kinds by the name of their effect."""
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
# Model errors of every flight of the row 'structured', with either sign
STRUCTURED: Final = _index_kinds(inflow.KIND, coupling.KIND, weathercock.KIND)
# Written after discovery had begun to propose laws, by an author who had not seen how it does.
# No challenge draws them, so that old seeds repeat their cases; `test/score/laws.py` scores them
RESERVED: Final = _index_kinds(
    thermal_lag.KIND,
    dented_nose.KIND,
    fin_stall.KIND,
    ceiling_fans.KIND,
    relief_valve.KIND,
    stirred_air.KIND,
)
STRANGE: Final = {**OUTSIDE, **STRUCTURED, **RESERVED}
