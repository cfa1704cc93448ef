// handles.hpp -- what the handles of the library hold.
#pragma once
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "api/clarity.h"
#include "api/kept.hpp"
#include "api/library.hpp"
#include "api/ray_arrays.hpp"
#include "device/device.hpp"
#include "moving/follow/pose_follower.hpp"
#include "stand/multi_frame_renderer.hpp"
#include "tracers/rays/ray_queries.hpp"
#include "view/edit/edit.hpp"

struct clarity_scene {
    std::shared_ptr<const clarity::Scene> imported;  // with the edits of its files
    std::shared_ptr<const clarity::Scene> placed;    // with these edits in force: what is traced
    std::string info;                                // JSON
    bool of_arrays = false;                          // of the caller
};

namespace clarity::api {

// Settings by their texts, and edits of a view.
struct Words {
    Settings settings;
    std::vector<Word> edits;
};
// Adds "key=value" to what is there. Throws Error(usage).
void read_words(const char* const* texts, Words& words);

}  // namespace clarity::api

// Rays on a device, in pieces.
struct clarity_packed {
    struct Piece {
        size_t count;
        cl::Buffer rays;
        uint64_t packing;  // as RayArrays::packing
    };
    uint64_t tracer;  // that packed them
    std::shared_ptr<clarity::Device> device;
    std::vector<Piece> pieces;
    uint64_t count;
};

// A scene in a structure on a device. Its members are called one at a time.
struct clarity_tracer {
 public:
    clarity_tracer(const clarity_scene& scene, const clarity_options& options, clarity::Progress& progress);
    void closest(const clarity_rays& rays, const clarity_hits& hits, clarity::Progress& progress);
    void keep(const clarity_rays& rays, clarity_kept& kept, clarity::Progress& progress);
    std::unique_ptr<clarity_kept> new_kept(bool brief) const { return std::make_unique<clarity_kept>(keeping_, brief); }
    const char* info();
    std::unique_ptr<clarity_packed> pack(const clarity_rays& rays, clarity::Progress& progress);
    void any(const clarity_rays& rays, uint8_t* occluded, clarity::Progress& progress);
    void move(const clarity_places& places, clarity::Progress& progress);
    void count(const clarity_rays& rays, int64_t* counts, clarity::Progress& progress);
    std::unique_ptr<clarity::api::HitArrays> all(const clarity_rays& rays, clarity::Progress& progress);
    // Writes the members of `picture` that are the call's.
    void render(const clarity_picture& asked, clarity_picture& picture, clarity::Progress& progress);

 private:
    // The scene with these places. Throws Error(usage).
    clarity::Pose pose_of(const clarity_places& places) const;
    enum class Wanted { hits, nearest, occlusion };  // nearest: t and prim alone
    // take: gets the number of a first ray, and answers of it and the next ones, which stay until it returns.
    using TakeAnswers = std::function<void(size_t first, const clarity::Answers& answers)>;
    void trace(const clarity_rays& rays, Wanted wanted, clarity::Progress& progress, const TakeAnswers& take);
    // With the lock. all: where all answers go; null: to `take`.
    void trace(const clarity_rays& rays, const clarity::RayQuery& query, const TakeAnswers& take, const clarity::Answers* all);
    void check(const clarity_rays& rays) const;
    // The caller may have written to arrays that were lent: builders and kernels trust their numbers. Throws Error(usage).
    void check_arrays() const;
    clarity::RayQuery query_of(const clarity_rays& rays, Wanted wanted, clarity::Progress& progress) const;
    // Of the rays from `begin` on.
    clarity::ReadRays reader(const clarity_rays& rays, size_t begin) const;
    // take: gets the hits of some rays, and the number of the first one.
    template <class Take>
    void trace_all(const clarity_rays& rays, bool count_only, clarity::Progress& progress, const Take& take);
    clarity::View view_of(const clarity_picture& asked, const clarity::api::Words& words) const;
    void trace_samples(const std::shared_ptr<const clarity::MultiPrepared>& prepared, const clarity::Settings& settings,
                       const clarity::View& view, clarity::Progress& progress);

    std::shared_ptr<const clarity::Scene> imported_, placed_;
    clarity::Settings settings_;
    std::shared_ptr<clarity::Device> device_;
    clarity::MultiPreparer preparer_;
    std::shared_ptr<const clarity::Prepared> prepared_;  // for ray queries
    uint64_t prepared_id_ = 0;                           // another one for each
    clarity::RayQueries queries_;
    const std::shared_ptr<clarity::api::KeepingDevice> keeping_;
    bool of_arrays_;  // the scene is one mesh of the caller's
    clarity::PoseFollower follower_;
    bool vertices_moved_ = false;
    std::map<std::thread::id, std::string> infos_;  // the last one that each thread was told
    uint64_t rays_ = 0;                             // that were traced
    double device_ms_ = 0;                          // for them
    double traced_ms_ = 0;                          // since the last move
    uint64_t id_ = clarity::new_packing();          // of this tracer, and of rays that it packs for one call
    size_t batch_;                                  // rays that are traced in one go
    std::optional<clarity::MultiFrameRenderer> frames_;
};
