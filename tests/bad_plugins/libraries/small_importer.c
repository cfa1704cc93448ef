#define ACCEL NULL
#define IMPORTER &importer
#define IMPORTER_BYTES 8
#include "sound.h"
PLUGIN
