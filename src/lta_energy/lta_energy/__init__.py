# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Battery, solar and load models, in-flight energy monitoring and mission energy budgets."""
