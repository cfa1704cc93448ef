/* Sound, but its constructor ends the process, as the code of a damaged file may. */
#include <stdlib.h>

#include "sound.h"
__attribute__((constructor)) static void end_the_process(void) {
    abort();
}
PLUGIN
