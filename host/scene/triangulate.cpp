#include "scene/triangulate.hpp"

#include <algorithm>
#include <cmath>
#include "scene/vec.hpp"

namespace clarity {
namespace {

constexpr rt_u32 kShaped = 64;  // up to this number of corners ears are chosen by shape, which takes quadratic time

Vec corner_at(const float* positions, rt_u32 vertex) {
    const float* p = positions + 3 * size_t(vertex);
    return {p[0], p[1], p[2]};
}
void fan(const rt_u32* corners, rt_u32 count, std::vector<rt_u32>& out) {
    for (rt_u32 i = 2; i < count; ++i) {
        for (const rt_u32 corner : {corners[0], corners[i - 1], corners[i]}) out.push_back(corner);
    }
}

// Cuts a quad along its shorter diagonal. If a diagonal makes the two triangles face away from each other, the one that folds
// the quad less is taken instead.
void split_quad(const float* positions, const rt_u32* corners, std::vector<rt_u32>& out) {
    Vec p[4];
    for (int i = 0; i < 4; ++i) p[i] = corner_at(positions, corners[i]);
    const Vec a = (p[2] - p[0]), b = (p[3] - p[1]);
    // Cosine of the angle between the two triangles' normals; 0 if one of them has no area.
    const auto agreement = [](const Vec& m, const Vec& n) {
        const double lengths = std::sqrt(dot(m, m) * dot(n, n));
        return lengths > 0 ? dot(m, n) / lengths : 0;
    };
    const double agree_a = agreement(cross((p[1] - p[0]), a), cross(a, (p[3] - p[0])));
    const double agree_b = agreement(cross((p[2] - p[1]), b), cross(b, (p[0] - p[1])));
    const bool along_a = agree_a < 0 || agree_b < 0 ? agree_a >= agree_b : dot(a, a) <= dot(b, b);
    const int order[2][6] = {{0, 1, 3, 1, 2, 3}, {0, 1, 2, 0, 2, 3}};
    for (const int i : order[along_a]) out.push_back(corners[i]);
}

}  // namespace

void Triangulator::add(const float* positions, const rt_u32* corners, rt_u32 corner_count, std::vector<rt_u32>& out) {
    if (corner_count < 3) return;
    if (corner_count == 3 || !project(positions, corners, corner_count) ||
        (is_convex() && fan_is_flat(positions, corners, corner_count)))
        fan(corners, corner_count, out);
    else if (corner_count == 4)
        split_quad(positions, corners, out);
    else
        clip_ears(corners, out);
}

// True if the triangles of a fan lie in one plane: only then does the sum of their areas equal the area of the face's
// projection.
bool Triangulator::fan_is_flat(const float* positions, const rt_u32* corners, rt_u32 count) const {
    constexpr double kBend = 1e-4;  // relative
    const Vec origin = corner_at(positions, corners[0]);
    Vec before = (corner_at(positions, corners[1]) - origin), sum{};
    double area = 0;
    for (rt_u32 i = 2; i < count; ++i) {
        const Vec p = (corner_at(positions, corners[i]) - origin), n = cross(before, p);
        area += std::sqrt(dot(n, n));
        for (int k = 0; k < 3; ++k) sum[k] += n[k];
        before = p;
    }
    return area <= (1 + kBend) * std::sqrt(dot(sum, sum));
}

// Projects the face along its Newell normal into points_, counter-clockwise. Returns false if the projection has no area.
bool Triangulator::project(const float* positions, const rt_u32* corners, rt_u32 count) {
    const Vec origin = corner_at(positions, corners[0]);
    Vec normal{};
    double largest = 0, extent = 0;
    Vec before{};  // relative to the first corner, which keeps precision far from the world's origin
    for (rt_u32 i = 1; i < count; ++i) {
        const Vec absolute = corner_at(positions, corners[i]);
        const Vec p = (absolute - origin), n = cross(before, p);
        for (int k = 0; k < 3; ++k) {
            normal[k] += n[k];
            largest = std::max(largest, std::max(std::abs(absolute[k]), std::abs(origin[k])));
            extent = std::max(extent, std::abs(p[k]));
        }
        before = p;
    }
    const double area = std::sqrt(dot(normal, normal));
    rounding_ = 1.2e-7 * largest;
    tolerance_ = 1e-6;
    if (!(area > extent * (1e-7 * extent + rounding_))) return false;
    normal = {normal[0] / area, normal[1] / area, normal[2] / area};
    // The axis that is least parallel to the normal gives a basis of the plane.
    int axis = 0;
    for (int k = 1; k < 3; ++k) {
        if (std::abs(normal[k]) < std::abs(normal[axis])) axis = k;
    }
    Vec unit{};
    unit[axis] = 1;
    Vec u = cross(unit, normal);
    const double u_length = std::sqrt(dot(u, u));
    u = {u[0] / u_length, u[1] / u_length, u[2] / u_length};
    const Vec v = cross(normal, u);
    points_.resize(count);
    for (rt_u32 i = 0; i < count; ++i) {
        const Vec p = (corner_at(positions, corners[i]) - origin);
        points_[i] = {dot(p, u), dot(p, v)};
    }
    return true;
}

double Triangulator::turn(rt_u32 a, rt_u32 b, rt_u32 c) const {
    const Point &p = points_[a], &q = points_[b], &r = points_[c];
    return (q[0] - p[0]) * (r[1] - q[1]) - (q[1] - p[1]) * (r[0] - q[0]);
}

// True if the outline makes no right turn (beyond rounding errors) and goes around once: a star polygon also turns left
// everywhere, but goes around twice.
bool Triangulator::is_convex() const {
    const rt_u32 n = static_cast<rt_u32>(points_.size());
    int changes = 0, direction = 0, first_direction = 0;
    for (rt_u32 i = 0; i < n; ++i) {
        const rt_u32 b = i + 1 < n ? i + 1 : 0, c = b + 1 < n ? b + 1 : 0;
        const Point e = {points_[b][0] - points_[i][0], points_[b][1] - points_[i][1]};
        const Point f = {points_[c][0] - points_[b][0], points_[c][1] - points_[b][1]};
        const double e_length = std::hypot(e[0], e[1]), f_length = std::hypot(f[0], f[1]);
        const double slack = tolerance_ * e_length * f_length + rounding_ * (e_length + f_length);
        const double t = e[0] * f[1] - e[1] * f[0];
        if (t < -slack) return false;
        // An outline that doubles back on the same line makes no right turn, but is not convex.
        if (t <= slack && e[0] * f[0] + e[1] * f[1] < -slack) return false;
        const int sign = e[0] > rounding_ ? 1 : e[0] < -rounding_ ? -1 : 0;
        if (sign == 0) continue;
        if (direction != 0 && sign != direction) ++changes;
        if (first_direction == 0) first_direction = sign;
        direction = sign;
    }
    return changes + (direction != first_direction ? 1 : 0) <= 2;
}

bool Triangulator::is_reflex(rt_u32 corner) const {
    return turn(prev_[corner], corner, next_[corner]) <= 0;
}

void Triangulator::build_grid() {
    const rt_u32 n = static_cast<rt_u32>(points_.size());
    rt_u32 reflex_count = 0;
    Point low = points_[0], high = points_[0];
    for (rt_u32 i = 0; i < n; ++i) {
        reflex_count += reflex_[i];
        for (int k = 0; k < 2; ++k) {
            low[k] = std::min(low[k], points_[i][k]);
            high[k] = std::max(high[k], points_[i][k]);
        }
    }
    grid_size_ = std::clamp(static_cast<rt_u32>(std::sqrt(double(reflex_count))), 1u, 1024u);
    grid_min_ = low;
    for (int k = 0; k < 2; ++k) cells_per_unit_[k] = high[k] > low[k] ? grid_size_ / (high[k] - low[k]) : 0;
    const auto cell = [&](const Point& p) {
        rt_u32 xy[2];
        for (int k = 0; k < 2; ++k) {
            xy[k] = std::min(static_cast<rt_u32>((p[k] - grid_min_[k]) * cells_per_unit_[k]), grid_size_ - 1);
        }
        return xy[1] * grid_size_ + xy[0];
    };
    cell_first_.assign(size_t(grid_size_) * grid_size_ + 1, 0);
    cell_items_.resize(reflex_count);
    for (rt_u32 i = 0; i < n; ++i) {
        if (reflex_[i]) ++cell_first_[cell(points_[i]) + 1];
    }
    for (size_t i = 1; i < cell_first_.size(); ++i) cell_first_[i] += cell_first_[i - 1];
    std::vector<rt_u32> at(cell_first_.begin(), cell_first_.end() - 1);
    for (rt_u32 i = 0; i < n; ++i) {
        if (reflex_[i]) cell_items_[at[cell(points_[i])]++] = i;
    }
}

// Whether the triangle at a corner may be cut off. leniency 0: no reflex corner lies inside or on it, except corners that
// coincide with one of its own (keyholes around holes have those). 1: none lies strictly inside. 2: flat corners count as ears
// too. 3: every corner does, for faces that cross themselves.
bool Triangulator::is_ear(rt_u32 corner, int leniency) {
    if (leniency == 3) return true;
    const rt_u32 a = prev_[corner], c = next_[corner];
    const double area = turn(a, corner, c);
    if (leniency == 2 ? area < 0 : area <= 0) return false;
    if (area == 0) return true;
    const Point &pa = points_[a], &pb = points_[corner], &pc = points_[c];
    rt_u32 low[2], high[2];
    for (int k = 0; k < 2; ++k) {
        const double least = std::min({pa[k], pb[k], pc[k]}), most = std::max({pa[k], pb[k], pc[k]});
        low[k] = std::min(static_cast<rt_u32>((least - grid_min_[k]) * cells_per_unit_[k]), grid_size_ - 1);
        high[k] = std::min(static_cast<rt_u32>((most - grid_min_[k]) * cells_per_unit_[k]), grid_size_ - 1);
    }
    const auto side = [](const Point& p, const Point& q, const Point& r) {
        return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
    };
    for (rt_u32 y = low[1]; y <= high[1]; ++y) {
        for (rt_u32 x = low[0]; x <= high[0]; ++x) {
            const size_t cell = size_t(y) * grid_size_ + x;
            const uint64_t cost = 1 + uint64_t(cell_first_[cell + 1]) - cell_first_[cell];
            budget_ = budget_ > cost ? budget_ - cost : 0;
            for (rt_u32 i = cell_first_[cell]; i < cell_first_[cell + 1]; ++i) {
                const rt_u32 k = cell_items_[i];
                if (!reflex_[k] || k == a || k == corner || k == c) continue;
                const Point& p = points_[k];
                if (p == pa || p == pb || p == pc) continue;
                const double s = side(pa, pb, p), t = side(pb, pc, p), u = side(pc, pa, p);
                if (leniency == 0 ? s >= 0 && t >= 0 && u >= 0 : s > 0 && t > 0 && u > 0) return false;
            }
        }
    }
    return true;
}

// Shape quality of an ear: it grows with the smallest angle.
double Triangulator::shape(rt_u32 corner) const {
    const Point &p = points_[prev_[corner]], &q = points_[corner], &r = points_[next_[corner]];
    const auto square = [](const Point& a, const Point& b) {
        return (a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]);
    };
    const double a = square(p, q), b = square(q, r), c = square(r, p);
    const double sharpest =
        std::max({(a + b - c) / std::sqrt(4 * a * b), (b + c - a) / std::sqrt(4 * b * c), (c + a - b) / std::sqrt(4 * c * a)});
    return std::isfinite(sharpest) ? 1 - sharpest : 0;
}

