// microfacet.cpp -- the lab's model of surfaces: its key. You need not change it, and it is not handed in.
#include "rt_surface.hpp"

namespace {

constexpr rt_surface_key keys[] = {
    rt::surface_number("rough", "Roughness", nullptr, "the square root of alpha", 0.05, 1, 0.3),
};
constexpr rt_cl_file files[] = {
#include "microfacet.inc"
};
constexpr rt_surface surface = rt::surface(keys, rt::file(files, "microfacet.cl"));
constexpr rt_extension extensions[] = {rt::surface_extension(surface), {nullptr, 0, 0, nullptr}};

}  // namespace

const rt_plugin rt_plugin_v1 = rt::surface_plugin("microfacet", "Microfacets", "1.0.0", nullptr, extensions);
