"""What a draft takes from a vehicle file: names of rotors, what they push at most, and where."""

from typing import Final, final, NamedTuple, Self

from lta_model.vehicle import load_vehicle
import numpy as np

# Body axes that a lab commands, in the order of a wrench
BODY_AXES: Final = ('surge', 'sway', 'heave', 'roll', 'pitch', 'yaw')
FLOATS: Final = 0.5  # of the mass, displaced
NOTHING: Final = 1e-4  # N, N m; rotors do not push along an axis with less


@final
class DraftVehicle(NamedTuple):
    """A vehicle that flew in a log."""

    name: str
    rotors: tuple[str, ...]  # in the order of `motors`
    largest: dict[str, float]  # force or moment by all rotors, by axis [N, N m]
    # Where they push, on average, in body axes from the hull centre, by axis of a force [m]
    centres: dict[str, tuple[float, ...]]
    floats: bool = False  # whether gas carries most of it, so that its tilt does not accelerate it

    @classmethod
    def load(cls, name: str) -> Self:
        """Return the vehicle of a name or file; raise `BadInput` if there is none."""
        vehicle = load_vehicle(name)
        largest = {
            axis: sum(abs(rotor.column[k]) * rotor.full_thrust for rotor in vehicle.rotors)
            for k, axis in enumerate(BODY_AXES)
        }
        pushed = {axis: most for axis, most in largest.items() if most > NOTHING}
        centres = {}
        for k, axis in enumerate(BODY_AXES[:3]):
            weights = [abs(rotor.column[k]) * rotor.full_thrust for rotor in vehicle.rotors]
            if axis in pushed:
                places = np.array([rotor.place for rotor in vehicle.rotors])
                centres[axis] = tuple(np.average(places, axis=0, weights=weights).tolist())
        floats = vehicle.displaced_mass > FLOATS * vehicle.mass
        return cls(vehicle.file.name, tuple(vehicle.rotor_names), pushed, centres, floats)
