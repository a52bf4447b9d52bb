"""What `lta effects try` hides: every registered effect, or a reason why not."""

from lta_config.errors import BadInput
from lta_discovery.demo.hidden_effect import HALL, SCENARIO, STRATEGY, VEHICLE
from lta_discovery.demo.trial_effect import choose_trial_effect
from lta_discovery.model.candidates import DESIGN
from lta_flight.flight_spec import build_vehicle_scenario_stack, load_spec
from lta_model.effects import EFFECTS
import pytest

# The first needs the sun; the others are too weak, or covered by a tolerance of GT-MAB's file
UNSEEN = {'superheat', 'ground_effect', 'munk_moment'}
TRIED = [name for name in EFFECTS if name not in DESIGN | UNSEEN]


@pytest.fixture(scope='module')
def plain():
    """Return the flight of the demonstration, and the effects of its vehicle."""
    spec = load_spec(VEHICLE, SCENARIO, STRATEGY, '').with_values(HALL)
    return spec, build_vehicle_scenario_stack(spec)[0].collect_effects()


@pytest.mark.parametrize('name', TRIED)
def test_an_effect_is_hidden_in_a_vehicle_that_can_fly(name, plain):
    hidden = choose_trial_effect(name)
    assert hidden.name.partition('.')[0] == name
    spec, known = plain
    flown = build_vehicle_scenario_stack(hidden.hide_in(spec))[0].collect_effects()
    parameter = hidden.name.partition('.')[2] or 'up'
    assert flown[name][parameter] == pytest.approx(hidden.value)
    assert known.get(name, {}).get(parameter) != flown[name][parameter]
    changed = {effect for effect in flown if flown[effect] != known.get(effect)}
    # A coefficient of drag works in the cross flow as well
    assert changed <= {name, 'cross_flow'}


@pytest.mark.parametrize('name', sorted(DESIGN))
def test_a_design_is_not_missing(name):
    with pytest.raises(BadInput, match=f"'{name}' describes the design"):
        choose_trial_effect(name)


@pytest.mark.parametrize(
    ('name', 'said'),
    [
        ('superheat', 'without sun'),
        ('ground_effect', 'cannot be seen'),
        ('munk_moment', r'by 2\.6 standard deviations'),
        ('nothing', "Unknown effect 'nothing'"),
        ('munk_moment.x', r'try munk_moment, or one of: munk_moment\.lost'),
    ],
)
def test_what_cannot_be_tried_says_why(name, said):
    with pytest.raises(BadInput, match=said):
        choose_trial_effect(name)


def test_one_parameter_of_several_can_be_chosen():
    assert choose_trial_effect('steady_wind').name == 'steady_wind.x'
    assert choose_trial_effect('steady_wind.y').name == 'steady_wind.y'
