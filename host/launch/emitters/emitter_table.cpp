#include "launch/emitters/emitter_table.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/angle.hpp"
#include "launch/emitters/sky_table.hpp"
#include "scene/emissive.hpp"
#include "scene/light_kinds.hpp"
#include "scene/vec.hpp"

namespace clarity {
namespace {

double mean(const rt_f32* color) {
    return (double(std::max(color[0], 0.f)) + std::max(color[1], 0.f) + std::max(color[2], 0.f)) / 3;
}

// The radius of a sphere around the scene; 1 if it has planes only.
double scene_radius(const Bounds& bounds) {
    const double radius = bounds.empty ? 0 : 0.5 * bounds.diagonal();
    return radius > 0 && std::isfinite(radius) ? radius : 1;
}

bool mirrors(const rt_f32* m) {
    return dot(to_vec(m), cross(to_vec(m + 4), to_vec(m + 8))) < 0;
}

// Moves emitters from the table into the light tree, for which they leave one entry there.
void plant_tree(const std::vector<LightBound>& bounds, EmitterTable& out, std::vector<double>& powers) {
    double power = 0;
    std::vector<LightBound> planted;
    for (const LightBound& bound : bounds)
        if (powers[bound.emitter] > 0) {
            planted.push_back(bound);
            power += std::exchange(powers[bound.emitter], 0);
        }
    if (planted.empty()) return;
    std::vector<rt_u32> leaves;
    out.nodes = build_light_tree(planted, leaves);
    for (size_t i = 0; i < planted.size(); ++i) out.emitters[planted[i].emitter].leaf = leaves[i];
    rt_emitter tree{};
    tree.kind = RT_EMITTER_TREE;
    tree.instance = tree.leaf = RT_NONE;
    out.emitters.push_back(tree);
    powers.push_back(power);
}

void set_sky(const SkyValues& values, const View& view, rt_lighting& out) {
    const bool given = values.kind != RT_NONE;
    out.sky_emitter = RT_NONE;
    out.sky_kind = given ? values.kind : RT_SKY_CONSTANT;
    out.sky_width = values.width;
    out.sky_height = values.height;
    out.sky_hidden = given ? values.hidden : 0;
    out.sky_turn = static_cast<float>(values.rotate_deg / 360.0 - std::floor(values.rotate_deg / 360.0));
    for (int k = 0; k < 3; ++k) {
        out.background[k] = view.background[k];
        out.sky_color[k] = given ? values.strength * values.color[k] : view.background[k];
        out.sky_horizon[k] = values.strength * values.horizon[k];
        out.sky_ground[k] = values.strength * values.ground[k];
    }
    const double ground = mean(out.sky_ground), horizon = mean(out.sky_horizon), above = horizon + mean(out.sky_color);
    out.sky_below = deal({2 * ground, above}, RT_PICKS)[0];
    out.sky_horizon_share = above > 0 ? static_cast<float>(horizon / above) : 0;
}

// The integral of the mean color over all directions.
double flux_of_sky(const rt_lighting& sky, const SkyTable& picture) {
    switch (sky.sky_kind) {
        case RT_SKY_PICTURE:
            return mean(sky.sky_color) * picture.flux;
        case RT_SKY_GRADIENT:
            return kPi * (mean(sky.sky_color) + mean(sky.sky_horizon) + 2 * mean(sky.sky_ground));
    }
    return 4 * kPi * mean(sky.sky_color);
}

// Collects the emissive primitives, by ascending numbers.
class Collector {
 public:
    Collector(const Scene& scene, const AccelData& accel, const MovedPrims* moved, const View& view, EmitterTable& out,
              std::vector<double>& powers, std::vector<LightBound>* bounds)
        : scene_(scene),
          accel_(accel),
          leaves_(moved ? moved->leaves.data() : static_cast<const rt_packed_prim*>(accel.leaves.data())),
          instances_(moved ? moved->instances : accel.instances),
          view_(view),
          out_(out),
          powers_(powers),
          bounds_(bounds) {
        for (size_t i = 0; i < scene.materials.size(); ++i) {
            emits_.push_back(emits(material(i)) && is_drawn(material(i), scene.materials[i]));
            emits_evenly_.push_back(emits_.back() && scene.materials[i].maps[RT_MAP_EMISSION] == RT_NONE);
        }
    }

