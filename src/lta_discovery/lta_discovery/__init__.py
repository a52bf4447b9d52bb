# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Where a model and a measured flight disagree, and which physical effect is missing."""
