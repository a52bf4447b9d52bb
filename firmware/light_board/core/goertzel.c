// Copyright 2026 The LTA maintainers
// SPDX-License-Identifier: Apache-2.0
#include "goertzel.h"
#include <math.h>

#define TURN 6.28318530717958648f

void goertzel_begin(goertzel_t *filter, float frequency, float sample_rate)
{
    const float step = TURN * frequency / sample_rate;
    *filter = (goertzel_t){.cosine = cosf(step), .sine = sinf(step), .coefficient = 2.0f * cosf(step)};
}

void goertzel_add(goertzel_t *filter, float sample)
{
    /* About the first sample: single precision has no digits to spare for steady light. */
    if (filter->count++ == 0)
        filter->first = sample;
    sample -= filter->first;
    const float zero = sample + filter->coefficient * filter->one - filter->two;
    filter->two = filter->one;
    filter->one = zero;
    filter->sum += sample;
    filter->squares += sample * sample;
}

void goertzel_end(const goertzel_t *filter, float *amplitude, float *rest)
{
    const float n = (float)filter->count;
    const float re = filter->one - filter->two * filter->cosine, im = filter->two * filter->sine;
    const float mean = filter->sum / n;
    *amplitude = 2.0f / n * sqrtf(re * re + im * im);
    const float left = filter->squares / n - mean * mean - 0.5f * *amplitude * *amplitude;
    *rest = sqrtf(left > 0.0f ? left : 0.0f);
}
