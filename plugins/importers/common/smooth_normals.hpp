// smooth_normals.hpp -- normals of a mesh from which of its edges are smooth. For importers.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include "rt_plugin.h"

namespace importers {

// Three numbers for each corner. Around a vertex, faces that meet at smooth edges share one normal: the sum of theirs, weighted
// by their angles at the vertex (Thuermer, Wuethrich 1998, "Computing vertex normals from polygonal facets"). positions: 3 for
// each vertex. corners: a vertex each; those that do not exist get zeros. sizes: corners of each face, or empty: three.
// is_smooth(a, b): whether the edge is smooth that begins at corner a in one face and at corner b in the other. Edges of one
// face, or of three and more, are hard.
template <class IsSmooth>
std::vector<float> smooth_normals(const std::vector<float>& positions, const std::vector<int32_t>& corners,
                                  const std::vector<rt_u32>& sizes, const IsSmooth& is_smooth) {
    using Vec = std::array<double, 3>;
    const size_t vertices = positions.size() / 3;
    const auto is_known = [&](size_t corner) { return static_cast<uint32_t>(corners[corner]) < vertices; };
    const auto edge = [&](size_t from, size_t to) {
        Vec out{};
        for (size_t k = 0; k < 3 && is_known(from) && is_known(to); ++k)
            out[k] = double(positions[3 * size_t(corners[to]) + k]) - positions[3 * size_t(corners[from]) + k];
        return out;
    };
    const auto cross = [](const Vec& a, const Vec& b) {
        return Vec{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    };
    const auto dot = [](const Vec& a, const Vec& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; };

    std::vector<uint32_t> next(corners.size()), group(corners.size());
    std::vector<Vec> sums(corners.size());
    std::iota(group.begin(), group.end(), 0u);
    for (size_t face = 0, first = 0; first < corners.size(); ++face) {
        const size_t size = std::min<size_t>(face < sizes.size() ? sizes[face] : 3, corners.size() - first), end = first + size;
        Vec normal{};
        for (size_t c = first; c < end; ++c) {
            next[c] = static_cast<uint32_t>(c + 1 < end ? c + 1 : first);
            const Vec part = cross(edge(first, c), edge(first, next[c]));
            for (size_t k = 0; k < 3; ++k) normal[k] += part[k];
        }
        const double length = std::sqrt(dot(normal, normal));
        for (size_t c = first; c < end && length > 0; ++c) {
            const Vec out = edge(c, next[c]), back = edge(c, c > first ? c - 1 : end - 1), turn = cross(out, back);
            const double angle = std::atan2(std::sqrt(dot(turn, turn)), dot(out, back));
            for (size_t k = 0; k < 3; ++k) sums[c][k] = normal[k] / length * angle;
        }
        first = end;
    }
    // Corners that share a normal are one group, whose first corner has the sum.
    const auto root = [&](uint32_t c) {
        while (group[c] != c) c = group[c] = group[group[c]];
        return c;
    };
    const auto join = [&](uint32_t a, uint32_t b) {
        const auto [low, high] = std::minmax({root(a), root(b)});
        if (low == high) return;
        group[high] = low;
        for (size_t k = 0; k < 3; ++k) sums[low][k] += sums[high][k];
    };
    struct Edge {
        uint64_t vertices;
        uint32_t corner;
    };
    std::vector<Edge> edges;
    for (uint32_t c = 0; c < corners.size(); ++c) {
        if (!is_known(c) || !is_known(next[c])) continue;
        const auto [low, high] = std::minmax({uint64_t(corners[c]), uint64_t(corners[next[c]])});
        edges.push_back({low << 32 | high, c});
    }
    std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
        return a.vertices != b.vertices ? a.vertices < b.vertices : a.corner < b.corner;
    });
    for (size_t i = 0, end = 0; i < edges.size(); i = end) {
        for (end = i + 1; end < edges.size() && edges[end].vertices == edges[i].vertices;) ++end;
        if (end - i != 2 || !is_smooth(edges[i].corner, edges[i + 1].corner)) continue;
        uint32_t a = edges[i].corner, b = edges[i + 1].corner, after = next[b];
        if (corners[a] != corners[b]) std::swap(b, after);
        join(a, b);
        join(next[a], after);
    }
    std::vector<float> normals(3 * corners.size());
    for (uint32_t c = 0; c < corners.size(); ++c) {
        const Vec& sum = sums[root(c)];
        const double length = std::sqrt(dot(sum, sum));
        for (size_t k = 0; k < 3 && length > 0; ++k) normals[3 * size_t(c) + k] = static_cast<float>(sum[k] / length);
    }
    return normals;
}

}  // namespace importers
