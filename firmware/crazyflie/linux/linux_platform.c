// Copyright 2026 The LTA maintainers
// SPDX-License-Identifier: Apache-2.0
/* The Crazyflie firmware as a Linux process: its own modules above, this file below.
 *
 *   crazyflie LINK_PORT BENCH_PORT
 *
 * speaks CRTP over UDP at LINK_PORT. At BENCH_PORT a test asks for the state of the motors (`get`)
 * and changes the body (`voltage 3.3`, `upside_down 1`). A simulator sends what it senses
 * (`sense` and nine numbers), and is answered with the PWM compare values. In place of drivers for sensors, radio and
 * memory stands what a test needs; commander, supervisor, controllers, power distribution, motors,
 * parameters, logging and the app layer are the firmware's own files.
 *
 * SIGUSR1 switches it off and on. LTA_BOOT_MS is where its clock begins, LTA_CLOCK_PPM by how much
 * that clock runs fast.
 */
#include <arpa/inet.h>
#include <errno.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include "FreeRTOS.h"
#include "autoconf.h"
#include "commander.h"
#include "configblock.h"
#include "console.h"
#include "crtp.h"
#include "crtp_localization_service.h"
#include "crtp_mem.h"
#include "crtp_supervisor.h"
#include "crtpservice.h"
#include "estimator.h"
#include "estimator_kalman.h"
#include "ledseq.h"
#include "linux_platform.h"
#include "log.h"
#include "mem.h"
#include "motors.h"
#include "param_task.h"
#include "platform.h"
#include "platformservice.h"
#include "pm.h"
#include "range.h"
#include "sensors.h"
#include "stabilizer.h"
#include "storage.h"
#include "syslink.h"
#include "system.h"
#include "worker.h"
#ifdef CONFIG_APP_ENABLE
#include "app.h"
#endif

#define STEP_US 1000        /* of the stabilizer loop */
#define RANGE_STEPS 25      /* between two distances, as a VL53L1x measures them */
#define POWER_STEPS 10      /* between two voltages, as the nRF51 sends them */
#define LINK_TIMEOUT_MS CONFIG_RADIO_ACTIVITY_TIMEOUT_MS
#define FULL_COMPARE ((1 << MOTORS_PWM_BITS) - 1)

static int link_socket, bench_socket;
static struct sockaddr_in peer;
static bool has_peer, is_running;
static uint32_t last_packet_tick;
static uint32_t compare[MOTORS];
static uint64_t began_us;

/* Time. */

uint64_t monotonic_us(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return 1000000ULL * (uint64_t)now.tv_sec + (uint64_t)now.tv_nsec / 1000;
}

uint64_t firmware_us(void) {
  static double boot_us, rate;
  if (rate == 0.0) {
    const char *boot_ms = getenv("LTA_BOOT_MS"), *ppm = getenv("LTA_CLOCK_PPM");
    boot_us = boot_ms ? 1e3 * strtod(boot_ms, NULL) : 0.0;
    rate = 1.0 + (ppm ? 1e-6 * strtod(ppm, NULL) : 0.0);
  }
  return (uint64_t)(boot_us + rate * (double)(monotonic_us() - began_us));
}

uint64_t usecTimestamp(void) { return firmware_us(); }

/* CRTP over UDP, one packet a datagram, to whoever spoke last. */

static int open_socket(const char *port) {
  struct sockaddr_in address = {.sin_family = AF_INET, .sin_port = htons((uint16_t)atoi(port))};
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const int opened = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (opened < 0 || bind(opened, (struct sockaddr *)&address, sizeof(address)) != 0) {
    fprintf(stderr, "UDP port %s cannot be opened: %s\n", port, strerror(errno));
    exit(2);
  }
  return opened;
}

static int link_receive(CRTPPacket *packet) {
  uint8_t data[64];
  struct sockaddr_in sender;
  socklen_t length = sizeof(sender);
  give_core();
  const ssize_t size =
      recvfrom(link_socket, data, sizeof(data), 0, (struct sockaddr *)&sender, &length);
  take_core();
  if (size < 1 || size > 1 + CRTP_MAX_DATA_SIZE) {
    return -1;
  }
  peer = sender, has_peer = true;
  last_packet_tick = xTaskGetTickCount();
  packet->size = (uint8_t)(size - 1);
  memcpy(&packet->header, data, (size_t)size);
  return 0;
}

