"""Map the names of the row files in `config/paper` to their studies."""

from typing import Final

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
from lta_studies.reproduce.study_result import RowStudy

# In the order of the paper
STUDIES: Final[dict[str, RowStudy]] = {
    'platforms': platforms.run_study,
    'forces': forces.run_study,
    'closed_loop': closed_loop.run_study,
    'beavis': beavis.run_study,
    'cells': cells.run_study,
    'mounting': mounting.run_study,
    'photodiodes': photodiodes.run_study,
    'link': link.run_study,
    'indoors': indoors.run_study,
    'outdoors': outdoors.run_study,
    'energy': energy.run_study,
    'beyond': beyond.run_study,
}
