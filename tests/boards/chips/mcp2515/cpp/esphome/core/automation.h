#pragma once
#include "esphome/core/component.h"
