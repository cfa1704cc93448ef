// layout_now.cpp -- the layout of today.
#include "rt_plugin.h"
#define LAYOUT_FUNCTION layout_now
#include "layout.inc"
