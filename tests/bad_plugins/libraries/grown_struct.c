/* As from a later SDK, in which rt_plugin, rt_accel, rt_param, rt_slot and rt_extension have one more field at their ends. This is
 * no defect: the host accepts it, and finds the elements of the arrays by their size. */
#include "sound.h"
struct grown_param {
    rt_param known;
    const char* later;
};
struct grown_slot {
    rt_slot known;
    const char* later;
};
struct grown_extension {
    rt_extension known;
    const char* later;
};
struct grown_accel {
    rt_accel known;
    const char* later;
};
struct grown {
    rt_plugin known;
    const char* later;
};
static const struct grown_param grown_params[] = {
    {PARAMS, "later"},
    {{"bins", "Bins", "slices of an axis", RT_PARAM_INT, RT_EFFECT_REBUILD, 2, 32, 8, NULL}, "later"}};
static const struct grown_slot grown_slots[] = {{SLOTS, "later"}, {{"sound_boxes", "float", 4, 0}, "later"}};
static const struct grown_extension grown_extensions[] = {{{"org.example.later", 3, 0, NULL}, "later"}, {{NULL, 0, 0, NULL}, NULL}};
static const struct grown_accel grown_accel = {
    {sizeof(struct grown_accel), CONTRACT, 2, sizeof(struct grown_slot), &grown_slots[0].known, {NULL, NULL}, {TRAVERSE}, BUILD, NULL, TREE, TRAITS},
    "later"};
RT_EXPORT extern const struct grown grown_plugin __asm__("rt_plugin_v1");
const struct grown grown_plugin = {{ABI, sizeof(struct grown), DIGEST, 2, "grown", NAME, "1.0", NULL, &grown_params[0].known,
                                    &grown_accel.known, NULL, &grown_extensions[0].known, sizeof(struct grown_param),
                                    sizeof(struct grown_extension), NULL},
                                   "later"};