// Searches all `left` corners from `at` on for the ear of the best shape; returns `at` if there is no ear.
rt_u32 Triangulator::best_ear(rt_u32 at, rt_u32 left) {
    rt_u32 best = at;
    double best_shape = -1;
    for (rt_u32 i = 0; i < left; ++i, at = next_[at]) {
        if (!is_ear(at, 0)) continue;
        if (const double s = shape(at); s > best_shape) {
            best = at;
            best_shape = s;
        }
    }
    return best;
}

void Triangulator::clip_ears(const rt_u32* corners, std::vector<rt_u32>& out) {
    const rt_u32 n = static_cast<rt_u32>(points_.size());
    prev_.resize(n);
    next_.resize(n);
    reflex_.resize(n);
    for (rt_u32 i = 0; i < n; ++i) {
        prev_[i] = i > 0 ? i - 1 : n - 1;
        next_[i] = i + 1 < n ? i + 1 : 0;
    }
    for (rt_u32 i = 0; i < n; ++i) reflex_[i] = is_reflex(i);
    build_grid();

    const auto emit = [&](rt_u32 a, rt_u32 b, rt_u32 c) {
        for (const rt_u32 corner : {a, b, c}) out.push_back(corners[corner]);
    };
    // Small faces do not use the budget: their size bounds the time, and a huge face before them must not make them worse.
    const uint64_t budget = budget_;
    if (n <= kShaped) budget_ = ~uint64_t{0};
    rt_u32 at = 1, left = n, tried = 0;
    int leniency = 0;
    while (left > 3 && budget_ > 0) {
        if (leniency == 0 && tried == 0 && n <= kShaped) at = best_ear(at, left);
        if (!is_ear(at, leniency)) {
            at = next_[at];
            if (++tried >= left) {
                tried = 0;
                ++leniency;
            }
            continue;
        }
        const rt_u32 a = prev_[at], c = next_[at];
        emit(a, at, c);
        next_[a] = c;
        prev_[c] = a;
        reflex_[at] = 0;  // cut off, so it no longer blocks ears
        // A convex corner can become reflex only where the face crosses itself. Such a corner is not in the grid, so ears may
        // overlap there; but the face overlaps itself there anyway.
        for (const rt_u32 neighbour : {a, c}) reflex_[neighbour] = reflex_[neighbour] && is_reflex(neighbour);
        --left;
        tried = 0;
        leniency = 0;
        at = c;
    }
    if (n <= kShaped) budget_ = budget;
    given_up_ += left > 3 ? 1 : 0;
    const rt_u32 first = at;
    for (rt_u32 b = next_[first]; next_[b] != first; b = next_[b]) emit(first, b, next_[b]);
}

}  // namespace clarity
