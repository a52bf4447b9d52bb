"""Where RGBlimp's published flights are."""

import os
from pathlib import Path
from typing import Final

BESIDE: Final = Path(__file__).resolve().parents[3] / 'shared' / 'data'
DATA: Final = Path(os.environ.get('LTA_DATA', BESIDE)) / 'rgblimp'
FLIGHTS: Final = 100
REPEATS: Final = 4
