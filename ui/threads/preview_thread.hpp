// preview_thread.hpp -- the thread that traces a small picture of one material, while the window's picture rests.
#pragma once
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "stand/multi_frame_renderer.hpp"
#include "ui/threads/prepared_scene.hpp"

namespace clarity::ui {

// What is to be seen.
struct PreviewJob {
    std::shared_ptr<const Ready> ready;  // whose scene has the material, with its textures; on its first device it is traced
    rt_u32 material = 0;
    MaterialValues values;
    unsigned size = 0;  // pixels along a side
};

struct Preview {
    rt_u32 material = 0;
    ByteImage image;  // empty: nothing is traced yet
    unsigned samples = 0;
    std::string failure;  // why there is no picture, or no further sample; empty: there is
    bool done = false;    // no further sample follows, and these are the numbers asked for
};

// The thread. All public members may be called from any thread; only release() waits.
class PreviewThread {
 public:
    // wake: called from the thread when latest() is another one.
    PreviewThread(const PluginRegistry& plugins, std::function<void()> wake);
    ~PreviewThread();
    // Traces this from now on; nothing happens if it is what is traced.
    void show(const PreviewJob& job);
    void hide();  // traces nothing
    // While the device is wanted for something else, a sample waits for up to a quarter of a second.
    void set_busy(bool busy);
    std::shared_ptr<const Preview> latest() const;  // nullptr: nothing is shown
    // As in FrameThread.
    void release();
    void resume();

 private:
    // What is on the device. Only the thread uses it, and release() while the thread rests.
    struct Tracer {
        std::shared_ptr<Device> of, device;  // that of the window's picture, and the same with a queue of its own
        std::unique_ptr<MultiPreparer> preparer;
        std::unique_ptr<MultiFrameRenderer> frames;
        std::shared_ptr<const MultiPrepared> prepared;
    };
    // What the scene of a ball is made of.
    struct Ball {
        explicit Ball(const PreviewJob& job);
        Ball() = default;
        bool operator==(const Ball& b) const;
        std::weak_ptr<const ImportedScene> loaded;
        MapEdits maps;
        rt_u32 material = 0;
    };
    static bool is_same(const PreviewJob& a, const PreviewJob& b);
    void run();
    void trace(const PreviewJob& job, unsigned sample, Preview& preview, Progress& progress);
    void prepare(const PreviewJob& job, const View& view, Progress& progress);

    const PluginRegistry& plugins_;
    const std::function<void()> wake_;
    Tracer tracer_;
    std::shared_ptr<const Scene> scene_;  // of the ball
    Ball scene_of_;                       // for which scene_ was made
    uint64_t kernel_revision_ = 0;        // of tracer_.prepared
    mutable std::mutex mutex_;
    std::condition_variable changed_, stopped_;
    bool stop_ = false, running_ = false, released_ = false, busy_ = false;
    std::optional<PreviewJob> job_;
    std::shared_ptr<Progress> progress_;
    std::shared_ptr<const Preview> latest_, begun_;  // begun_: of job_; nullptr: not begun
    std::thread thread_;                             // last member: the thread starts when all others exist
};

}  // namespace clarity::ui
