#include "cli/render/frame_scene.hpp"

#include <algorithm>
#include <functional>
#include <set>
#include <utility>

#include "base/digest.hpp"
#include "cli/pose_options.hpp"
#include "import/wire.hpp"
#include "scene/motion/file_sequence.hpp"
#include "scene/motion/pose_time.hpp"

namespace clarity {
namespace {

// The time and the clip of the options; where they are silent, those of the preset.
PoseOptions chosen_pose(const RenderOptions& options, const PoseTime& preset) {
    PoseOptions pose = options.pose;
    if (!pose.time_s && pose.clip.empty() && options.frames.empty()) pose.time_s = preset.time_s;
    if (pose.clip.empty()) pose.clip = preset.clip;
    return pose;
}

}  // namespace

FrameScene::FrameScene(const PluginRegistry& plugins, const RenderOptions& options, const TraceWords& words, Progress& progress)
    : options_(options),
      words_(words),
      pose_(chosen_pose(options, words.pose)),
      has_path_(
          std::any_of(words.edits.begin(), words.edits.end(), [](const Word& word) { return word.key == "camera_path"; })),
      sequences_(plugins, options.scene.import, progress) {}

void FrameScene::take(std::shared_ptr<const Scene> imported) {
    imported_ = std::move(imported);
    rest_ = imported_;
    scene_.reset();
    digest_.clear();
    if (!imported_) return;
    const EditedView edited = scene_edits(*imported_, words_.edits);
    if (changes_scene(edited)) rest_ = std::make_shared<const Scene>(edited_scene(*imported_, edited));
}

bool FrameScene::follows_frames() const {
    return !options_.frames.empty() && !pose_.time_s && (moves(*imported_) || has_path_);
}

PoseOptions FrameScene::pose_of(std::optional<int> frame) const {
    PoseOptions pose = pose_;
    if (frame) pose.time_s = time_of_frame(*frame, frame_rate(find_clip(*imported_, pose.clip), options_.fps));
    return pose;
}

void FrameScene::describe(Digest& digest, std::optional<int> frame) {
    if (digest_.empty()) digest_ = import::scene_digest(*imported_);
    digest.add(digest_);
    digest.add(options_.trace.camera);
    digest.add(options_.trace.light);
    for (const Word& word : words_.edits) digest.add(word.key), digest.add(word.value);
    const PoseOptions pose = pose_of(frame);
    const bool at_rest = !pose.time_s && pose.clip.empty(), plays = moves(*imported_) || has_path_;
    digest.add(frame ? "frame" : "");  // which follows a camera path in any case
    if (at_rest || !plays) return;
    const ClipInfo clip = find_clip(*imported_, pose.clip);
    const double time_s = pose.time_s.value_or(clip.begin_s);
    const double open_s = blurs(words_.settings) ? words_.settings.shutter / frame_rate(clip, options_.fps) : 0;
    digest.add(clip.name);
    digest.add_value(time_s);
    digest.add_value(open_s);
    if (imported_->motion.sequences.empty()) return;
    // The scene knows the numbers of a sequence's files only. Those that any sample of the picture shows are read.
    const Shutter shutter{time_s, open_s, static_cast<unsigned>(words_.settings.spp)};
    std::set<std::string> files;
    for (unsigned sample = 0; sample < shutter.samples; ++sample)
        add_sequence_files(*imported_, sample_time(shutter, sample), files);
    for (const std::string& file : files) {
        const std::vector<float> positions = sequences_(file);
        digest.add_value(positions.size());
        digest.add_bytes(positions.data(), positions.size() * sizeof(float));
    }
}

void FrameScene::place(std::optional<int> frame) {
    const PoseOptions pose = pose_of(frame);
    const bool at_rest = !pose.time_s && pose.clip.empty(), plays = moves(*imported_) || has_path_;
    const bool is_still = at_rest || (has_path_ && !moves(*imported_));
    scene_ = is_still ? rest_ : std::make_shared<const Scene>(at_pose(*rest_, pose, std::ref(sequences_)));
    time_s_.reset();
    if (!at_rest && plays) {
        const ClipInfo clip = find_clip(*imported_, pose.clip);
        time_s_ = pose.time_s.value_or(clip.begin_s);
        clip_ = clip.name;
    }
    const Settings& settings = words_.settings;
    const float aspect = float(settings.whole_width()) / float(settings.whole_height());
    EditedView edited;
    // Moved objects move neither the camera nor the lights that a scene gets which has none.
    edited.view = make_view(is_still ? *imported_ : *scene_, aspect, options_.trace.camera, options_.trace.light);
    apply_scene_edits(*scene_, edited);
    for (const Word& word : words_.edits) apply_edit(*scene_, edited, word.key, word.value);
    // Frames follow a path in any case; a still picture only if its camera was not set after the path.
    path_ = edited.follows_path || frame ? std::move(edited.camera_path) : CameraPath();
    if (!path_.empty()) edited.view.camera = path_.at(time_s_.value_or(path_.keys.front().time_s));
    view_ = visible_view(edited);
}

View FrameScene::view(const MotionBlur::Sample& sample) const {
    View view = *sample.view;
    if (!path_.empty()) view.camera = path_.at(sample.time_s);
    return view;
}

std::unique_ptr<MotionBlur> FrameScene::blur(std::shared_ptr<const MultiPrepared> prepared, MultiPreparer& preparer) {
    const Settings& settings = words_.settings;
    if (!blurs(settings) || !time_s_) return nullptr;
    const double fps = frame_rate(find_clip(*imported_, clip_), options_.fps);
    MotionBlur::Source source;
    source.rest = rest_;
    source.clip = clip_;
    source.read = std::ref(sequences_);
    source.prepare = [&preparer, &settings](std::shared_ptr<const Scene> scene, Progress& progress) {
        return preparer.prepare(std::move(scene), settings, progress);
    };
    return std::make_unique<MotionBlur>(
        std::move(source), Shutter{*time_s_, settings.shutter / fps, static_cast<unsigned>(settings.spp)}, std::move(prepared));
}

}  // namespace clarity
