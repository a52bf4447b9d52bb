# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Topics, vehicles, scenarios and gains: the data files and their strict readers."""
