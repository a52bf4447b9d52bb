// Copyright 2026 The LTA maintainers
// SPDX-License-Identifier: Apache-2.0
/* FreeRTOS's interface on POSIX threads; see include/FreeRTOS.h.
 *
 * The firmware relies on a single core: its log task frees blocks that another task may send. So
 * one thread runs at a time, the one that has the core, and gives it away only where it waits.
 */
#include <errno.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "FreeRTOS.h"
#include "linux_platform.h"

static pthread_mutex_t core = PTHREAD_MUTEX_INITIALIZER;

struct thread {
  TaskFunction_t function;
  void *argument;
};

struct rtos_queue {
  pthread_cond_t changed;
  size_t length, size, count, first;
  uint8_t *items;
};

struct rtos_timer {
  pthread_cond_t changed;
  uint64_t due_us; /* 0: it stands */
  TickType_t period;
  bool repeats;
  void *id;
  TimerCallbackFunction_t callback;
};

static struct timespec at_us(uint64_t us) {
  struct timespec when = {.tv_sec = (time_t)(us / 1000000), .tv_nsec = (long)(us % 1000000) * 1000};
  return when;
}

void take_core(void) { pthread_mutex_lock(&core); }

void give_core(void) { pthread_mutex_unlock(&core); }

static void init_condition(pthread_cond_t *changed) {
  pthread_condattr_t attributes;
  pthread_condattr_init(&attributes);
  pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC);
  pthread_cond_init(changed, &attributes);
}

/* Wait for a change until a time on CLOCK_MONOTONIC; false once it has passed. */
static bool wait_for_change(pthread_cond_t *changed, uint64_t until_us) {
  if (until_us == UINT64_MAX) {
    return pthread_cond_wait(changed, &core) == 0;
  }
  const struct timespec when = at_us(until_us);
  return pthread_cond_timedwait(changed, &core, &when) != ETIMEDOUT;
}

static uint64_t deadline_us(TickType_t ticks) {
  return ticks == portMAX_DELAY ? UINT64_MAX : monotonic_us() + 1000ULL * ticks;
}

/* Tasks. */

static void *run_thread(void *argument) {
  struct thread thread = *(struct thread *)argument;
  free(argument);
  take_core();
  thread.function(thread.argument);
  give_core();
  return NULL;
}

static void start_thread(TaskFunction_t function, void *argument) {
  pthread_t handle;
  struct thread *thread = malloc(sizeof(*thread));
  *thread = (struct thread){function, argument};
  if (pthread_create(&handle, NULL, run_thread, thread) != 0) {
    abort();
  }
  pthread_detach(handle);
}

TaskHandle_t xTaskCreateStatic(TaskFunction_t function, const char *name, uint32_t depth,
                               void *argument, UBaseType_t priority, StackType_t *stack,
                               StaticTask_t *task) {
  (void)name, (void)depth, (void)priority, (void)stack;
  start_thread(function, argument);
  return task;
}

BaseType_t xTaskCreate(TaskFunction_t function, const char *name, uint32_t depth, void *argument,
                       UBaseType_t priority, TaskHandle_t *handle) {
  (void)name, (void)depth, (void)priority, (void)handle;
  start_thread(function, argument);
  return pdPASS;
}

TickType_t xTaskGetTickCount(void) { return (TickType_t)(firmware_us() / 1000); }

void vTaskDelay(TickType_t ticks) {
  const struct timespec until = at_us(ticks == portMAX_DELAY ? UINT64_MAX / 2 : deadline_us(ticks));
  give_core();
  clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, NULL);
  take_core();
}

void vTaskDelayUntil(TickType_t *last, TickType_t ticks) {
  *last += ticks;
  const int32_t left = (int32_t)(*last - xTaskGetTickCount());
  if (left > 0) {
    vTaskDelay((TickType_t)left);
  }
}

/* Queues. */

QueueHandle_t xQueueCreate(UBaseType_t length, UBaseType_t size) {
  QueueHandle_t queue = calloc(1, sizeof(*queue));
  init_condition(&queue->changed);
  queue->length = length, queue->size = size;
  queue->items = calloc(length, size ? size : 1);
  return queue;
}

static void put_item(QueueHandle_t queue, const void *item) {
  const size_t place = (queue->first + queue->count) % queue->length;
  if (queue->size && item) {
    memcpy(queue->items + place * queue->size, item, queue->size);
  }
  queue->count++;
  pthread_cond_broadcast(&queue->changed);
}

