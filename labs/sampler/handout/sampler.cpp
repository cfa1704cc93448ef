// sampler.cpp -- the lab's model of surfaces: its keys. You need not change it, and it is not handed in.
#include "rt_surface.hpp"

namespace {

constexpr rt_surface_key keys[] = {
    rt::surface_number("rough", "Roughness", nullptr, "of the varnish: the square root of alpha", 0.05, 1, 0.2),
    rt::surface_number("varnish", "Varnish", nullptr, "what it reflects when it is seen from above", 0, 1, 0.04),
};
constexpr rt_cl_file files[] = {
#include "sampler.inc"
};
constexpr rt_surface surface = rt::surface(keys, rt::file(files, "sampler.cl"));
constexpr rt_extension extensions[] = {rt::surface_extension(surface), {nullptr, 0, 0, nullptr}};

}  // namespace

const rt_plugin rt_plugin_v1 = rt::surface_plugin("sampler", "Varnished paint", "1.0.0", nullptr, extensions);
