// rt_surface.hpp -- rt_surface.h for plugins in C++.
#pragma once
#include "rt_plugin.hpp"
#include "rt_surface.h"

namespace rt {

constexpr rt_surface_key surface_number(const char* name, const char* label, const char* unit, const char* help, double min,
                                        double max, double def) {
    return {name, label, unit, help, RT_KEY_NUMBER, 0, min, max, {def, 0, 0}};
}
constexpr rt_surface_key surface_color(const char* name, const char* label, const char* help, double max, double r, double g,
                                       double b) {
    return {name, label, "r g b", help, RT_KEY_COLOR, 0, 0, max, {r, g, b}};
}
template <size_t N>
constexpr rt_surface surface(const rt_surface_key (&keys)[N], const rt_cl_file& kernels) {
    return {sizeof(rt_surface), N, keys, kernels};
}
// surface: a static one.
constexpr rt_extension surface_extension(const rt_surface& surface) {
    return {RT_SURFACE, RT_SURFACE_VERSION, sizeof(rt_surface), &surface};
}
// extensions: a static array of the surface_extension() and {nullptr, 0, 0, nullptr}.
template <size_t N>
constexpr rt_plugin surface_plugin(const char* id, const char* name, const char* version, const char* reference,
                                   const rt_extension (&extensions)[N]) {
    return with_extensions(detail::plugin(id, name, version, reference, nullptr, 0, nullptr, nullptr), extensions);
}

}  // namespace rt
