#include "volumes.hpp"

#include <algorithm>
#include <cfloat>
#include <cmath>

#include "frames.hpp"

namespace spheres {
namespace {

float rounded_up(double x) {
    const auto f = static_cast<float>(x);
    return f < x ? std::nextafter(f, INFINITY) : f;
}

// Half the extent along an axis of space, from a centre that was rounded.
double half_extent(const Box& box, int axis, float center) {
    return std::max(double{box.hi[axis]} - center, center - double{box.lo[axis]});
}

void write(const Fit& fit, spheres_node& node, spheres_axes& axes) {
    const double rounding =
        16 * DBL_EPSILON * (fit.half[0] + fit.half[1] + fit.half[2]);  // of the sums of products in fit_in()
    for (int k = 0; k < 3; ++k) {
        node.volume[k] = fit.center[k];
        node.volume[3 + k] = rounded_up(fit.half[k] + rounding);
    }
    std::copy_n(fit.frame.axis, 9, axes.axis);
}

}  // namespace

Box::Box() : lo{FLT_MAX, FLT_MAX, FLT_MAX}, hi{-FLT_MAX, -FLT_MAX, -FLT_MAX} {}

void Box::add(const Box& other) {
    for (int axis = 0; axis < 3; ++axis) {
        lo[axis] = std::min(lo[axis], other.lo[axis]);
        hi[axis] = std::max(hi[axis], other.hi[axis]);
    }
}

int Box::longest_axis() const {
    int longest = 0;
    for (int axis = 1; axis < 3; ++axis)
        if (double{hi[axis]} - lo[axis] > double{hi[longest]} - lo[longest]) longest = axis;
    return longest;
}

void Volumes::enclose(rt_u32 at, const Box& box) const {
    float* const volume = nodes_[at].volume;
    if (kind_ == SPHERES_BOX) {
        std::copy_n(box.lo, 3, volume);
        std::copy_n(box.hi, 3, volume + 3);
        return;
    }
    double square = 0;
    for (int axis = 0; axis < 3; ++axis) {
        volume[axis] = box.center(axis);
        const double half = half_extent(box, axis, volume[axis]);
        square += half * half;
        volume[3 + axis] = is_oriented() ? rounded_up(half) : 0;
    }
    if (is_oriented())
        std::copy_n(kFrameOfSpace.axis, 9, axes_[at].axis);
    else
        volume[3] = rounded_up(std::sqrt(square) * (1 + 4 * DBL_EPSILON));
}

void Volumes::fit(rt_u32 at, const Box& box, const Triangles& triangles) const {
    enclose(at, box);
    if (!is_oriented()) return;
    double half[3], center[3];
    for (int k = 0; k < 3; ++k) half[k] = half_extent(box, k, nodes_[at].volume[k]), center[k] = box.center(k);
    Fit best;
    if (fit_frame(triangles, center, half_surface(half), best)) write(best, nodes_[at], axes_[at]);
}

void Volumes::refit(rt_u32 at, const Box& box, const Triangles& triangles) const {
    if (!is_turned(at)) return enclose(at, box);
    Frame frame;
    std::copy_n(axes_[at].axis, 9, frame.axis);
    Fit moved;
    const double center[3] = {box.center(0), box.center(1), box.center(2)};
    if (fit_in(frame, triangles, center, moved)) write(moved, nodes_[at], axes_[at]);
}

void Volumes::fill_space(rt_u32 at) const {
    Box all;
    for (int k = 0; k < 3; ++k) all.lo[k] = -kEverywhere, all.hi[k] = kEverywhere;
    enclose(at, all);
}

bool Volumes::is_turned(rt_u32 at) const {
    return is_oriented() && !std::equal(axes_[at].axis, axes_[at].axis + 9, kFrameOfSpace.axis);
}

float Volumes::size(rt_u32 at) const {
    const float* const v = nodes_[at].volume;
    if (kind_ == SPHERES_SPHERE) return v[3];
    if (kind_ == SPHERES_ORIENTED) return std::max({v[3], v[4], v[5]});
    return std::max({v[3] - v[0], v[4] - v[1], v[5] - v[2]});
}

}  // namespace spheres
