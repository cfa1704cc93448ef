/* defects.c -- a library for each defect that a plugin may have. The build compiles this file once with each DEFECT_<name> that it
 * names; each changes one part of a sound plugin, which stands below. DEFECT_sound, DEFECT_grown_struct and those of the group "no
 * defect" are accepted: they prove that the others are refused because of their defects. */
#include <stddef.h>
#include <stdlib.h>

#include "rt_device.h"
#include "rt_plugin.h"
#include "rt_refit.h"

#define LEAF_PARAM "leaf", "Leaf", "primitives", RT_PARAM_INT, RT_EFFECT_REBUILD
#define SPLIT_PARAM "split", "Split", "how", RT_PARAM_ENUM, RT_EFFECT_REBUILD
#define BUILD_KERNELS {"sound_build.cl", " "}
#define ENDS_THE_PROCESS __attribute__((constructor)) static void end_the_process(void) { abort(); }

/* the symbol of the description */
#if defined(DEFECT_no_symbol)
RT_EXPORT extern const rt_plugin rt_plugin_v0;
#define SYMBOL rt_plugin_v0
#elif defined(DEFECT_hidden_symbol) /* defined, but not exported */
__attribute__((visibility("hidden"))) extern const rt_plugin hidden_plugin __asm__("rt_plugin_v1");
#define SYMBOL hidden_plugin
#elif defined(DEFECT_function_symbol) /* as in plugins of other programs */
RT_EXPORT const void* plugin_entry(void) __asm__("rt_plugin_v1");
const void* plugin_entry(void) {
    return NULL;
}
#define SYMBOL unused_plugin
#elif defined(DEFECT_not_constant) /* as if C++ computed rt_plugin_v1 at start-up: the file contains only zeros */
const rt_plugin rt_plugin_v1 = {0};
#define SYMBOL unused_plugin

/* what happens when it is loaded */
#elif defined(DEFECT_undefined_function) /* calls a function that no library defines */
void sound_function_that_nobody_has(void);
static int32_t calls_nobody(const rt_host* host, const rt_build_input* in, const rt_build_output* out) {
    (void)host, (void)in, (void)out;
    sound_function_that_nobody_has();
    return RT_FAILED;
}
#define BUILD calls_nobody
#elif defined(DEFECT_crashes_when_loaded) /* as the code of a damaged file may */
ENDS_THE_PROCESS
#elif defined(DEFECT_aborts_when_loaded) /* tests pass only if the library is never loaded, because of its version */
ENDS_THE_PROCESS
#define ABI (RT_ABI_VERSION + 1)

/* version and sizes */
#elif defined(DEFECT_wrong_abi)
#define ABI (RT_ABI_VERSION + 1)
#elif defined(DEFECT_first_abi)
#define ABI 1
#elif defined(DEFECT_old_abi)
#define ABI 0
#elif defined(DEFECT_wrong_digest)
#define DIGEST (RT_TYPES_DIGEST ^ 1u)
#elif defined(DEFECT_small_struct)
#define PLUGIN_BYTES 80 /* of the first release of version 2: 88 */
#elif defined(DEFECT_large_struct)
#define PLUGIN_BYTES (sizeof(rt_plugin) + 64) /* more than the library exports */
#elif defined(DEFECT_small_accel)
#define ACCEL_BYTES (sizeof(rt_accel) - 8)
#elif defined(DEFECT_small_importer)
#define ACCEL NULL
#define IMPORTER &importer
#define IMPORTER_BYTES 8
#elif defined(DEFECT_small_param)
#define PARAM_BYTES (sizeof(rt_param) - 8)
#elif defined(DEFECT_odd_param)
#define PARAM_BYTES (sizeof(rt_param) + 1)
#elif defined(DEFECT_no_param_size)
#define PARAM_BYTES 0
#elif defined(DEFECT_small_slot)
#define SLOT_BYTES (sizeof(rt_slot) - 8)
#elif defined(DEFECT_small_extension)
#define EXTENSION {"refit", 1, 0, NULL}
#define EXTENSION_BYTES 8

