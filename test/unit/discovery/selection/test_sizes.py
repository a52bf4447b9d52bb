"""How large what was named is: what its values take for granted."""

from lta_discovery.finding import AssumedValue, ParameterEstimate
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.selection.effect_sizes import list_assumed_parameters

Known = tuple[NominalVehicle, list[FreeParameter]]


def learned(name: str) -> ParameterEstimate:
    """Return a parameter that was fitted."""
    return ParameterEstimate(name, '1', 0.0, 0.4, (0.3, 0.5), in_file=False)


def test_numbers_of_an_absent_effect_that_were_not_fitted_are_told(gtmab: Known) -> None:
    """A ground effect of another radius has another gain."""
    nominal, _ = gtmab
    assert not {'ground_effect', 'superheat'} & set(nominal.effect_parameters)
    told = list_assumed_parameters(nominal, 'ground_effect', [learned('gain')])
    assert told == (AssumedValue('radius', 'm', 0.0225),)
    assert list_assumed_parameters(nominal, 'superheat', [learned('rise'), learned('lag')]) == (
        AssumedValue('slack', '1', 0.3),
    )
    assert list_assumed_parameters(nominal, 'munk_moment', [learned('lost')]) == ()


def test_what_the_vehicle_file_has_is_not_assumed(gtmab: Known) -> None:
    nominal = gtmab[0].with_value('ground_effect', 'radius', 0.02)
    assert list_assumed_parameters(nominal, 'ground_effect', [learned('gain')]) == ()
