"""
Compile what several files of tests fly with, once: workers would do it side by side.

The kernels of the product's own flights come from `lta simulate`. These are those of discovery's
replay and of the challenge's truth; each is compiled by its first call.
"""

from pathlib import Path
import sys

ROOT = Path(__file__).resolve().parents[1]
sys.path.append(str(ROOT / 'test' / 'unit' / 'analysis'))

from discovery.hidden_flight import flown, nominal, prepared  # noqa: E402
from lta_analysis.challenge.case import Drawing  # noqa: E402
from lta_analysis.challenge.make import known  # noqa: E402
from lta_analysis.discovery.replay.linear import origin  # noqa: E402


def main() -> None:
    """Linearise a short flight, and draw a case of the challenge."""
    vehicle, knobs = nominal()
    flight = prepared(flown({}, seed=1, length=8.0), knobs)
    flight.at(origin(vehicle, knobs, len(flight.replay.first)))
    Drawing(known(), 0, 0, 'base', 'clean', (20.0, 24.0)).drawn()


if __name__ == '__main__':
    main()
