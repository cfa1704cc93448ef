#include "bench/cases/analysis.hpp"

#include <algorithm>
#include <utility>

namespace clarity::bench {
namespace {

constexpr size_t kWarp = 32;

double ratio(double a, double b) {
    return b > 0 ? a / b : 0;
}

// Share of a warp's time in which its rays do work: all rays of a warp wait for the ray which visits most nodes.
double warp_alive(const std::vector<rt_ray>& rays, const std::vector<rt_hit>& hits) {
    double visited = 0, waited = 0;
    for (size_t first = 0; first < rays.size(); first += kWarp) {
        rt_u32 most = 0;
        for (size_t i = first; i < std::min(first + kWarp, rays.size()); ++i) {
            if (!is_active(rays[i])) continue;
            visited += hits[i].steps;
            most = std::max(most, hits[i].steps);
        }
        waited += double(kWarp) * most;
    }
    return ratio(visited, waited);
}

}  // namespace

Analysis analyze(const std::vector<rt_ray>& rays, const std::vector<rt_hit>& hits, const std::vector<RayWork>& work,
                 unsigned lanes, unsigned node_bytes) {
    double active = 0, nodes = 0, leaves = 0, own = 0, nodes_sat = 0, leaves_sat = 0, boxes_sat = 0;
    RayWork reported;  // not 0: a packet has some
    for (size_t first = 0; first < rays.size(); first += lanes) {
        double in_packet = 0;
        for (size_t i = first; i < std::min(first + lanes, rays.size()); ++i) in_packet += is_active(rays[i]);
        if (in_packet == 0) continue;
        const rt_hit& counted = hits[first];  // each ray holds the sums of its packet
        active += in_packet;
        nodes += counted.steps;
        leaves += counted.leaf_tests;
        own += counted.lane_steps;
        nodes_sat += in_packet * counted.steps;
        leaves_sat += in_packet * counted.leaf_tests;
        const RayWork& more = work[first];
        boxes_sat += in_packet * (double(more.boxes) + more.own_boxes);
        reported.own_steps |= more.own_steps;
        reported.own_boxes |= more.own_boxes;
        reported.own_tests |= more.own_tests;
    }
    Analysis a;
    a.present = active > 0;
    a.node_bytes = node_bytes;
    a.nodes_per_ray = ratio(nodes_sat, active);
    a.own_nodes_per_ray = ratio(own, active);
    a.leaf_tests_per_ray = ratio(leaves_sat, active);
    a.boxes_per_ray = ratio(boxes_sat, active);
    for (const auto& [count, name] :
         {std::pair(reported.own_steps, "nodes"), {reported.own_boxes, "boxes"}, {reported.own_tests, "tests"}})
        if (count != 0) a.reported += (a.reported.empty() ? "" : ", ") + std::string(name);
    a.lanes_alive = ratio(own, nodes * lanes);
    if (lanes == 1) a.warp_alive = warp_alive(rays, hits);
    a.bytes_per_ray = ratio(nodes * node_bytes + leaves * sizeof(rt_packed_prim), active);
    a.bytes_shared = own > 0 ? std::max(0.0, 1 - nodes / own) : 0;
    return a;
}

}  // namespace clarity::bench
