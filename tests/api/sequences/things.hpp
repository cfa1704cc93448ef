// things.hpp -- what a sequence holds: handles of the library, each with what is known of it, and memory of exact size for
// calls.
#pragma once
#include <atomic>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <mutex>
#include <new>
#include <string>
#include <vector>

#include "clarity.h"
#include "draw.hpp"
#include "truth.hpp"

namespace sequences {

// All calls of the library so far.
inline std::atomic<uint64_t> calls_made{0};

// Memory of exactly so many bytes, so that AddressSanitizer sees each access beside it. Filled with a pattern.
class Bytes {
 public:
    Bytes() = default;
    explicit Bytes(size_t bytes) : size_(bytes), data_(static_cast<unsigned char*>(std::malloc(bytes ? bytes : 1)), std::free) {
        if (!data_) throw std::bad_alloc();
        std::memset(data_.get(), kPattern, bytes);
    }
    // As `count` numbers.
    template <class T>
    T* as() const {
        return reinterpret_cast<T*>(data_.get());
    }
    size_t size() const { return size_; }
    bool is_untouched() const {
        for (size_t i = 0; i < size_; ++i)
            if (data_.get()[i] != kPattern) return false;
        return true;
    }

 private:
    static constexpr unsigned char kPattern = 0x5a;
    size_t size_ = 0;
    std::unique_ptr<unsigned char, decltype(&std::free)> data_{nullptr, std::free};
};

// Where vertices and instances are. Numbers as the library rounds them.
struct Pose {
    std::vector<Point> positions;
    std::vector<Transform> transforms;
};

// Handles are freed by the last who has them, on any thread.
struct Scene {
    clarity_scene* handle = nullptr;
    Bytes lent_positions, lent_triangles;  // until the scene and all its tracers are gone
    std::vector<uint32_t> triangles;
    Pose at_rest;
    std::vector<Sphere> spheres;
    double size = 1, far = 0;
    bool of_arrays = true;
    Scene() = default;
    Scene(const Scene&) = delete;
    Scene& operator=(const Scene&) = delete;
    ~Scene() {
        ++calls_made;
        clarity_scene_free(handle);
    }
    World world(const Pose& pose) const;
};

struct Tracer {
    clarity_tracer* handle = nullptr;
    std::shared_ptr<const Scene> scene;
    std::string accel;
    std::mutex moving;  // held by the thread that moves it
    // Where the scene was, is, and, during a move, may be. With `lock`.
    std::mutex lock;
    Pose pose;
    std::vector<std::shared_ptr<const World>> worlds;
    size_t begun = 1, ended = 1;
    ~Tracer() {
        ++calls_made;
        clarity_tracer_free(handle);
    }
};

// The worlds that a call of a tracer may have met: other threads may move it meanwhile.
class Meanwhile {
 public:
    explicit Meanwhile(Tracer& tracer) : tracer_(tracer) {
        const std::lock_guard<std::mutex> lock(tracer.lock);
        first_ = tracer.ended - 1;
    }
    std::vector<std::shared_ptr<const World>> worlds() const {
        const std::lock_guard<std::mutex> lock(tracer_.lock);
        return {tracer_.worlds.begin() + static_cast<long>(first_), tracer_.worlds.begin() + static_cast<long>(tracer_.begun)};
    }

 private:
    Tracer& tracer_;
    size_t first_;
};

struct Packed {
    clarity_packed* handle = nullptr;
    std::weak_ptr<Tracer> tracer;  // which may go first
    std::vector<Ray> rays;
    ~Packed() {
        ++calls_made;
        clarity_packed_free(handle);
    }
};

struct Kept {
    clarity_kept* handle = nullptr;
    std::weak_ptr<Tracer> tracer;
    bool brief = false;
    // With `use`, as the arrays, which a call fills.
    std::mutex use;
    bool has_hits = false, asked[4] = {};
    void* arrays[4] = {};
    std::vector<Ray> rays;
    std::vector<std::shared_ptr<const World>> worlds;
    ~Kept() {
        ++calls_made;
        clarity_kept_free(handle);
    }
};

struct AllHits {
    clarity_all_hits hits{};
    std::vector<Ray> rays;
    std::vector<std::shared_ptr<const World>> worlds;
    ~AllHits() {
        ++calls_made;
        clarity_all_hits_free(&hits);
    }
};

// Places for things that all threads of a sequence share.
template <class Thing>
class Slots {
 public:
    // Null: nothing is there.
    std::shared_ptr<Thing> any(Draw& draw) const {
        const std::lock_guard<std::mutex> lock(mutex_);
        // Mostly something, if there is something.
        for (int turn = 0; turn < 4; ++turn)
            if (const auto& thing = things_[draw.below(kSlots)]) return thing;
        return nullptr;
    }
    void put(Draw& draw, std::shared_ptr<Thing> thing) {
        const std::lock_guard<std::mutex> lock(mutex_);
        things_[draw.below(kSlots)].swap(thing);
    }

 private:
    static constexpr size_t kSlots = 3;
    mutable std::mutex mutex_;
    std::shared_ptr<Thing> things_[kSlots];
};

struct State {
    Slots<Scene> scenes;
    Slots<Tracer> tracers;
    Slots<Packed> packed;
    Slots<Kept> kept;
    Slots<AllHits> all_hits;
    int threads = 1;
};

// What all sequences of a process share.
struct Common {
    std::string folder, scene_file;        // of this process, and a scene in it
    std::vector<uint32_t> file_triangles;  // of the model that it places
    std::vector<Point> file_positions;
    std::vector<std::string> accels;  // structures that are drawn
};

// One step of a sequence.
struct Step {
    State& state;
    const Common& common;
    Draw draw;
    // The call has ended with this code. Ends the process unless it is `expected`, with `words` in its text, or else nothing.
    // or_ok: CLARITY_OK is right, too.
    void ended(int32_t code, int32_t expected = CLARITY_OK, const char* words = "", bool or_ok = false) const;
    [[noreturn]] void fail(const std::string& why) const;
    void must(bool condition, const char* why) const {
        if (!condition) fail(why);
    }
};

struct Call {
    const char* name;
    double weight;
    void (*run)(Step& step);
};

}  // namespace sequences
