#include "volumes.hpp"

#include <algorithm>
#include <cfloat>
#include <cmath>

#include "clarity_bvh/base/rounding.hpp"
#include "rt_cost.hpp"

namespace spheres {
namespace {

using clarity::bvh::rounded_up;

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

constexpr rt_u32 kFew = 8;  // so many primitives or fewer: the planes and edges of each are tried

struct Vector {
    double x[3];
};
Vector between(const float* a, const float* b) {
    return {{double{b[0]} - a[0], double{b[1]} - a[1], double{b[2]} - a[2]}};
}
double dot(const Vector& a, const Vector& b) {
    return a.x[0] * b.x[0] + a.x[1] * b.x[1] + a.x[2] * b.x[2];
}
Vector crossed(const Vector& a, const Vector& b) {
    return {{a.x[1] * b.x[2] - a.x[2] * b.x[1], a.x[2] * b.x[0] - a.x[0] * b.x[2], a.x[0] * b.x[1] - a.x[1] * b.x[0]}};
}

// The frame of two vectors that are not parallel: along the first, and across both. False if they say nothing.
bool frame_of(const Vector& first, const Vector& second, Frame& frame) {
    const Vector across = crossed(first, second), third = crossed(across, first);
    const Vector axes[3] = {first, across, third};
    for (int a = 0; a < 3; ++a) {
        const double length = std::sqrt(dot(axes[a], axes[a]));
        if (!(length > 0) || !std::isfinite(length)) return false;
        for (int k = 0; k < 3; ++k) frame.axis[3 * a + k] = static_cast<float>(axes[a].x[k] / length);
    }
    return true;
}

// Turns a symmetric matrix into a diagonal one (Jacobi 1846). The columns of `v` become its eigenvectors.
void diagonalize(double (&m)[3][3], double (&v)[3][3]) {
    for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k) v[i][k] = i == k;
    for (int sweep = 0; sweep < 12; ++sweep)
        for (int p = 0; p < 2; ++p)
            for (int q = p + 1; q < 3; ++q) {
                if (std::fabs(m[p][q]) <= 1e-14 * (std::fabs(m[p][p]) + std::fabs(m[q][q]))) continue;
                const double theta = (m[q][q] - m[p][p]) / (2 * m[p][q]);
                const double t = std::copysign(1.0, theta) / (std::fabs(theta) + std::sqrt(theta * theta + 1));
                const double c = 1 / std::sqrt(t * t + 1), s = t * c;
                for (int k = 0; k < 3; ++k) {
                    const double a = m[k][p], b = m[k][q];
                    m[k][p] = c * a - s * b, m[k][q] = s * a + c * b;
                }
                for (int k = 0; k < 3; ++k) {
                    const double a = m[p][k], b = m[q][k];
                    m[p][k] = c * a - s * b, m[q][k] = s * a + c * b;
                    const double d = v[k][p], e = v[k][q];
                    v[k][p] = c * d - s * e, v[k][q] = s * d + c * e;
                }
            }
}

// The frame of the spread of the triangles' surface around its centre.
bool frame_of_spread(const Triangles& triangles, const double near[3], Frame& frame) {
    double surface = 0, mean[3] = {}, squares[3][3] = {};
    for (rt_u32 i = 0; i < triangles.count(); ++i) {
        const rt_packed_prim* const t = triangles[i];
        if (!t) return false;
        const Vector normal = crossed(between(t->a, t->b), between(t->a, t->c));
        const double area = std::sqrt(dot(normal, normal));
        double corner[3][3], middle[3];
        for (int k = 0; k < 3; ++k) {
            corner[0][k] = t->a[k] - near[k], corner[1][k] = t->b[k] - near[k], corner[2][k] = t->c[k] - near[k];
            middle[k] = (corner[0][k] + corner[1][k] + corner[2][k]) / 3;
            mean[k] += area * middle[k];
        }
        surface += area;
        for (int p = 0; p < 3; ++p)
            for (int q = p; q < 3; ++q) {
                double sum = 9 * middle[p] * middle[q];
                for (const auto& c : corner) sum += c[p] * c[q];
                squares[p][q] += area / 12 * sum;
            }
    }
    if (!(surface > 0)) return false;
    double spread[3][3], vectors[3][3];
    for (int p = 0; p < 3; ++p)
        for (int q = p; q < 3; ++q)
            spread[p][q] = spread[q][p] = squares[p][q] / surface - mean[p] / surface * (mean[q] / surface);
    for (const auto& row : spread)
        for (const double x : row)
            if (!std::isfinite(x)) return false;
    diagonalize(spread, vectors);
    return frame_of({{vectors[0][0], vectors[1][0], vectors[2][0]}}, {{vectors[0][1], vectors[1][1], vectors[2][1]}}, frame);
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

double Volumes::surface(rt_u32 at) const {
    const float* const v = nodes_[at].volume;
    if (kind_ == SPHERES_SPHERE) return 4 * 3.14159265358979 * v[3] * v[3];
    if (kind_ == SPHERES_BOX) return rt::surface_of(v);
    const double half[3] = {v[3], v[4], v[5]};
    return 8 * half_surface(half);
}

double half_surface(const double half[3]) {
    return half[0] * half[1] + half[1] * half[2] + half[2] * half[0];
}

bool fit_in(const Frame& frame, const Triangles& triangles, const double near[3], Fit& fit) {
    double lo[3] = {INFINITY, INFINITY, INFINITY}, hi[3] = {-INFINITY, -INFINITY, -INFINITY};
    const auto along = [&](int a, const float* p) {
        double sum = 0;
        for (int k = 0; k < 3; ++k) sum += double{frame.axis[3 * a + k]} * (p[k] - near[k]);
        return sum;
    };
    for (rt_u32 i = 0; i < triangles.count(); ++i) {
        const rt_packed_prim* const t = triangles[i];
        if (!t) return false;
        for (const float* p : {t->a, t->b, t->c})
            for (int a = 0; a < 3; ++a) {
                const double x = along(a, p);
                lo[a] = std::min(lo[a], x), hi[a] = std::max(hi[a], x);
            }
    }
    for (int k = 0; k < 3; ++k) {
        double sum = near[k];
        for (int a = 0; a < 3; ++a) sum += double{frame.axis[3 * a + k]} * (0.5 * lo[a] + 0.5 * hi[a]);
        fit.center[k] = static_cast<float>(sum);
    }
    fit.frame = frame;
    for (int a = 0; a < 3; ++a) {
        const double center = along(a, fit.center);
        fit.half[a] = std::max(hi[a] - center, center - lo[a]);
        if (!std::isfinite(float(fit.half[a])) || !std::isfinite(fit.center[a])) return false;
    }
    return true;
}

bool fit_frame(const Triangles& triangles, const double near[3], double least, Fit& best) {
    bool found = false;
    const auto consider = [&](const Frame& frame) {
        Fit fit;
        if (!fit_in(frame, triangles, near, fit)) return;
        const double surface = half_surface(fit.half);
        if (!(surface < least)) return;
        least = surface, best = fit, found = true;
    };
    Frame frame;
    if (frame_of_spread(triangles, near, frame)) consider(frame);
    if (triangles.count() > kFew) return found;
    for (rt_u32 i = 0; i < triangles.count(); ++i) {
        const rt_packed_prim* const t = triangles[i];
        if (!t) return false;
        const Vector edges[3] = {between(t->a, t->b), between(t->b, t->c), between(t->c, t->a)};
        const Vector* longest =
            std::max_element(edges, edges + 3, [](const Vector& a, const Vector& b) { return dot(a, a) < dot(b, b); });
        if (frame_of(*longest, edges[longest == edges ? 1 : 0], frame)) consider(frame);
    }
    return found;
}

}  // namespace spheres
