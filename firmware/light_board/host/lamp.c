// Copyright 2026 The LTA maintainers
// SPDX-License-Identifier: Apache-2.0
/* The lamp's wave as bytes 0 and 1 on standard output: FREQUENCY DUTY TICK_RATE DRIFT TICKS */
#include "../core/lamp.h"
#include <stdio.h>
#include <stdlib.h>

int main(int count, char **words)
{
    if (count != 6)
        return 2;
    lamp_t lamp;
    lamp_begin(&lamp, atof(words[1]), atof(words[2]), atof(words[3]), atof(words[4]));
    for (long tick = atol(words[5]); tick > 0; tick--)
        putchar(lamp_tick(&lamp));
    return 0;
}
