"""What a draft takes from a vehicle file: names of rotors, and the largest force on each axis."""

from typing import Final, final, NamedTuple, Self

from lta_model.vehicle import load_vehicle

# Body axes that a lab commands, in the order of a wrench
BODY_AXES: Final = ('surge', 'sway', 'heave', 'roll', 'pitch', 'yaw')
NOTHING: Final = 1e-4  # N, N m; rotors do not push along an axis with less


@final
class DraftVehicle(NamedTuple):
    """A vehicle that flew in a log."""

    name: str
    rotors: tuple[str, ...]  # in the order of `motors`
    largest: dict[str, float]  # force or moment by all rotors, by axis [N, N m]

    @classmethod
    def load(cls, name: str) -> Self:
        """Return the vehicle of a name or file; raise `BadInput` if there is none."""
        vehicle = load_vehicle(name)
        largest = {
            axis: sum(abs(rotor.column[k]) * rotor.full_thrust for rotor in vehicle.rotors)
            for k, axis in enumerate(BODY_AXES)
        }
        pushed = {axis: most for axis, most in largest.items() if most > NOTHING}
        return cls(vehicle.file.name, tuple(vehicle.rotor_names), pushed)