/* its kind and names */
#elif defined(DEFECT_bad_id)
#define ID "Sound-1"
#elif defined(DEFECT_null_id)
#define ID NULL
#elif defined(DEFECT_control_characters)
#define NAME "sound\033[2J"
#elif defined(DEFECT_both_kinds)
#define IMPORTER &importer
#elif defined(DEFECT_neither_kind)
#define ACCEL NULL

/* the structure */
#elif defined(DEFECT_no_build)
#define BUILD NULL
#elif defined(DEFECT_no_traversal)
#define TRAVERSE "sound.cl", NULL
#elif defined(DEFECT_later_contract)
#define CONTRACT (RT_KERNEL_CONTRACT + 1)
#elif defined(DEFECT_no_contract)
#define CONTRACT 0
#elif defined(DEFECT_merit_not_a_number)
#define TRAITS 0, 1, __builtin_nanf(""), RT_RAY_COST_LOGARITHMIC
#elif defined(DEFECT_merit_below_zero)
#define TRAITS 0, -1, 1, RT_RAY_COST_LOGARITHMIC
#elif defined(DEFECT_unknown_ray_cost)
#define TRAITS 0, 1, 1, 7
#elif defined(DEFECT_topology_of_no_layout)
#define TREE NULL, NULL, topology
#elif defined(DEFECT_topology_with_kernels)
#define TREE NULL, "bvh2", topology
#elif defined(DEFECT_layout_of_no_topology)
#define TREE NULL, "bvh2", NULL
#elif defined(DEFECT_layout_of_odd_name)
#define TREE NULL, "BVH 2", NULL
#elif defined(DEFECT_host_only_nodes)
#define SLOTS {"sound_nodes", NULL, 4, RT_SLOT_HOST_ONLY}
#elif defined(DEFECT_slots_of_one_name)
#define SLOTS {"sound_nodes", "uint", 4, 0}, {"sound_nodes", "float", 4, 0}
#elif defined(DEFECT_slot_of_no_size)
#define SLOTS {"sound_nodes", "uint", 0, 0}
#elif defined(DEFECT_slot_of_no_type)
#define SLOTS {"sound_nodes", NULL, 4, 0}
#elif defined(DEFECT_slot_of_odd_name)
#define SLOTS {"nodes; }", "uint", 4, 0}

/* parameters */
#elif defined(DEFECT_null_params)
#define PARAM_LIST NULL
#elif defined(DEFECT_params_of_one_key)
#define PARAMS {LEAF_PARAM, 1, 16, 4, NULL}, {LEAF_PARAM, 1, 16, 4, NULL}
#elif defined(DEFECT_param_out_of_range)
#define PARAMS {LEAF_PARAM, 1, 16, 17, NULL}
#elif defined(DEFECT_param_not_a_number)
#define PARAMS {"leaf", "Leaf", "share", RT_PARAM_FLOAT, RT_EFFECT_REBUILD, 0, 1, __builtin_nan(""), NULL}
#elif defined(DEFECT_param_not_whole)
#define PARAMS {LEAF_PARAM, 1, 16, 2.5, NULL}
#elif defined(DEFECT_param_of_unknown_kind)
#define PARAMS {"leaf", "Leaf", "primitives", 9, RT_EFFECT_REBUILD, 1, 16, 4, NULL}
#elif defined(DEFECT_param_without_help)
#define PARAMS {"leaf", "Leaf", NULL, RT_PARAM_INT, RT_EFFECT_REBUILD, 1, 16, 4, NULL}
#elif defined(DEFECT_enum_without_choices)
#define PARAMS {SPLIT_PARAM, 0, 0, 0, no_choices}
#elif defined(DEFECT_enum_of_wrong_range)
#define PARAMS {SPLIT_PARAM, 0, 2, 0, choices}

