"""
Hashes by which a board and a vehicle file recognize each other.

They cover what a wrong file would turn into a wrong motor or direction: rotors, wiring, diodes.
Masses, gains and limits may be measured anew without flashing a board. 0 is never a hash.
"""

from collections.abc import Mapping
import json
from typing import Any
import zlib

from lta_config.quantity import Quantity
from lta_config.schema.crazyflie_file import CrazyflieFile
from lta_config.schema.vehicle_file import VehicleFile

HASHED_DECIMALS = 6  # decimals of a number in SI units


def hash_airframe(vehicle: VehicleFile, file: CrazyflieFile) -> int:
    """Return the hash of a vehicle's name, rotors and motor wiring, 32 bits."""
    rotors = {
        name: [rotor.reversible, _to_numbers(rotor.position), _to_numbers(rotor.axis)]
        for name, rotor in vehicle.rotors.items()
    }
    return _hash({'name': vehicle.name, 'rotors': rotors, 'motors': dict(file.motors)})


def hash_diodes(vehicle: VehicleFile) -> int:
    """Return the hash of a vehicle's name and of the directions of its photodiodes, 32 bits."""
    diodes = vehicle.sensors.diodes
    axes = diodes.axes.value if diodes.axes else None
    return _hash({'name': vehicle.name, 'count': diodes.count, 'axes': axes})


def _to_numbers(quantity: Quantity) -> list[float]:
    return [round(number, HASHED_DECIMALS) + 0.0 for number in quantity.vector]


def _hash(content: Mapping[str, Any]) -> int:
    return zlib.crc32(json.dumps(content, sort_keys=True).encode()) or 1