static int link_send(CRTPPacket *packet) {
  if (has_peer) {
    sendto(link_socket, &packet->header, packet->size + 1u, 0, (struct sockaddr *)&peer,
           sizeof(peer));
  }
  return true;
}

static int link_enable(bool on) {
  (void)on;
  return 0;
}

static bool link_is_connected(void) {
  return has_peer && xTaskGetTickCount() - last_packet_tick < LINK_TIMEOUT_MS;
}

static struct crtpLinkOperations udp_link = {
    .setEnable = link_enable,
    .sendPacket = link_send,
    .receivePacket = link_receive,
    .isConnected = link_is_connected,
};

/* Sensors: a step of the body for each step of the stabilizer. */

static uint64_t next_step_us;
static readings_t readings;

static void step_body(void) {
  float ratios[MOTORS];
  for (int motor = 0; motor < MOTORS; motor++) {
    ratios[motor] = (float)pwm_compare(motor) / FULL_COMPARE;
  }
  body_step(1e-6f * STEP_US, ratios);
  readings = body_read();
}

static void send_voltage(void) {
  SyslinkPacket packet = {.type = SYSLINK_PM_BATTERY_STATE, .length = 9};
  const float current = 0.0f;
  memcpy(packet.data + 1, &readings.voltage, sizeof(float));
  memcpy(packet.data + 5, &current, sizeof(float));
  pmSyslinkUpdate(&packet);
}

void sensorsWaitDataReady(void) {
  static uint32_t step;
  const uint64_t now = monotonic_us();
  if (next_step_us == 0 || now > next_step_us + 100 * STEP_US) {
    next_step_us = now; /* a machine that stood still for so long is not caught up with */
  }
  next_step_us += STEP_US;
  give_core();
  usleep(next_step_us > now ? (useconds_t)(next_step_us - now) : 0);
  take_core();
  step_body();
  if (++step % POWER_STEPS == 0) {
    send_voltage();
  }
  if (step % RANGE_STEPS == 0) {
    rangeSet(rangeDown, readings.range);
    rangeEnqueueDownRangeInEstimator(readings.range, 0.01f, xTaskGetTickCount());
  }
}

void sensorsAcquire(sensorData_t *data) {
  data->acc = (Axis3f){.x = readings.acc[0], .y = readings.acc[1], .z = readings.acc[2]};
  data->gyro = (Axis3f){.x = readings.gyro[0], .y = readings.gyro[1], .z = readings.gyro[2]};
  data->baro.pressure = readings.pressure;
  data->baro.temperature = 20.0f;
  data->baro.asl = 8.43f * (1013.25f - readings.pressure);
  data->interruptTimestamp = usecTimestamp();
  measurement_t gyro = {.type = MeasurementTypeGyroscope, .data.gyroscope.gyro = data->gyro};
  measurement_t acc = {.type = MeasurementTypeAcceleration, .data.acceleration.acc = data->acc};
  measurement_t baro = {.type = MeasurementTypeBarometer, .data.barometer.baro = data->baro};
  estimatorEnqueue(&gyro);
  estimatorEnqueue(&acc);
  estimatorEnqueue(&baro);
}

/* Motors: the timers' compare registers. */

static void set_compare(int motor, uint32_t value) { compare[motor] = value; }

/* motors_def.c: M1 is channel 2 of timer 2, M2 its channel 4, M3 its channel 1, M4 channel 4 of
 * timer 4. */
void TIM_SetCompare1(TIM_TypeDef *timer, uint32_t value) { (void)timer, set_compare(2, value); }
void TIM_SetCompare2(TIM_TypeDef *timer, uint32_t value) { (void)timer, set_compare(0, value); }
void TIM_SetCompare4(TIM_TypeDef *timer, uint32_t value) { set_compare(timer == TIM2 ? 1 : 3, value); }

uint32_t pwm_compare(int motor) { return compare[motor]; }

/* The bench: one question or change a datagram. */

