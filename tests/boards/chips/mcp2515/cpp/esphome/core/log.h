// The driver's log is not looked at.
#pragma once

#define ESP_LOGE(...) ((void) 0)
#define ESP_LOGW(...) ((void) 0)
#define ESP_LOGD(tag, ...) ((void) (tag))
#define ESP_LOGV(...) ((void) 0)
#define ESP_LOGVV(...) ((void) 0)
#define ESP_LOGCONFIG(...) ((void) 0)
#define TRUEFALSE(value) ((value) ? "TRUE" : "FALSE")
