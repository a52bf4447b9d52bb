# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Draw rooms and vehicles as simple shapes, for viewers and pages."""
