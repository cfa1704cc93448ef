#include "tools/check/shapes/shape_stand.hpp"

#include <algorithm>

#include "base/error.hpp"
#include "stand/ray_text.hpp"
#include "stand/seed.hpp"

namespace clarity::check {
namespace {

constexpr size_t kShapes = 16, kQuickShapes = 5;
constexpr size_t kRaysOfPart = 600, kQuickRaysOfPart = 240;
constexpr size_t kPartsOfShape = 3;  // most

std::string signs_of(const rt_ray& ray) {
    std::string text = "(";
    for (int k = 0; k < 3; ++k) text += std::string(k ? "," : "") + (std::signbit(ray.direction[k]) ? "-" : "+");
    return text + ")";
}

}  // namespace

std::vector<Variant> ShapeStand::variants(const Step& step) {
    device(step);
    std::vector<Variant> list;
    for (const int lanes : options_.lanes) list.push_back(Variant::plain(lanes));
    if (!options_.quick) list.push_back({options_.lanes.back(), false, true});
    return list;
}

std::shared_ptr<Device> ShapeStand::device(const Step& step) {
    if (!device_) {
        step("opening the device", kShapeCompile_s);
        device_ = open_();
        fit_lanes(options_, device_->info());
    }
    return device_;
}

ShapeProbe& ShapeStand::probe(const Variant& variant, const Step& step) {
    std::unique_ptr<ShapeProbe>& known = probes_[variant.text()];
    if (!known) {
        const auto on = device(step);
        step("compiling for " + variant.text(), kShapeCompile_s);
        known = std::make_unique<ShapeProbe>(plugin_, on, variant);
    }
    return *known;
}

const std::vector<ShapeTrial>& ShapeStand::trials(const Step& step) {
    if (!trials_.empty()) return trials_;
    step("making shapes with usual values", kShapeTrace_s);
    trials_ = accepted_trials(plugin_, options_.quick ? kQuickShapes : kShapes, options_.seed);
    if (trials_.empty()) throw Error(Exit::failed, "it accepts no values of about 1 (see keys.values)");
    return trials_;
}

const std::vector<TouchedPart>& ShapeStand::parts(const Step& step) {
    if (!parts_.empty()) return parts_;
    ShapeProbe& with = first_probe(step);
    std::mt19937 random = random_of(3, options_.seed);
    std::vector<TouchedPart> parts;
    for (size_t i = 0; i < trials(step).size(); ++i)
        for (ShapeSubject& subject : subjects_of(plugin_, trials_[i], kPartsOfShape)) {
            if (!(subject.size > 0)) continue;
            TouchedPart part;
            part.trial = i;
            part.subject = std::move(subject);
            const size_t count = options_.rays > 0 ? options_.rays : options_.quick ? kQuickRaysOfPart : kRaysOfPart;
            part.rays = rays_at(part.subject, count, random);
            step("tracing rays at " + part.subject.what, kShapeTrace_s);
            part.touches = touches_of(with, part.subject, part.rays);
            step("computing the surface of " + part.subject.what, kShapeTrace_s);
            part.surfaces = with.surfaces(part.subject, points_of(part.touches));
            parts.push_back(std::move(part));
        }
    parts_ = std::move(parts);
    return parts_;
}

std::vector<ProbePoint> points_of(const std::vector<Touch>& touches) {
    std::vector<ProbePoint> points;
    for (const Touch& touch : touches) {
        ProbePoint point{{}, touch.hit.u, touch.hit.v};
        for (size_t k = 0; k < 3; ++k) point.at[k] = static_cast<float>(touch.at[k]);
        points.push_back(point);
    }
    return points;
}

void RayFindings::wrong(const ShapeSubject& subject, const rt_ray& ray, bool from_behind, const std::string& found) {
    if (wrong_++ == 0) first_ = "ray " + ray_text(ray) + " at " + subject.what + ": " + found;
    behind_ += from_behind;
    ++octants_[signs_of(ray)];
}

std::string RayFindings::text(const std::string& what) const {
    std::string text = std::to_string(wrong_) + " of " + std::to_string(tried_) + " " + what;
    if (wrong_ > 2 && octants_.size() == 1) text += "; all of them have the direction signs " + octants_.begin()->first;
    if (wrong_ > 2 && behind_ == wrong_) text += "; all of them come from behind the surface, as its normal says";
    return text + ". The first: " + first_;
}

}  // namespace clarity::check
