# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""`python -m campaigns NAME ...`: run a campaign; without a name, list them."""

import sys

from campaigns.harness import list_campaigns, run_campaign


def main() -> int:
    """Run the campaign of the first argument."""
    name, *words = sys.argv[1:] or ['']
    campaigns = list_campaigns()
    if name in campaigns:
        return run_campaign(name, words)
    lines = [f'  {each:<16}{about}\n' for each, about in campaigns.items()]
    sys.stderr.writelines(["make campaign NAME [ARGS='...'], with NAME of\n", *lines])
    return 2 if name else 0


if __name__ == '__main__':
    sys.exit(main())
