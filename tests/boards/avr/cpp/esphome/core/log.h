// Nobody reads its log.
#pragma once
#define ESP_LOGE(...) ((void) 0)
#define ESP_LOGW(...) ((void) 0)
#define ESP_LOGD(tag, ...) ((void) (tag))
#define ESP_LOGV(...) ((void) 0)
#define ESP_LOGVV(...) ((void) 0)