    void collect() {
        if (std::find(emits_.begin(), emits_.end(), true) != emits_.end()) {
            add_triangles();
            add_spheres();
            add_polygons();
        }
        if (!out_.runs.empty()) {
            out_.lighting.run_count = rt_u32(out_.runs.size());
            out_.runs.push_back({RT_NONE, rt_u32(out_.emitters.size())});
        }
    }

 private:
    const MaterialValues& material(size_t i) const { return material_of(scene_, view_, i); }
    const rt_packed_prim& leaf(rt_u32 at) const { return leaves_[at]; }

    // For each primitive of a kind that emits, by its ref: one of the leaves that hold it. A primitive that was cut is in
    // several leaves. all: primitives count whatever their own material is, because an instance may have one that
    // emits. Light of a map is drawn from triangles only.
    std::vector<rt_u32> leaves_of(rt_u32 kind, size_t count, bool all) const {
        const std::vector<bool>& emits = kind == RT_REF_TRIANGLE ? emits_ : emits_evenly_;
        std::vector<rt_u32> found(count, RT_NONE);
        for (uint64_t at = 0; at < accel_.leaf_count; ++at) {
            const rt_packed_prim& prim = leaf(rt_u32(at));
            if (RT_REF_KIND(prim.ref) == kind && (all || emits[prim.material])) found[RT_REF_INDEX(prim.ref)] = rt_u32(at);
        }
        return found;
    }

    // bound_of(): of its place and normal, called for a light tree alone. facing: the largest area that is seen of it from one
    // side. share: of the material's emission that it has in the mean.
    template <class BoundOf>
    void add(rt_u32 at, rt_u32 instance, rt_u32 prim, rt_u32 of_material, double area, double facing, const BoundOf& bound_of,
             double share = 1) {
        if (!(share > 0) || !(area > 0) || !std::isfinite(area)) return;
        if (out_.emitters.size() >= kMostPicked) {
            ++out_.left_out;
            return;
        }
        const auto number = rt_u32(out_.emitters.size());
        if (out_.runs.empty() || prim - out_.runs.back().first_prim != number - out_.runs.back().first_emitter)
            out_.runs.push_back({prim, number});
        rt_emitter emitter{};
        emitter.kind = RT_EMITTER_SURFACE;
        emitter.at = at;
        emitter.instance = instance;
        emitter.leaf = RT_NONE;
        emitter.area = static_cast<float>(area);
        out_.emitters.push_back(emitter);
        const rt_material& m = material(of_material);
        if (bounds_) {
            LightBound& bound = bounds_->emplace_back(bound_of());
            bound.intensity = share * facing * mean(m.emission);
            bound.two_sided = !(m.flags & RT_MATERIAL_ONE_SIDED);
            bound.emitter = number;
        }
        powers_.push_back(share * area * kPi * mean(m.emission) * (m.flags & RT_MATERIAL_ONE_SIDED ? 1 : 2));
    }

    // A triangle of the world or of an instance, before they are in order.
    struct Found {
        rt_u32 prim, at, instance, material;
        std::array<Vec, 3> corners;
        bool mirrored;  // by its instance, so that the corners run the other way round
    };

    static std::array<Vec, 3> corners_of(const rt_packed_prim& prim, const Affine* placed) {
        std::array<Vec, 3> corners = {to_vec(prim.a), to_vec(prim.b), to_vec(prim.c)};
        for (size_t c = 0; placed && c < 3; ++c) {
            const Vec in_mesh = corners[c];
            for (size_t k = 0; k < 3; ++k) {
                const float* const row = placed->data() + 4 * k;
                corners[c][k] = row[0] * in_mesh[0] + row[1] * in_mesh[1] + row[2] * in_mesh[2] + row[3];
            }
        }
        return corners;
    }

