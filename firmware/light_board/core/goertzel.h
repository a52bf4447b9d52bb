// Copyright 2026 The LTA maintainers
// SPDX-License-Identifier: Apache-2.0
/* One frequency in a row of samples: the amplitude of its sine, and what remains beside it. */
#pragma once
#include <stdint.h>

typedef struct {
    float coefficient, cosine, sine;
    float one, two; /* the filter's memory */
    float sum, squares, first;
    uint32_t count;
} goertzel_t;

void goertzel_begin(goertzel_t *filter, float frequency, float sample_rate);
void goertzel_add(goertzel_t *filter, float sample);
/* Over a whole number of cycles: amplitude and root mean square of the rest, its mean left out. */
void goertzel_end(const goertzel_t *filter, float *amplitude, float *rest);
