"""Write the vehicle file of a hypothesis."""

from lta_config.vehicle_edit import set_yaml_value
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.results.learned_file import list_changed_quantities
from lta_model.vehicle import Vehicle


def format_hypothesis(text: str, vehicle: Vehicle, nominal: NominalVehicle) -> str:
    """
    Return the text of a vehicle file with hypothetical effects.

    Raises
    ------
    BadInput
        If the format has no place for a parameter, or the vehicle is impossible.

    """
    for one in list_changed_quantities(
        text, vehicle, NominalVehicle.from_vehicle(vehicle), nominal, {}, 'supposed'
    ):
        text = set_yaml_value(text, one.place.split('.'), one.as_yaml)
    return text
