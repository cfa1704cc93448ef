#include "ui/widgets/ray_text.hpp"

#include <cmath>
#include <cstdio>

#include "ui/session/session.hpp"
#include "ui/widgets/formats.hpp"
#include "ui/widgets/scene_rows.hpp"

namespace clarity::ui {
namespace {

std::string what_it_hit(const RayRecord& ray, const Scene& scene) {
    if (ray.prim < 0) return "nothing";
    const PrimPlace place = place_of_prim(scene, ray.prim);
    switch (place.kind) {
        case PrimPlace::Kind::triangle:
            if (place.instance < scene.instances.size()) return row_name(scene, RowKind::instance, place.instance);
            return "prim " + std::to_string(ray.prim);
        case PrimPlace::Kind::sphere:
            return row_name(scene, RowKind::sphere, place.index);
        case PrimPlace::Kind::polygon:
            return row_name(scene, RowKind::polygon, place.index);
        case PrimPlace::Kind::plane:
            return row_name(scene, RowKind::plane, place.index);
        case PrimPlace::Kind::shape:
            return row_name(scene, RowKind::shape, place.index);
        case PrimPlace::Kind::none:
            break;
    }
    return "prim " + std::to_string(ray.prim);
}

const char* kind_name(RayRecord::Kind kind) {
    switch (kind) {
        case RayRecord::Kind::camera:
            return "camera";
        case RayRecord::Kind::mirror:
            return "mirror";
        case RayRecord::Kind::refracted:
            return "refracted";
        case RayRecord::Kind::shadow:
            break;
    }
    return "shadow";
}

const char* fate_name(RayRecord::Fate fate) {
    switch (fate) {
        case RayRecord::Fate::traced:
            return "traced";
        case RayRecord::Fate::dropped:
            return "dropped: no ray slot was free";
        case RayRecord::Fate::too_light:
            return "not followed: adds too little";
        case RayRecord::Fate::too_deep:
            return "not followed: last generation";
        case RayRecord::Fate::unasked:
            break;
    }
    return "shadows are off";
}

std::string light_name(int index, const std::vector<std::string>& lights) {
    const bool known = index >= 0 && static_cast<size_t>(index) < lights.size();
    return known ? lights[static_cast<size_t>(index)] : "light " + std::to_string(index + 1);
}

}  // namespace

std::string triple_text(const std::array<float, 3>& v) {
    char text[64];
    std::snprintf(text, sizeof text, "%.3g  %.3g  %.3g", static_cast<double>(v[0]), static_cast<double>(v[1]),
                  static_cast<double>(v[2]));
    return text;
}

RayTotals totals_of(const RayTree& tree) {
    RayTotals totals;
    for (const RayRecord& ray : tree.rays) {
        totals.dropped += ray.fate == RayRecord::Fate::dropped;
        if (ray.fate != RayRecord::Fate::traced) continue;
        ++totals.traced;
        totals.shadow += ray.kind == RayRecord::Kind::shadow;
        totals.steps += ray.steps;
        totals.leaf_tests += ray.leaf_tests;
    }
    return totals;
}

RayChildren children_of(const RayTree& tree) {
    RayChildren children(tree.rays.size());
    for (size_t i = 0; i < tree.rays.size(); ++i) {
        const int parent = tree.rays[i].parent;
        if (parent >= 0 && static_cast<size_t>(parent) < i)
            children[static_cast<size_t>(parent)].push_back(static_cast<int>(i));
    }
    return children;
}

std::vector<std::string> names_of_lights(const Session& session) {
    std::vector<std::string> names;
    for (const DesiredLight& light : session.desired.lights)
        if (light.on) names.push_back(light.name);
    return names;
}

std::string ray_title(const RayRecord& ray, const Scene& scene, const std::vector<std::string>& lights) {
    if (ray.kind == RayRecord::Kind::shadow) {
        const char* outcome = ray.fate != RayRecord::Fate::traced ? fate_name(ray.fate) : ray.occluded ? "in shadow" : "lit";
        return light_name(ray.light_index, lights) + ": " + outcome;
    }
    if (ray.fate != RayRecord::Fate::traced) return std::string(kind_name(ray.kind)) + ", " + fate_name(ray.fate);
    return std::string(kind_name(ray.kind)) + " \u2192 " + what_it_hit(ray, scene);
}

std::string ray_distance(const RayRecord& ray) {
    if (ray.fate != RayRecord::Fate::traced || !std::isfinite(ray.t)) return {};
    char text[32];
    std::snprintf(text, sizeof text, "%.4g", static_cast<double>(ray.t));
    return text;
}

std::vector<std::pair<std::string, std::string>> ray_facts(const RayRecord& ray, const Scene& scene,
                                                           const std::vector<std::string>& lights) {
    std::vector<std::pair<std::string, std::string>> facts;
    const bool shadow = ray.kind == RayRecord::Kind::shadow, traced = ray.fate == RayRecord::Fate::traced;
    facts.emplace_back("Ray", std::string(kind_name(ray.kind)) + ", generation " + std::to_string(ray.generation));
    if (!traced) facts.emplace_back("Fate", fate_name(ray.fate));
    if (shadow) {
        facts.emplace_back("Light",
                           light_name(ray.light_index, lights) + (traced ? ray.occluded ? ", blocked" : ", seen" : ""));
    } else if (traced) {
        facts.emplace_back("Met", what_it_hit(ray, scene));
        if (ray.prim >= 0) facts.emplace_back("Primitive", std::to_string(ray.prim));
        if (ray.material >= 0 && static_cast<size_t>(ray.material) < scene.materials.size())
            facts.emplace_back("Material", row_name(scene, RowKind::material, static_cast<size_t>(ray.material)));
    }
    if (traced)
        facts.emplace_back(shadow ? "Distance to light" : "Distance", std::isfinite(ray.t) ? ray_distance(ray) : "endless");
    facts.emplace_back("Weight", triple_text(ray.weight));
    facts.emplace_back("Light added", triple_text(ray.light));
    if (traced) facts.emplace_back("Nodes visited", std::to_string(ray.steps));
    if (traced) facts.emplace_back("Leaf tests", std::to_string(ray.leaf_tests));
    facts.emplace_back("Origin", triple_text(ray.origin));
    facts.emplace_back("Direction", triple_text(ray.direction));
    return facts;
}

std::vector<std::string> ray_lines_of(const RayRecord& ray, const Scene& scene, const std::vector<std::string>& lights) {
    std::vector<std::string> lines;
    for (const auto& [label, value] : ray_facts(ray, scene, lights)) lines.push_back(label + ": " + value);
    return lines;
}

}  // namespace clarity::ui
