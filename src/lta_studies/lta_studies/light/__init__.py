# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Light studies behind `lta light`: link budget, bearings, strategies and lamp layout."""