static void copy_first(QueueHandle_t queue, void *item) {
  if (queue->size) {
    memcpy(item, queue->items + queue->first * queue->size, queue->size);
  }
}

static void drop_first(QueueHandle_t queue) {
  queue->first = (queue->first + 1) % queue->length;
  queue->count--;
  pthread_cond_broadcast(&queue->changed);
}

/* Wait until a queue holds another number of items than `unwanted`; return whether it does. */
static bool wait_while(QueueHandle_t queue, size_t unwanted, TickType_t ticks) {
  const uint64_t until_us = deadline_us(ticks);
  while (queue->count == unwanted) {
    if (ticks == 0 || !wait_for_change(&queue->changed, until_us)) {
      return queue->count != unwanted;
    }
  }
  return true;
}

BaseType_t xQueueSend(QueueHandle_t queue, const void *item, TickType_t ticks) {
  const bool room = wait_while(queue, queue->length, ticks);
  if (room) {
    put_item(queue, item);
  }
  return room;
}

BaseType_t xQueueReceive(QueueHandle_t queue, void *item, TickType_t ticks) {
  const bool found = wait_while(queue, 0, ticks);
  if (found) {
    copy_first(queue, item);
    drop_first(queue);
  }
  return found;
}

BaseType_t xQueuePeek(QueueHandle_t queue, void *item, TickType_t ticks) {
  const bool found = wait_while(queue, 0, ticks);
  if (found) {
    copy_first(queue, item);
  }
  return found;
}

BaseType_t xQueueOverwrite(QueueHandle_t queue, const void *item) {
  if (queue->count == queue->length) {
    drop_first(queue);
  }
  put_item(queue, item);
  return pdPASS;
}

BaseType_t xQueueReset(QueueHandle_t queue) {
  queue->count = queue->first = 0;
  pthread_cond_broadcast(&queue->changed);
  return pdPASS;
}

UBaseType_t uxQueueMessagesWaiting(QueueHandle_t queue) { return queue->count; }

SemaphoreHandle_t xSemaphoreCreateBinary(void) { return xQueueCreate(1, 0); }

SemaphoreHandle_t xSemaphoreCreateMutex(void) {
  SemaphoreHandle_t mutex = xSemaphoreCreateBinary();
  xSemaphoreGive(mutex);
  return mutex;
}

/* Timers. */

static void run_timer(void *argument) {
  TimerHandle_t timer = argument;
  while (true) {
    const uint64_t due_us = timer->due_us ? timer->due_us : UINT64_MAX;
    if (due_us > monotonic_us()) {
      wait_for_change(&timer->changed, due_us);
      continue;
    }
    timer->due_us = timer->repeats ? due_us + 1000ULL * timer->period : 0;
      timer->callback(timer);
    }
}

TimerHandle_t xTimerCreate(const char *name, TickType_t period, UBaseType_t repeats, void *id,
                           TimerCallbackFunction_t callback) {
  (void)name;
  TimerHandle_t timer = calloc(1, sizeof(*timer));
  init_condition(&timer->changed);
  timer->period = period, timer->repeats = repeats, timer->id = id, timer->callback = callback;
  start_thread(run_timer, timer);
  return timer;
}

static BaseType_t set_timer(TimerHandle_t timer, TickType_t period) {
  timer->due_us = period ? monotonic_us() + 1000ULL * period : 0;
  timer->period = period ? period : timer->period;
  pthread_cond_broadcast(&timer->changed);
  return pdPASS;
}

BaseType_t xTimerChangePeriod(TimerHandle_t timer, TickType_t period, TickType_t ticks) {
  (void)ticks;
  return set_timer(timer, period);
}

BaseType_t xTimerStart(TimerHandle_t timer, TickType_t ticks) {
  (void)ticks;
  return set_timer(timer, timer->period);
}

BaseType_t xTimerStop(TimerHandle_t timer, TickType_t ticks) {
  (void)ticks;
  return set_timer(timer, 0);
}

BaseType_t xTimerDelete(TimerHandle_t timer, TickType_t ticks) { return xTimerStop(timer, ticks); }

void *pvTimerGetTimerID(TimerHandle_t timer) { return timer->id; }
