// session.hpp -- what the window works on: the state a user wishes for, and the newest that the threads made of it.
//
// The window's parts change `wish` as they like; update(), once a frame, compares it with what was asked for last and posts the
// difference: to the preparing worker what must be rebuilt or recompiled, to the frame thread the rest. Nothing here waits.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "ui/frame_thread.hpp"
#include "ui/log_buffer.hpp"
#include "ui/prepare_worker.hpp"
#include "ui/window_main.hpp"

namespace clarity {

struct WishedLight {
    std::string name;
    rt_light values{};
    bool on = true;
};

struct Wish {
    std::string device;
    Settings settings;
    Camera camera;
    std::vector<WishedLight> lights;
    std::array<float, 3> background{}, ambient{};
    bool continuous = false;
};

// What stands over the picture until it is dismissed or mended.
struct Message {
    std::string text, details;
};

class Session {
 public:
    Session(const ViewOptions& options, std::function<void()> wake);

    Wish wish;
    unsigned selected_light = 0;

    const PluginRegistry& plugins() const { return plugins_; }
    LogBuffer& log_lines() { return log_; }
    std::shared_ptr<const std::vector<DeviceInfo>> devices() const { return worker_.devices(); }

    // Replaces the scene once the files are imported; until then, and if that fails, the old one stays.
    void open(std::vector<std::string> files);
    // Drops what is being prepared and wishes for what is on the screen again.
    void cancel();
    void reset_view();
    void set_accel(const std::string& id);  // with its parameters' defaults

    // Once a frame of the window; aspect: of the picture.
    void update();

    std::shared_ptr<const Ready> ready() const { return ready_; }        // nullptr until something is prepared
    std::shared_ptr<const Picture> picture() const { return picture_; }  // newest; nullptr at first
    std::vector<std::string> files() const;                              // of the scene on the screen
    Activity activity() const { return worker_.activity(); }
    std::vector<float> frame_times() const { return frames_.times(); }
    // Nothing is being prepared or traced, and the newest picture is here.
    bool idle() const;
    // Whether the wish differs from what the picture was prepared with: something is under way, or failed.
    bool behind() const;
    double frames_per_second() const;
    double mrays_per_second() const;
    std::string frame_rate_line() const;
    // Length that steps are measured by: the scene's diagonal.
    float scene_size() const;

    const Message& message() const { return message_; }
    void dismiss_message() { message_ = {}; }
    void report(const std::string& text, const std::string& details = {});  // a failure: message and log
    uint64_t message_count() const { return message_count_; }

 private:
    void take_outcomes();
    void adopt(const std::shared_ptr<const Ready>& ready);
    void post_request();
    void post_frame();
    std::string request_key() const;
    View wished_view() const;

    const PluginRegistry& plugins_;
    std::string first_camera_, first_light_;  // from the command line, for the first scene
    std::vector<std::string> files_;          // asked for
    uint64_t files_revision_ = 0, last_files_revision_ = 0;
    std::string posted_key_;
    std::string ready_key_;
    uint64_t viewed_files_revision_ = 0;  // whose camera and lights are in the wish
    std::shared_ptr<const Ready> ready_;
    std::shared_ptr<const Picture> picture_;
    FrameJob posted_job_;
    Message message_;
    uint64_t message_count_ = 0;
    LogBuffer log_;
    PrepareWorker worker_;
    FrameThread frames_;
};

}  // namespace clarity
