// shape_stand.hpp -- what the checks of one shape's kernels share: shapes, rays, what they touch, and compiled kernels.
#pragma once
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "tools/check/hits/hits_checks.hpp"
#include "tools/check/shapes/touches.hpp"

namespace clarity::check {

// A part of a shape with its rays. The touches are those of the first program.
struct TouchedPart {
    ShapeSubject subject;
    size_t trial = 0;  // in ShapeStand::trials()
    std::vector<rt_ray> rays;
    std::vector<Touch> touches;
    std::vector<ProbeSurface> surfaces;  // one for each touch
};

class ShapeStand {
 public:
    ShapeStand(const rt_plugin& plugin, const rt_plugin* accel, std::function<std::shared_ptr<Device>()> open,
               const HitsOptions& options)
        : plugin_(plugin), accel_(accel), open_(std::move(open)), options_(options) {}

    const rt_plugin& plugin() const { return plugin_; }
    const rt_plugin* accel() const { return accel_; }
    const HitsOptions& options() const { return options_; }
    std::vector<Variant> variants(const Step& step);
    std::shared_ptr<Device> device(const Step& step);
    ShapeProbe& probe(const Variant& variant, const Step& step);
    ShapeProbe& first_probe(const Step& step) { return probe(variants(step).front(), step); }
    // Shapes with usual values. Throws Error if the plugin accepts none.
    const std::vector<ShapeTrial>& trials(const Step& step);
    const std::vector<TouchedPart>& parts(const Step& step);

 private:
    const rt_plugin& plugin_;
    const rt_plugin* const accel_;
    const std::function<std::shared_ptr<Device>()> open_;
    HitsOptions options_;
    std::shared_ptr<Device> device_;
    std::map<std::string, std::unique_ptr<ShapeProbe>> probes_;
    std::vector<ShapeTrial> trials_;
    std::vector<TouchedPart> parts_;
};

inline constexpr double kShapeCompile_s = 40, kShapeTrace_s = 10;  // processor time of steps; programs take 2 to 5 s

// Points of touches, for ShapeProbe::surfaces().
std::vector<ProbePoint> points_of(const std::vector<Touch>& touches);

// Wrong answers to rays at shapes, and what they have in common.
class RayFindings {
 public:
    void tried(size_t rays = 1) { tried_ += rays; }
    // from_behind: whether the ray comes from the back of the surface, as its normal says.
    void wrong(const ShapeSubject& subject, const rt_ray& ray, bool from_behind, const std::string& found);
    bool empty() const { return wrong_ == 0; }
    size_t tried_count() const { return tried_; }
    size_t wrong_count() const { return wrong_; }
    // "12 of 3000 rays ...", with the first one. what: "miss the surface where another ray meets it".
    std::string text(const std::string& what) const;

 private:
    size_t tried_ = 0, wrong_ = 0, behind_ = 0;
    std::map<std::string, size_t> octants_;
    std::string first_;
};

}  // namespace clarity::check
