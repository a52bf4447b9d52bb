// Copyright 2026 The LTA maintainers
// SPDX-License-Identifier: Apache-2.0
/* The light board on a Teensy 4.1: eight diodes on A0 to A7, USB or a UART to a WiFi module.
 *
 * NOT RUN ON HARDWARE YET. `make firmware` compiles it; `make -C firmware/light_board sketch` makes a folder
 * for the Arduino IDE. */
extern "C" {
#include "src/core/light_board.h"
}
#include <ADC.h> /* ships with Teensyduino */

static const unsigned DIODES = 8;
static const unsigned PERIOD_US = 100; /* 10 kS/s, as topics.yaml has it */
static const uint8_t PINS[DIODES] = {A0, A1, A2, A3, A4, A5, A6, A7}; /* counter-clockwise from the nose */

static ADC adc;
static IntervalTimer timer;
static light_board_t board;

/* 64 bits: micros() alone wraps after 71 minutes. */
static uint64_t now_us()
{
    static uint32_t last, wraps;
    const uint32_t now = micros();
    wraps += now < last;
    last = now;
    return (uint64_t)wraps << 32 | now;
}

/* Two converters side by side: four pairs, about 20 us of the period. */
static void sample()
{
    uint16_t row[DIODES];
    for (unsigned i = 0; i < DIODES; i += 2) {
        const ADC::Sync_result both = adc.analogSynchronizedRead(PINS[i], PINS[i + 1]);
        row[i] = both.result_adc0;
        row[i + 1] = both.result_adc1;
    }
    light_board_sample(&board, row);
}

static bool send(void *, const uint8_t *bytes, size_t count)
{
    return Serial.availableForWrite() >= (int)count && Serial.write(bytes, count) == count;
}

void setup()
{
    Serial.begin(115200); /* means nothing over USB */
    for (ADC_Module *module : {adc.adc0, adc.adc1}) {
        module->setResolution(12);
        module->setAveraging(1);
        module->setConversionSpeed(ADC_CONVERSION_SPEED::HIGH_SPEED);
        module->setSamplingSpeed(ADC_SAMPLING_SPEED::MED_SPEED);
    }
    light_board_config_t config = {};
    config.diodes = DIODES;
    config.sample_rate = 1e6f / PERIOD_US;
    config.peak_frequency = 0.0f; /* raw blocks; in flight over a slow link the beacon's frequency */
    config.start_us = now_us() + PERIOD_US;
    config.send = send;
    light_board_begin(&board, config);
    timer.begin(sample, PERIOD_US);
}

void loop()
{
    uint8_t bytes[64];
    size_t count = 0;
    while (count < sizeof bytes && Serial.available())
        bytes[count++] = Serial.read();
    light_board_hear(&board, bytes, count, now_us());
    light_board_work(&board, now_us());
}
