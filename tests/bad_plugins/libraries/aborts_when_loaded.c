/* Has the wrong ABI version, and its constructor ends the process: tests pass only if the library is never loaded. */
#define ABI (RT_ABI_VERSION + 1)
#include <stdlib.h>

#include "sound.h"
__attribute__((constructor)) static void end_the_process(void) {
    abort();
}
PLUGIN
