# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Plan the tests of a laboratory for a vehicle, and read their logs."""
