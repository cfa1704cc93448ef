// layout_then.cpp -- the layout that the frozen header has. It is compiled with that header.
#include "rt_plugin.h"
#define LAYOUT_FUNCTION layout_then
#include "layout.inc"
