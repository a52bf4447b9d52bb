# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""One study for each row of the reproduction; it measures what the row's file declares."""
