"""A vehicle as it is supposed to be: its file with knobs turned."""

from lta_config.vehicle_edit import with_value
from lta_discovery.model.nominal import Nominal
from lta_discovery.results.learned_file import values
from lta_model.vehicle import Vehicle


def supposed(text: str, vehicle: Vehicle, nominal: Nominal) -> str:
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
    for one in values(text, vehicle, Nominal.of(vehicle), nominal, {}, 'supposed'):
        text = with_value(text, one.place.split('.'), one.held)
    return text
