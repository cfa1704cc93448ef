#include "cell.hpp"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <utility>

namespace bsp {
namespace {

Point minus(const Point& a, const Point& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

Point cross(const Point& a, const Point& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

double dot(const Point& a, const Point& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

double area(const Point& a, const Point& b, const Point& c) {
    const Point n = cross(minus(b, a), minus(c, a));
    return 0.5 * std::sqrt(dot(n, n));
}

Point between(const Point& a, const Point& b, double t) {
    return {a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])};
}

Point normal(rt_u32 k) {
    return {BSP_COMPONENT(BSP_XS, k), BSP_COMPONENT(BSP_YS, k), BSP_COMPONENT(BSP_ZS, k)};
}

}  // namespace

double Profile::part(const double (&of)[kSteps + 1], double at) const {
    const double step = std::clamp((at - low) / (high - low) * kSteps, 0.0, double{kSteps});
    const int i = std::min(int(step), kSteps - 1);
    return of[i] + (step - i) * (of[i + 1] - of[i]);
}

Cell::Cell(const Box& box) {
    for (int axis = 0; axis < 3; ++axis)
        for (int side = 0; side < 2; ++side) {
            const int u = (axis + 1 + side) % 3, v = (axis + 2 - side) % 3;
            for (int i = 0; i < 4; ++i) {
                Point p;
                p[axis] = (side ? box.lo : box.hi)[axis];
                p[u] = (i == 1 || i == 2 ? box.hi : box.lo)[u];
                p[v] = (i > 1 ? box.hi : box.lo)[v];
                corners_.push_back(p);
            }
            end_face();
        }
}

// Ends the face of the corners that were added last, if it has a surface.
void Cell::end_face() {
    double sum = 0;
    for (size_t i = starts_.back() + 2; i < corners_.size(); ++i)
        sum += area(corners_[starts_.back()], corners_[i - 1], corners_[i]);
    if (sum > 0) {
        surface_ += sum;
        starts_.push_back(rt_u32(corners_.size()));
    } else {
        corners_.resize(starts_.back());
    }
}

// Cuts each face (Sutherland, Hodgman 1974), and closes the hole by a face of the corners that are then in the plane.
Cell Cell::half(rt_u32 k, double at, int side) const {
    Cell cell;
    const double sign = side == 0 ? 1 : -1;
    std::vector<Point> rim;
    for (size_t f = 0; f + 1 < starts_.size(); ++f) {
        for (rt_u32 i = starts_[f]; i < starts_[f + 1]; ++i) {
            const Point &p = corners_[i], &q = corners_[i + 1 < starts_[f + 1] ? i + 1 : starts_[f]];
            const double a = sign * (along(k, p) - at), b = sign * (along(k, q) - at);
            if (a <= 0) cell.corners_.push_back(p);
            if (a == 0) rim.push_back(p);
            if ((a < 0 && b > 0) || (a > 0 && b < 0)) {
                cell.corners_.push_back(between(p, q, a / (a - b)));
                rim.push_back(cell.corners_.back());
            }
        }
        cell.end_face();
    }
    if (rim.size() < 3) return cell;
    Point middle{0, 0, 0};
    for (const Point& p : rim)
        for (int i = 0; i < 3; ++i) middle[i] += p[i] / double(rim.size());
    // The corners of a convex face, by their angle around its middle. Those that several faces have count once.
    const Point n = normal(k);
    const Point u = n[0] != 0 ? Point{-n[1] - n[2], n[0], n[0]} : Point{1, 0, 0}, v = cross(n, u);
    std::vector<std::pair<double, Point>> around;
    const double u_unit = 1 / std::sqrt(dot(u, u)), v_unit = 1 / std::sqrt(dot(v, v));
    double size = 0;
    for (const Point& p : rim) {
        const Point from = minus(p, middle);
        size = std::max(size, dot(from, from));
        around.emplace_back(sign * std::atan2(dot(from, v) * v_unit, dot(from, u) * u_unit), p);
    }
    std::sort(around.begin(), around.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (const auto& [angle, p] : around) {
        const bool first = cell.corners_.size() == cell.starts_.back();
        const Point from = first ? Point{} : minus(p, cell.corners_.back());
        if (first || dot(from, from) > 1e-20 * size) cell.corners_.push_back(p);
    }
    cell.end_face();
    return cell;
}

// Each face is a fan of triangles. Of a triangle that spans the heights a <= b <= c, the part below a plane at s is a triangle
// until b and lacks one from there on. The cut is a polygon whose edges are those of these triangles with the plane: its
// surface is half of the sum of p x q of them, since edges within a face occur in both directions.
Profile Cell::profile(rt_u32 k) const {
    Profile profile;
    profile.low = INFINITY, profile.high = -INFINITY;
    std::vector<double> height;
    height.reserve(corners_.size());
    for (const Point& p : corners_) {
        height.push_back(along(k, p));
        profile.low = std::min(profile.low, height.back()), profile.high = std::max(profile.high, height.back());
    }
    const Point n = normal(k), origin = corners_.empty() ? Point{} : corners_[0];
    const double n_unit = 1 / std::sqrt(dot(n, n)), step = (profile.high - profile.low) / Profile::kSteps;
    double part[Profile::kSteps + 1] = {}, cut[Profile::kSteps + 1] = {}, ends[2] = {0, 0};  // ends: of faces along the planes
    for (size_t f = 0; f + 1 < starts_.size(); ++f)
        for (rt_u32 i = starts_[f] + 2; i < starts_[f + 1]; ++i) {
            const rt_u32 of[3] = {starts_[f], i - 1, i};
            const double h[3] = {height[of[0]], height[of[1]], height[of[2]]};
            double a = h[0], b = h[1], c = h[2];
            if (a > b) std::swap(a, b);
            if (b > c) std::swap(b, c);
            if (a > b) std::swap(a, b);
            const double all = area(corners_[of[0]], corners_[of[1]], corners_[of[2]]);
            if (c - profile.low < 1e-9 * (profile.high - profile.low)) ends[0] += all;
            if (profile.high - a < 1e-9 * (profile.high - profile.low)) ends[1] += all;
            for (int s = 1; s < Profile::kSteps; ++s) {
                const double at = profile.low + s * step;
                if (at < a) continue;
                if (at >= c) {
                    part[s] += all;
                    continue;
                }
                part[s] += at < b ? all * (at - a) * (at - a) / ((b - a) * (c - a))
                                  : all * (1 - (c - at) * (c - at) / ((c - a) * (c - b)));
                Point in{}, out{};  // where the triangle's outline goes below the plane, and where it comes back
                for (int e = 0; e < 3; ++e) {
                    const int next = e == 2 ? 0 : e + 1;
                    if ((h[e] > at) == (h[next] > at)) continue;
                    const Point p = between(corners_[of[e]], corners_[of[next]], (at - h[e]) / (h[next] - h[e]));
                    (h[e] > at ? in : out) = minus(p, origin);
                }
                cut[s] += 0.5 * n_unit * dot(n, cross(in, out));
            }
        }
    for (int s = 0; s <= Profile::kSteps; ++s) {
        const double edge = std::fabs(cut[s]);
        profile.below[s] = s == 0 ? 2 * ends[0] : s == Profile::kSteps ? surface_ : part[s] + edge;
        profile.above[s] = s == 0 ? surface_ : s == Profile::kSteps ? 2 * ends[1] : surface_ - part[s] + edge;
    }
    return profile;
}

Box Cell::box() const {
    Box box{{FLT_MAX, FLT_MAX, FLT_MAX}, {-FLT_MAX, -FLT_MAX, -FLT_MAX}};
    for (const Point& p : corners_)
        for (int i = 0; i < 3; ++i) {
            box.lo[i] = std::min(box.lo[i], std::nextafter(float(p[i]), -INFINITY));
            box.hi[i] = std::max(box.hi[i], std::nextafter(float(p[i]), INFINITY));
        }
    return box;
}

}  // namespace bsp
