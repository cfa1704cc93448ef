// sequence.hpp -- numbered pictures along a camera path: a turntable about the target, or a path through the bookmarks.
#pragma once
#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace clarity::ui {

class Session;

// A sequence in progress. Used on the window's thread.
class Sequence {
 public:
    // Start a sequence, which replaces a running one. The camera returns to its place at the end. pattern: file name with # for
    // digits, "turn_####.png". Throw Error(usage) if the pattern cannot be written; a running sequence then goes on.
    void start_turntable(Session& session, const std::string& pattern, int frames);
    void start_path(Session& session, const std::string& pattern, int frames, const std::vector<Camera>& through);
    void stop(Session& session);
    bool running() const { return !cameras_.empty(); }
    int done() const { return next_; }
    int count() const { return static_cast<int>(cameras_.size()); }
    const std::string& pattern() const { return pattern_; }

    // Called by the session: before it posts the frame's job, after that, and when a picture was saved.
    void update(Session& session);
    void posted(Session& session);
    void saved(Session& session, uint64_t number, bool worked);

 private:
    void start(Session& session, const std::string& pattern, std::vector<Camera> cameras);
    void drop_frame(Session& session);

    std::vector<Camera> cameras_;
    Camera before_;  // the camera to return to, while a sequence runs
    std::string pattern_;
    bool camera_set_ = false;  // the session's desired state has the camera of frame next_
    uint64_t save_ = 0;        // number of that frame's save; 0: not requested yet
    int next_ = 0;
};

// Returns the first name "FOLDER/clarity_0001.png" which no file has yet. Throws Error(failed) if all 9999 are taken.
std::string next_picture_path(const std::string& folder);

}  // namespace clarity::ui
