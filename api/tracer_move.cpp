// tracer_move.cpp -- moves what a tracer traces: its structure is refitted, or built anew where that pays.
#include <algorithm>

#include "api/handles.hpp"
#include "api/positions.hpp"
#include "base/log.hpp"
#include "launch/prepared.hpp"

namespace clarity::api {
namespace {

// Numbers of the caller in single precision. from: subtracted in double precision, number by number in turn.
std::vector<float> rounded_numbers(const void* numbers, int32_t type, size_t count, const std::array<double, 3>& from) {
    std::vector<float> floats(count);
    for (size_t i = 0; i < count; ++i) {
        const double number =
            type == CLARITY_FLOAT64 ? static_cast<const double*>(numbers)[i] : static_cast<const float*>(numbers)[i];
        floats[i] = static_cast<float>(number - from[i % 3]);
    }
    return floats;
}

void check_numbers(const std::string& what, const Problem& why) {
    if (why) throw Error(Exit::usage, what + ": " + why.text() + "; nothing was moved");
}

void check_count(const std::string& what, uint64_t found, size_t expected) {
    if (found != expected)
        throw Error(Exit::usage, what + ": there are " + std::to_string(found) + ", and the scene has " +
                                     std::to_string(expected) + "; nothing was moved");
}

}  // namespace
}  // namespace clarity::api

using namespace clarity;
using namespace clarity::api;

Pose clarity_tracer::pose_of(const clarity_places& places) const {
    if (places.type != CLARITY_FLOAT32 && places.type != CLARITY_FLOAT64)
        throw Error(Exit::usage, "the places have the unknown type " + std::to_string(places.type));
    Pose pose = pose_at_rest(*placed_);
    if (places.positions) {
        if (!of_arrays_)
            throw Error(Exit::usage, "vertices of scenes that files describe stay in their meshes: move the instances");
        check_count("vertices", places.vertex_count, placed_->vertex_count());
        auto floats = rounded_numbers(places.positions, places.type, placed_->positions.size(), placed_->origin);
        check_numbers("vertices", problem_of_positions(floats.data(), floats.size()));
        pose.meshes.push_back({0, std::move(floats), {}});
    } else if (vertices_moved_) {  // movers know those of the last build
        pose.meshes.push_back({0, {placed_->positions.begin(), placed_->positions.end()}, {}});
    }
    if (places.transforms) {
        if (placed_->origin != std::array<double, 3>{})
            throw Error(Exit::usage, "the scene lies far from 0, and has been moved there: its instances stay where they are");
        check_count("instances", places.instance_count, placed_->instances.size());
        const auto floats = rounded_numbers(places.transforms, places.type, 12 * placed_->instances.size(), {});
        check_numbers("transforms of instances", problem_of_numbers(floats.data(), floats.size(), 12, "instance"));
        for (size_t i = 0; i < pose.instances.size(); ++i) {
            Affine &to = pose.instances[i].world_from_object, inverse;
            std::copy_n(&floats[12 * i], 12, to.begin());
            if (!invert(to, inverse))
                throw Error(Exit::usage, "transform of instance " + std::to_string(i) +
                                             ": it has no inverse, as one that scales by 0; nothing was moved");
        }
    }
    return pose;
}

void clarity_tracer::move(const clarity_places& places, Progress& progress) {
    const std::lock_guard<std::mutex> lock(keeping_->calls);
    check_arrays();
    const Pose pose = pose_of(places);
    progress.stage("moving the scene");
    if (progress.cancelled()) throw Cancelled();  // what moves nothing asks nowhere else
    Scene moved = posed(*placed_, pose);
    if (places.transforms)
        for (Instance& instance : moved.instances) instance.apart = true;  // the next move can refit
    const auto scene = std::make_shared<const Scene>(std::move(moved));
    const PosedFrom from{imported_, {}};
    const PoseFollower::Way way = way_of(settings_.poses);
    std::shared_ptr<const AccelData> accel = follower_.refit(from, scene, pose, way, traced_ms_, progress).accel;
    traced_ms_ = 0;
    if (!accel) {
        log(LogLevel::debug, "built anew: " + follower_.update().why);
        accel = preparer_.build(scene, settings_, progress);
        follower_.built(from, scene, pose, accel, MultiPreparer::host_mover(scene, accel));
    }
    prepared_ = prepare_queries(*device_, scene, accel, settings_, progress);
    prepared_id_ = new_packing();
    placed_ = scene;
    vertices_moved_ |= places.positions != nullptr;
}
