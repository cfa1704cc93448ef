// oren_nayar: a matt surface of rough grooves, as plaster, clay or the moon, which is flatter than Lambert's.
#include "rt_surface.hpp"

namespace {

constexpr rt_surface_key keys[] = {
    rt::surface_number("grooves", "Grooves", nullptr, "how deep the grooves are; 0 is Lambert's surface", 0, 1, 0.5),
};
constexpr rt_cl_file files[] = {
#include "oren_nayar.inc"
};
constexpr rt_surface surface = rt::surface(keys, rt::file(files, "oren_nayar.cl"));
constexpr rt_extension extensions[] = {rt::surface_extension(surface), {nullptr, 0, 0, nullptr}};

}  // namespace

extern "C" RT_EXPORT const rt_plugin rt_plugin_v1 = rt::surface_plugin(
    "oren_nayar", "Oren-Nayar", "1.0.0",
    "Oren, Nayar 1994, Generalization of Lambert's Reflectance Model; in the form of Fujii 2012", extensions);
