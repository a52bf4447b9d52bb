"""How large what was named is: what its values take for granted."""

from lta_discovery.finding import Assumed, Learned
from lta_discovery.model.knobs import Knob
from lta_discovery.model.nominal import Nominal
from lta_discovery.naming.sizes import assumed_values

Known = tuple[Nominal, list[Knob]]


def learned(name: str) -> Learned:
    """Return a parameter that was fitted."""
    return Learned(name, '1', 0.0, 0.4, (0.3, 0.5), in_file=False)


def test_numbers_of_an_absent_effect_that_were_not_fitted_are_told(gtmab: Known) -> None:
    """A ground effect of another radius has another gain."""
    nominal, _ = gtmab
    assert not {'ground_effect', 'superheat'} & set(nominal.given)
    told = assumed_values(nominal, 'ground_effect', [learned('gain')])
    assert told == (Assumed('radius', 'm', 0.0225),)
    assert assumed_values(nominal, 'superheat', [learned('rise'), learned('lag')]) == (
        Assumed('slack', '1', 0.3),
    )
    assert assumed_values(nominal, 'munk_moment', [learned('lost')]) == ()


def test_what_the_vehicle_file_has_is_not_assumed(gtmab: Known) -> None:
    nominal = gtmab[0].with_value('ground_effect', 'radius', 0.02)
    assert assumed_values(nominal, 'ground_effect', [learned('gain')]) == ()
