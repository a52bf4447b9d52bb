/* In place of the driver of a positioning deck that is not built here. */
#pragma once

typedef struct dwDevice_s dwDevice_t;
