#define IMPORTER &importer
#include "sound.h"
PLUGIN
