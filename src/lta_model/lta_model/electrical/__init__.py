# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Cell, solar panel, charger and loads of a vehicle."""