    void add_triangles() {
        const BuildScene& build = accel_.scene;
        const bool by_instance = std::any_of(instances_.begin(), instances_.end(),
                                             [&](const rt_instance& i) { return i.material != RT_NONE && emits_[i.material]; });
        const std::vector<rt_u32> leaves = leaves_of(RT_REF_TRIANGLE, build.attribute_triangle.size(), by_instance);
        std::vector<Found> found;
        const auto add_group = [&](rt_u32 group, rt_u32 instance) {
            const rt_u32 first = build.first_ref_of_group[group],
                         end = group == 0 ? rt_u32(leaves.size()) : first + build.groups[group].count;
            const rt_instance* const placed = instance == RT_NONE ? nullptr : &instances_[instance];
            Affine world = kIdentity;
            bool mirrored = false;
            if (placed) {
                mirrored = mirrors(placed->object_from_world);
                Affine inverse;
                std::copy_n(placed->object_from_world, 12, inverse.begin());
                invert(inverse, world);
            }
            for (rt_u32 ref = first; ref < end; ++ref) {
                if (leaves[ref] == RT_NONE) continue;
                const rt_packed_prim& prim = leaf(leaves[ref]);
                const rt_u32 of = placed && placed->material != RT_NONE ? placed->material : prim.material;
                if (!emits_[of]) continue;
                found.push_back({(placed ? placed->first_prim : 0) + prim.prim, leaves[ref], instance, of,
                                 corners_of(prim, placed ? &world : nullptr), mirrored});
            }
        };
        add_group(0, RT_NONE);
        for (rt_u32 i = 0; i < instances_.size(); ++i)
            if ((instances_[i].hidden & RT_SEEN_BY_ALL) != RT_SEEN_BY_ALL) add_group(build.group_of_instance[i], i);
        std::sort(found.begin(), found.end(), [](const Found& a, const Found& b) { return a.prim < b.prim; });
        for (const Found& f : found) {
            const rt_u32 map = scene_.materials[f.material].maps[RT_MAP_EMISSION];
            const rt_u32 triangle = build.attribute_triangle[RT_REF_INDEX(leaf(f.at).ref)];
            const Vec normal = cross(f.corners[1] - f.corners[0], f.corners[2] - f.corners[0]);
            const double area = 0.5 * length(normal);
            add(
                f.at, f.instance, f.prim, f.material, area, area,
                [&] { return bound_of_flat(f.corners.data(), 3, (f.mirrored ? -1.0 : 1.0) * normal); },
                map == RT_NONE ? 1 : mean_of_map(scene_, map, triangle));
        }
    }

    void add_spheres() {
        const std::vector<rt_u32> leaves = leaves_of(RT_REF_SPHERE, accel_.scene.spheres.size(), false);
        for (const rt_u32 at : leaves)
            if (at != RT_NONE) {
                const double radius = leaf(at).b[0], disc = kPi * radius * radius;
                add(at, RT_NONE, leaf(at).prim, leaf(at).material, 4 * disc, disc,
                    [&] { return bound_of_ball(to_vec(leaf(at).a), radius); });
            }
    }

    void add_polygons() {
        const BuildScene& build = accel_.scene;
        const std::vector<rt_u32> leaves = leaves_of(RT_REF_POLYGON, build.polygons.size(), false);
        for (size_t i = 0; i < leaves.size(); ++i) {
            if (leaves[i] == RT_NONE) continue;
            const rt_polygon& polygon = build.polygon_table[i];
            const float* const corners = &build.polygon_corners[3 * size_t(polygon.first)];
            if (!is_convex(corners, polygon.count)) continue;
            std::vector<Vec> all;
            for (rt_u32 c = 0; c < polygon.count; ++c) all.push_back(to_vec(corners + 3 * size_t(c)));
            double area = 0;
            for (rt_u32 c = 2; c < polygon.count; ++c) area += 0.5 * length(cross(all[c - 1] - all[0], all[c] - all[0]));
            add(leaves[i], RT_NONE, leaf(leaves[i]).prim, leaf(leaves[i]).material, area, area,
                [&] { return bound_of_flat(all.data(), all.size(), to_vec(leaf(leaves[i]).a)); });
        }
    }

