"""A vehicle as it is supposed to be: its file with knobs turned."""

from lta_config.vehicle_edit import set_value
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.results.learned_file import list_changed_quantities
from lta_model.vehicle import Vehicle


def format_hypothesis(text: str, vehicle: Vehicle, nominal: NominalVehicle) -> str:
    """
    Return the text of a vehicle file as some effects are supposed to be.

    Parameters
    ----------
    text : str
        The vehicle file.
    vehicle : Vehicle
        The same, read.
    nominal : Nominal
        As it is supposed to be.

    Raises
    ------
    BadInput
        If the format has no place for it, or no such vehicle can be.

    """
    for one in list_changed_quantities(
        text, vehicle, NominalVehicle.from_vehicle(vehicle), nominal, {}, 'supposed'
    ):
        text = set_value(text, one.place.split('.'), one.as_yaml)
    return text
