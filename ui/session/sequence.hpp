// sequence.hpp -- numbered pictures along a path of the camera: once around the target, or from bookmark to bookmark.
#pragma once
#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace clarity::ui {

class Session;

class Sequence {
 public:
    // pattern: "turn_####.png". Throws Error(usage) where that cannot be written; then what runs goes on. Else the new sequence
    // replaces one that runs. At its end the camera comes back to where it was.
    void start_turntable(Session& session, const std::string& pattern, int frames);
    void start_path(Session& session, const std::string& pattern, int frames, const std::vector<Camera>& through);
    void stop(Session& session);
    bool running() const { return !cameras_.empty(); }
    int done() const { return next_; }
    int count() const { return static_cast<int>(cameras_.size()); }
    const std::string& pattern() const { return pattern_; }

    // For the session: before it posts the frame's job, after it did, and when a picture is written.
    void update(Session& session);
    void posted(Session& session);
    void saved(Session& session, uint64_t number, bool worked);

 private:
    void start(Session& session, const std::string& pattern, std::vector<Camera> cameras);
    void drop_frame(Session& session);

    std::vector<Camera> cameras_;
    Camera before_;  // while it runs: the camera to come back to
    std::string pattern_;
    bool wished_ = false;  // the camera of frame next_ is in the session's wish
    uint64_t save_ = 0;    // number of that frame's save; 0: not asked for yet
    int next_ = 0;
};

// "FOLDER/clarity_0001.png": the first such name that is free.
std::string next_picture_path(const std::string& folder);

}  // namespace clarity::ui
