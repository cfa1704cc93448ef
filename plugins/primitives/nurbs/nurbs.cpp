// nurbs: a rational spline surface, handed over as rational Bezier patches.
#include <algorithm>
#include <cmath>

#include "rt_plugin.hpp"
#include "spline.hpp"

namespace {

enum { kDegreeU, kDegreeV, kColumns, kPoints, kWeights, kKnotsU, kKnotsV };

std::vector<double> numbers_of(const rt_key_values& values) {
    return {values.numbers, values.numbers + values.count};
}

nurbs::Surface read(const rt_host* host, const rt_key_values* values) {
    nurbs::Surface surface;
    const size_t points = values[kPoints].count / 3, columns = static_cast<size_t>(values[kColumns].numbers[0]);
    if (points % columns != 0)
        throw rt::fail(host, std::to_string(points) + " `points` are no full rows of `columns` " + std::to_string(columns));
    const std::vector<double> weights = numbers_of(values[kWeights]);
    if (!weights.empty() && weights.size() != points)
        throw rt::fail(host, std::to_string(weights.size()) + " `weights`; expected one for each of " + std::to_string(points) +
                                 " points");
    for (size_t i = 0; i < points; ++i) {
        const double w = weights.empty() ? 1 : weights[i];
        if (!(w > 0)) throw rt::fail(host, "weight " + std::to_string(i + 1) + " is not above 0");
        const float* p = values[kPoints].numbers + 3 * i;
        surface.points.push_back({p[0] * w, p[1] * w, p[2] * w, w});
    }
    surface.u = {static_cast<int>(values[kDegreeU].numbers[0]), static_cast<int>(columns), numbers_of(values[kKnotsU])};
    surface.v = {static_cast<int>(values[kDegreeV].numbers[0]), static_cast<int>(points / columns),
                 numbers_of(values[kKnotsV])};
    for (const std::string& why : {surface.u.complete('u'), surface.v.complete('v')})
        if (!why.empty()) throw rt::fail(host, why);
    return surface;
}

// numbers: degrees, ranges of the parameters, a point in the middle. more: the patch's points, relative to that.
void hand_over(const nurbs::Surface& surface, const nurbs::Patch& patch, const rt_shape_output* out) {
    float lo[3], hi[3];
    for (size_t k = 0; k < 3; ++k) {
        lo[k] = INFINITY;
        hi[k] = -INFINITY;
        for (const nurbs::Homogeneous& p : patch.points) {  // the surface lies within the hull of its points
            lo[k] = std::min(lo[k], static_cast<float>(p[k] / p[3]));
            hi[k] = std::max(hi[k], static_cast<float>(p[k] / p[3]));
        }
    }
    float numbers[9] = {static_cast<float>(surface.u.degree), static_cast<float>(surface.v.degree)};
    for (size_t k = 0; k < 2; ++k) {
        numbers[2 + k] = static_cast<float>(patch.u[k]);
        numbers[4 + k] = static_cast<float>(patch.v[k]);
    }
    for (size_t k = 0; k < 3; ++k) numbers[6 + k] = 0.5f * (lo[k] + hi[k]);
    std::vector<float> more;
    double most = 0;  // only ratios of weights matter
    for (const nurbs::Homogeneous& p : patch.points) most = std::max(most, p[3]);
    for (const nurbs::Homogeneous& p : patch.points) {
        for (size_t k = 0; k < 3; ++k) more.push_back(static_cast<float>((p[k] - p[3] * numbers[6 + k]) / most));
        more.push_back(static_cast<float>(p[3] / most));
    }
    rt::part(out, lo, hi, numbers, 9, more.data(), more.size());
}

int32_t prepare(const rt_host* host, const rt_key_values* values, const rt_shape_output* out) {
    const nurbs::Surface surface = read(host, values);
    for (const nurbs::Patch& patch : nurbs::patches(surface)) hand_over(surface, patch, out);
    return RT_OK;
}

constexpr rt_key keys[] = {
    rt::whole_key("degree_u", "of its curves along u", 1, nurbs::kMaxDegree, 3),
    rt::whole_key("degree_v", "of its curves along v", 1, nurbs::kMaxDegree, 3),
    rt::whole_key("columns", "points along u", 2, 1 << 20, 4),
    rt::key(RT_KEY_POINTS, "points", "x y z of all points, row after row along u"),
    rt::list_key(RT_KEY_NUMBERS, "weights", "of all points, above 0; without them all are 1"),
    rt::list_key(RT_KEY_NUMBERS, "knots_u", "ascending; without them the surface ends at its outer points"),
    rt::list_key(RT_KEY_NUMBERS, "knots_v", "ascending; without them the surface ends at its outer points"),
};
constexpr rt_cl_file files[] = {
#include "nurbs.inc"
};
constexpr rt_primitive primitive =
    rt::primitive(keys, rt::file(files, "nurbs.cl"), nullptr, rt::guarded<prepare>, RT_SHAPE_SINGLE_RAY);

}  // namespace

extern "C" RT_EXPORT const rt_plugin rt_plugin_v1 =
    rt::primitive_plugin("nurbs", "NURBS surface", "1.0.0",
                         "Nishita, Sederberg, Kakimoto 1990, Ray Tracing Trimmed Rational Surface Patches", primitive);
