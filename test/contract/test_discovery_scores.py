"""The page of scores is of the effects and the vehicle that are there, or says it is not."""

from pathlib import Path

from lta_challenge.digest import compute_registry_digest, vehicle_digest
from lta_model.effects import select_built_in_effects

PAGE = Path(__file__).resolve().parents[2] / 'docs/discovery_scores.md'
AGAIN = 'make the challenges again and score them with --markdown docs/discovery_scores.md'


def test_the_scores_are_of_what_is_there_or_called_stale():
    text = PAGE.read_text(encoding='utf-8')
    effects, vehicle = compute_registry_digest(select_built_in_effects()), vehicle_digest('gtmab')
    present = f'effects `{effects}`, vehicle `gtmab` `{vehicle}`'
    assert present in text or '\n**Stale' in text, (
        f'docs/discovery_scores.md is of other effects or another vehicle file than {present}; '
        f'{AGAIN} (hours), or write a paragraph "**Stale:** ..." below its heading until then.'
    )
