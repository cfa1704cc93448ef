// sequence.hpp -- numbered pictures along a path of the camera: once around the target, or from bookmark to bookmark.
#pragma once
#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace clarity {

class Session;

class Sequence {
 public:
    // pattern: "turn_####.png". Throws Error(usage) where that cannot be written. The camera comes back to where it was.
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
    void saved(Session& session, const std::string& path, bool worked);

 private:
    void start(Session& session, const std::string& pattern, std::vector<Camera> cameras);

    std::vector<Camera> cameras_;
    Camera before_;
    std::string pattern_, waiting_for_;
    bool asked_ = false;  // for waiting_for_ to be written
    int next_ = 0;
};

// "FOLDER/clarity_0001.png": the first such name that is free.
std::string next_picture_path(const std::string& folder);

}  // namespace clarity
