"""The studies of all rows, by the name of the row's file in `config/paper`."""

from typing import Final

from lta_analysis.reproduce.found import Study
from lta_analysis.reproduce.studies import cells, energy, photodiodes

STUDIES: Final[dict[str, Study]] = {
    'cells': cells.study,
    'photodiodes': photodiodes.study,
    'energy': energy.study,
}