/* extensions */
#elif defined(DEFECT_extension_without_data)
#define EXTENSION {"refit", 1, 16, NULL}
#elif defined(DEFECT_small_refit)
#define REFIT 8
#elif defined(DEFECT_refit_without_function)
#define REFIT sizeof(rt_refit)
#elif defined(DEFECT_small_device_build)
#define DEVICE_BUILD BUILD_KERNELS, NULL, NULL, NULL, NULL, NULL
#define DEVICE_BUILD_BYTES 56
#elif defined(DEFECT_device_build_without_kernels)
#define DEVICE_BUILD {"sound_build.cl", NULL}, NULL, NULL, NULL, NULL, NULL
#elif defined(DEFECT_device_build_of_nothing)
#define DEVICE_BUILD BUILD_KERNELS, NULL, NULL, NULL, NULL, NULL
#elif defined(DEFECT_device_pack_without_elements)
#define DEVICE_BUILD BUILD_KERNELS, NULL, NULL, device_pack, NULL, NULL
#elif defined(DEFECT_device_refit_without_ranges)
#define DEVICE_BUILD BUILD_KERNELS, NULL, NULL, NULL, NULL, device_refit
#elif defined(DEFECT_endless_extensions)
#define FOUR {"a", 1, 0, NULL}, {"b", 1, 0, NULL}, {"c", 1, 0, NULL}, {"d", 1, 0, NULL}
#define SIXTEEN FOUR, FOUR, FOUR, FOUR
#define EXTENSION SIXTEEN, SIXTEEN, SIXTEEN, SIXTEEN, SIXTEEN

/* no defect */
#elif defined(DEFECT_unknown_capability) /* one of a later SDK: this host does without it */
#define ID "unknown_capability"
#define TRAITS RT_TRAVERSES_STREAMS | 0x80000000u, 1, 1, RT_RAY_COST_LOGARITHMIC
#elif defined(DEFECT_unknown_extension) /* the host ignores these; the second is a later version of one that it may know */
static const rt_u32 data[] = {1, 2};
#define ID "unknown_extension"
#define EXTENSION {"org.example.paint", 1, sizeof data, data}, {"refit", 1000000, sizeof data, data}
#elif !defined(DEFECT_sound) && !defined(DEFECT_grown_struct)
#error "no such defect"
#endif

/* The sound plugin, as far as nothing above changes it. */
#ifndef SYMBOL
#define SYMBOL rt_plugin_v1
#endif
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
#ifndef TRAITS /* capabilities, merit_cpu, merit_gpu, ray_cost */
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
#ifndef DEVICE_BUILD_BYTES
#define DEVICE_BUILD_BYTES sizeof(rt_device_build)
#endif
#ifndef TREE /* pack, layout, topology */
#define TREE NULL, NULL, NULL
#endif
#ifndef SLOTS
#define SLOTS {"sound_nodes", "uint", sizeof(rt_u32), 0}
#endif
#ifndef PARAMS
#define PARAMS {"max_leaf", "Max leaf size", "primitives in a leaf, at most", RT_PARAM_INT, RT_EFFECT_REBUILD, 1, 16, 4, NULL}
#endif
#ifndef PARAM_LIST
#define PARAM_LIST params
#endif
#ifndef ACCEL
#define ACCEL &accel
#endif
#ifndef IMPORTER
#define IMPORTER NULL
#endif

/* The code of a refused plugin must never run. */
static int32_t nothing(const rt_host* host) {
    return host->fail(host->ctx, "the test plugin does nothing");
}
static int32_t build(const rt_host* host, const rt_build_input* in, const rt_build_output* out) {
    return (void)in, (void)out, nothing(host);
}
static int32_t topology(const rt_host* host, const rt_build_input* in, const rt_topology_output* out) {
    return (void)in, (void)out, nothing(host);
}
static int32_t load(const rt_host* host, const char* path, const double* p, const rt_scene_sink* sink) {
    return (void)path, (void)p, (void)sink, nothing(host);
}
static int32_t device_pack(const rt_host* host, const rt_device_plan* plan, const rt_device_input* in,
                           const rt_device_topology* from, const rt_device_tree* tree, const rt_device_output* out) {
    return (void)plan, (void)in, (void)from, (void)tree, (void)out, nothing(host);
}
static int32_t device_refit(const rt_host* host, const rt_device_plan* plan, const rt_device_tree* tree, rt_u32 blocks, rt_u32 costs,
                            const double* values) {
    return (void)plan, (void)tree, (void)blocks, (void)costs, (void)values, nothing(host);
}