static void *serve_bench(void *argument) {
  (void)argument;
  while (true) {
    char text[256] = "", name[32], answer[288];
    float value;
    struct sockaddr_in sender;
    socklen_t length = sizeof(sender);
    if (recvfrom(bench_socket, text, sizeof(text) - 1, 0, (struct sockaddr *)&sender, &length) < 1) {
      continue;
    }
    take_core();
    if (strcmp(text, "get") == 0) {
      snprintf(answer, sizeof(answer), "%d %u %u %u %u %u %u %u %u %u %.4f", is_running,
               xTaskGetTickCount(), motorsGetRatio(0), motorsGetRatio(1), motorsGetRatio(2),
               motorsGetRatio(3), compare[0], compare[1], compare[2], compare[3],
               (double)readings.range);
    } else if (strncmp(text, "sense ", 6) == 0 && body_sense(text + 6)) {
      snprintf(answer, sizeof(answer), "%u %u %u %u", compare[0], compare[1], compare[2], compare[3]);
    } else if (sscanf(text, "%31s %f", name, &value) == 2 && body_set(name, value)) {
      snprintf(answer, sizeof(answer), "ok");
    } else {
      snprintf(answer, sizeof(answer), "unknown: %s", text);
    }
    give_core();
    sendto(bench_socket, answer, strlen(answer), 0, (struct sockaddr *)&sender, length);
  }
  return NULL;
}

/* The system: what system.c starts, without the hardware. */

void systemWaitStart(void) {
  while (!is_running) {
    vTaskDelay(1);
  }
}

void systemStart(void) { is_running = true; }

const platformConfig_t *platformGetListOfConfigurations(int *count) {
  static const platformConfig_t crazyflie = {
      .deviceType = "CF21",
      .deviceTypeName = "Crazyflie 2.1 (Linux)",
      .sensorImplementation = SensorImplementation_COUNT,
      .motorMap = motorMapDefaultBrushed,
  };
  *count = 1;
  return &crazyflie;
}

void platformGetDeviceTypeString(char *text) { strcpy(text, "0;CF21"); }
void platformInitHardware(void) {}
const char *platformConfigGetPlatformName(void) { return "cf2"; }

void assertFail(char *condition, char *file, int line) {
  fprintf(stderr, "assertion failed: %s at %s:%d\n", condition, file, line);
  exit(3); /* the real one stops its motors and restarts */
}

/* Default values of parameters: a copy of the variables as they were before anything ran. */
extern char __data_start, _edata;
char initial_data[1 << 16];

__attribute__((constructor)) static void keep_initial_data(void) {
  const size_t size = (size_t)(&_edata - &__data_start);
  if (size > sizeof(initial_data)) {
    abort();
  }
  memcpy(initial_data, &__data_start, size);
}

/* No memory that outlasts the process. */
bool storageStore(const char *key, const void *buffer, size_t length) { return false; }
size_t storageFetch(const char *key, void *buffer, size_t length) { return 0; }
bool storageForeach(const char *prefix, storageFunc_t function) { return true; }
bool storageDelete(const char *key) { return true; }

/* What sources.mk lists as calls of the hardware. */
int do_nothing(void) { return 0; }
int return_true(void) { return 1; }
const char *V_STAG = "linux";
ledseqContext_t seq_charged, seq_charging, seq_lowbat;
ledseqContext_t seq_user_notification_success, seq_user_notification_fail;

static char **own_words;

static void restart(int signal_number) { execv(own_words[0], own_words); }

int main(int count, char **words) {
  if (count != 3) {
    fprintf(stderr, "usage: %s LINK_PORT BENCH_PORT\n", words[0]);
    return 2;
  }
  own_words = words;
  sigset_t none;
  sigemptyset(&none); /* a restart out of the handler leaves its signal blocked */
  sigprocmask(SIG_SETMASK, &none, NULL);
  signal(SIGUSR1, restart);
  began_us = monotonic_us();
  link_socket = open_socket(words[1]);
  bench_socket = open_socket(words[2]);
  take_core();
  if (platformInit() != 0) {
    fprintf(stderr, "the firmware does not know its platform\n");
    return 3;
  }
  crtpInit();
  consoleInit();
  crtpSupervisorInit();
  workerInit();
  pmInit();
#ifdef CONFIG_APP_ENABLE
  appInit();
#endif
  crtpSetLink(&udp_link);
  crtpserviceInit();
  platformserviceInit();
  logInit();
  paramInit();
  locSrvInit();
  commanderInit();
  memInit();
  estimatorKalmanTaskInit();
  stabilizerInit(StateEstimatorTypeComplementary);
  crtpMemInit();
  step_body();
  send_voltage();
  if (!stabilizerTest() || !commanderTest()) {
    fprintf(stderr, "the firmware's own test failed\n");
    return 3;
  }
  systemStart();
  pthread_t bench;
  pthread_create(&bench, NULL, serve_bench, NULL);
  give_core();
  while (true) {
    pause();
  }
}
