/* sound.h -- the parts of a sound plugin. Each library beside this file uses them and adds exactly one defect: it defines one of
 * the macros before it includes this file, and ends with PLUGIN, which defines the description. sound.c has no defect; it proves
 * that the other libraries are refused because of theirs. */
#ifndef SOUND_H
#define SOUND_H
#include <stddef.h>

#include "rt_plugin.h"

#ifndef ABI
#define ABI RT_ABI_VERSION
#endif
#ifndef PLUGIN_BYTES
#define PLUGIN_BYTES sizeof(rt_plugin)
#endif
#ifndef DIGEST
#define DIGEST RT_TYPES_DIGEST
#endif
#ifndef ID
#define ID "sound"
#endif
#ifndef NAME
#define NAME "A sound plugin"
#endif
#ifndef ACCEL_BYTES
#define ACCEL_BYTES sizeof(rt_accel)
#endif
#ifndef IMPORTER_BYTES
#define IMPORTER_BYTES sizeof(rt_importer)
#endif
#ifndef TRAVERSE
#define TRAVERSE "sound.cl", "void RT_TRAVERSE() {}"
#endif
#ifndef BUILD
#define BUILD build
#endif
/* capabilities, merit_cpu, merit_gpu, ray_cost */
#ifndef TRAITS
#define TRAITS RT_TRAVERSES_STREAMS | RT_SPLITS_INCOHERENT, 0.25f, 0, RT_RAY_COST_LINEAR
#endif
#ifndef CONTRACT
#define CONTRACT RT_KERNEL_CONTRACT
#endif
#ifndef PARAM_BYTES
#define PARAM_BYTES sizeof(rt_param)
#endif
#ifndef SLOT_BYTES
#define SLOT_BYTES sizeof(rt_slot)
#endif
#ifndef EXTENSION_BYTES
#define EXTENSION_BYTES sizeof(rt_extension)
#endif
#ifndef EXTENSIONS
#define EXTENSIONS NULL
#endif
/* pack, layout, topology */
#ifndef TREE
#define TREE NULL, NULL, NULL
#endif
#ifndef SLOTS
#define SLOTS \
    { "sound_nodes", "uint", sizeof(rt_u32), 0 }
#endif
#ifndef PARAMS
#define PARAMS \
    { "max_leaf", "Max leaf size", "primitives in a leaf, at most", RT_PARAM_INT, RT_EFFECT_REBUILD, 1, 16, 4, NULL }
#endif
#ifndef ACCEL
#define ACCEL &accel
#endif
#ifndef IMPORTER
#define IMPORTER NULL
#endif
#ifndef PARAM_COUNT
#define PARAM_COUNT sizeof params / sizeof params[0]
#endif

/* The code of a refused plugin must never run. */
static int32_t build(const rt_host* host, const rt_build_input* in, const rt_build_output* out) {
    (void)in, (void)out;
    return host->fail(host->ctx, "the test plugin builds nothing");
}
static int32_t load(const rt_host* host, const char* path, const double* p, const rt_scene_sink* sink) {
    (void)path, (void)p, (void)sink;
    return host->fail(host->ctx, "the test plugin loads nothing");
}

static const char* const choices[] = {"fast", "good", NULL};
static const char* const no_choices[] = {NULL};
static const rt_param params[] = {PARAMS};
static const rt_slot slots[] = {SLOTS};
static const rt_accel accel = {ACCEL_BYTES, CONTRACT, sizeof slots / sizeof slots[0], SLOT_BYTES, slots, {NULL, NULL}, {TRAVERSE},
                               BUILD, NULL, TREE, TRAITS};
static const char* const extensions[] = {"sound", NULL};
static const rt_importer importer = {IMPORTER_BYTES, extensions, NULL, load, 0, 0};
/* Avoids warnings about unused parts: not every library uses all of them. */
const void* const sound_parts[] = {choices, no_choices, &accel, &importer, params, (const void*)&build};

#define PLUGIN \
    const rt_plugin rt_plugin_v1 = {ABI,  PLUGIN_BYTES, DIGEST, PARAM_COUNT, ID,       NAME,       "1.0", \
                                    NULL, params,       ACCEL,  IMPORTER,    EXTENSIONS, PARAM_BYTES, EXTENSION_BYTES, NULL};
#endif