static const char* const choices[] = {"fast", "good", NULL};
static const char* const no_choices[] = {NULL};
static const rt_param params[] = {PARAMS};
static const rt_slot slots[] = {SLOTS};
static const rt_accel accel = {ACCEL_BYTES, CONTRACT, sizeof slots / sizeof slots[0], SLOT_BYTES, slots, {NULL, NULL}, {TRAVERSE},
                               BUILD, NULL, TREE, TRAITS};
static const char* const endings[] = {"sound", NULL};
static const rt_importer importer = {IMPORTER_BYTES, endings, NULL, load, 0, 0};
#ifdef REFIT
static const rt_refit refit = {REFIT, 0, NULL};
#define EXTENSION {RT_REFIT, RT_REFIT_VERSION, REFIT, &refit}
#endif
#ifdef DEVICE_BUILD
static const rt_device_build device_build = {sizeof(rt_device_build), 0, DEVICE_BUILD};
#define EXTENSION {RT_DEVICE_BUILD, RT_DEVICE_BUILD_VERSION, DEVICE_BUILD_BYTES, &device_build}
#endif
#ifdef DEFECT_endless_extensions
static const rt_extension extension_list[] = {EXTENSION};
#elif defined(EXTENSION)
static const rt_extension extension_list[] = {EXTENSION, {NULL, 0, 0, NULL}};
#else
#define extension_list NULL
#endif
/* Avoids warnings about unused parts: not every library uses all of them. */
const void* const sound_parts[] = {choices, no_choices, &accel, &importer, params, (const void*)&build, (const void*)&topology,
                                   (const void*)&device_pack, (const void*)&device_refit};

#ifndef DEFECT_grown_struct
const rt_plugin SYMBOL = {ABI,  PLUGIN_BYTES, DIGEST, sizeof params / sizeof params[0], ID,          NAME,            "1.0",
                          NULL, PARAM_LIST,   ACCEL,  IMPORTER,                         extension_list, PARAM_BYTES, EXTENSION_BYTES, NULL};
#else
/* As from a later SDK, in which rt_plugin, rt_accel, rt_param, rt_slot and rt_extension have one more field at their ends. The host
 * accepts it, and finds the elements of the arrays by their size. */
#define GROWN(name) struct grown_##name { rt_##name known; const char* later; }
GROWN(param);
GROWN(slot);
GROWN(extension);
GROWN(accel);
GROWN(plugin);
static const struct grown_param grown_params[] = {
    {PARAMS, "later"},
    {{"bins", "Bins", "slices of an axis", RT_PARAM_INT, RT_EFFECT_REBUILD, 2, 32, 8, NULL}, "later"}};
static const struct grown_slot grown_slots[] = {{SLOTS, "later"}, {{"sound_boxes", "float", 4, 0}, "later"}};
static const struct grown_extension grown_extensions[] = {{{"org.example.later", 3, 0, NULL}, "later"}, {{NULL, 0, 0, NULL}, NULL}};
static const struct grown_accel grown_accel = {
    {sizeof(struct grown_accel), CONTRACT, 2, sizeof(struct grown_slot), &grown_slots[0].known, {NULL, NULL}, {TRAVERSE}, BUILD, NULL, TREE, TRAITS},
    "later"};
RT_EXPORT extern const struct grown_plugin grown_plugin __asm__("rt_plugin_v1");
const struct grown_plugin grown_plugin = {{ABI, sizeof(struct grown_plugin), DIGEST, 2, "grown", NAME, "1.0", NULL, &grown_params[0].known,
                                           &grown_accel.known, NULL, &grown_extensions[0].known, sizeof(struct grown_param),
                                           sizeof(struct grown_extension), NULL},
                                          "later"};
#endif
