// my_surface.cpp -- a matt surface with dark edges: its keys. Replace them by those of your own model; it has no functions
// here.
#include "rt_surface.hpp"

namespace {

// material velvet  model my_surface  color .6 .1 .1  edges 2
constexpr rt_surface_key kKeys[] = {
    rt::surface_number("edges", "Edges", nullptr, "how dark the edges are; 1 is Lambert's surface", 1, 8, 2),
};
constexpr rt_cl_file kFiles[] = {
#include "my_surface.inc"
};
constexpr rt_surface kSurface = rt::surface(kKeys, rt::file(kFiles, "my_surface.cl"));
constexpr rt_extension kExtensions[] = {rt::surface_extension(kSurface), {nullptr, 0, 0, nullptr}};

}  // namespace

const rt_plugin rt_plugin_v1 = rt::surface_plugin("my_surface", "My surface", "0.1.0", nullptr, kExtensions);
