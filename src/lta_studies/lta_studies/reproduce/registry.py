"""The studies of all rows, by the name of the row's file in `config/paper`."""

from typing import Final

from lta_studies.reproduce.found import Study
from lta_studies.reproduce.studies import (
    beavis,
    beyond,
    cells,
    closed_loop,
    energy,
    forces,
    indoors,
    link,
    mounting,
    outdoors,
    photodiodes,
    platforms,
)

STUDIES: Final[dict[str, Study]] = {
    'platforms': platforms.study,
    'forces': forces.study,
    'closed_loop': closed_loop.study,
    'beavis': beavis.study,
    'cells': cells.study,
    'mounting': mounting.study,
    'photodiodes': photodiodes.study,
    'link': link.study,
    'indoors': indoors.study,
    'outdoors': outdoors.study,
    'energy': energy.study,
    'beyond': beyond.study,
}