    const Scene& scene_;
    const AccelData& accel_;
    const rt_packed_prim* const leaves_;
    const std::vector<rt_instance>& instances_;
    const View& view_;
    EmitterTable& out_;
    std::vector<double>& powers_;
    std::vector<LightBound>* const bounds_;  // nullptr: there is no light tree
    // So that light is drawn from it, and from all of it alike.
    std::vector<bool> emits_, emits_evenly_;
};

}  // namespace

const std::vector<const char*>& emitter_headers() {
    static const std::vector<const char*> headers = {"shading/light_tree.h", "shading/emitter_table.h", "shading/sky.h",
                                                     "shading/emitters.h", "shading/emission.h"};
    return headers;
}

bool has_emitting_surfaces(const Scene& scene, const View& view) {
    for (size_t i = 0; i < scene.materials.size(); ++i)
        if (emits(material_of(scene, view, i))) return true;
    return false;
}

EmitterTable make_emitter_table(const Scene& scene, const AccelData& accel, const View& view, const SkyTable& sky,
                                const MovedPrims* moved, bool tree) {
    EmitterTable out;
    std::vector<double> powers;
    std::vector<LightBound> bounds;  // of those that fit into a light tree
    const double radius = scene_radius(accel.scene.bounds);
    for (const rt_light& light : view.lights) {
        rt_emitter emitter{};
        emitter.kind = light.kind;
        emitter.at = rt_u32(out.emitters.size());
        emitter.instance = emitter.leaf = RT_NONE;
        LightBound bound;
        if (tree && bound_light(light, bound)) {
            bound.emitter = emitter.at;
            bound.intensity *= mean(light.color);
            bounds.push_back(bound);
        }
        out.emitters.push_back(emitter);
        powers.push_back(light_kind_of(light).power(light, radius) * mean(light.color));
        out.lighting.sun_count += light.kind == RT_LIGHT_SUN;
    }
    const SkyValues& values = sky_of(scene, view);
    set_sky(values, view, out.lighting);
    out.lighting.sky_scale = sky.scale;
    if (const double flux = flux_of_sky(out.lighting, sky); flux > 0) {
        out.lighting.sky_emitter = rt_u32(out.emitters.size());
        rt_emitter emitter{};
        emitter.kind = RT_EMITTER_SKY;
        emitter.instance = emitter.leaf = RT_NONE;
        out.emitters.push_back(emitter);
        powers.push_back(flux * kPi * radius * radius);
    }
    Collector(scene, accel, moved, view, out, powers, tree ? &bounds : nullptr).collect();
    // A file that says what lies behind its objects says what lights them. Without a word of it, lights that stand in stay.
    const bool lit = values.kind != RT_NONE || has_emitting_surfaces(scene, view) ||
                     (scene.background != Scene{}.background && out.lighting.sky_emitter != RT_NONE);
    for (size_t i = 0; lit && i < view.lights.size(); ++i)
        if (view.lights[i].flags & RT_LIGHT_STAND_IN) powers[i] = 0;
    if (tree) plant_tree(bounds, out, powers);
    const bool any = std::any_of(powers.begin(), powers.end(), [](double power) { return power > 0; });
    out.lighting.emitter_count = any ? rt_u32(powers.size()) : 0;
    out.lighting.cell_bits = fill_pick_table(powers, out.emitters);
    if (!out.nodes.empty()) {
        const float share = out.emitters[powers.size() - 1].pick;  // of the tree
        for (size_t i = 0; i + 1 < powers.size(); ++i)
            if (out.emitters[i].leaf != RT_NONE) out.emitters[i].pick = share;
    }
    return out;
}

}  // namespace clarity
