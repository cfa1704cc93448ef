// tile_scheduler.hpp -- which device traces which tiles of a shared picture.
//
// A picture is cut into tiles, each some rows high and as wide as the picture. A tile has one owner from the first sample to
// the last, so that one device adds up all samples of a pixel, in order. For the first sample, most tiles are assigned in
// advance: each device gets tiles from all parts of the picture, in proportion to the speeds measured in earlier pictures. The
// few remaining tiles are assigned dynamically, to the device that is free. None remain if the devices are of the same kind and
// their speeds are known, because a launch of a few tiles takes as long as its slowest ray.
#pragma once
#include <mutex>
#include <vector>

#include "tracers/rays/autotuner.hpp"

namespace clarity {

// next(), took() and share() are thread-safe.
class TileScheduler {
 public:
    explicit TileScheduler(size_t device_count) : measured_(device_count) {}

    // Starts a new picture. tiles: their numbers, ascending. takes_part: for each device. alike: these devices are of the same
    // kind, so that most tiles can be assigned before their speeds are known. Must not run in parallel with other calls.
    void begin(const std::vector<unsigned>& tiles, const std::vector<bool>& takes_part, bool alike);
    // Whether some tiles are assigned dynamically, after those assigned in advance.
    bool dynamic() const { return dynamic_; }
    // Returns more tiles for a device. Empty if none are left that it would finish before the other devices do.
    std::vector<unsigned> next(size_t device);
    // Reports that a device took `ms` for so many tiles of one sample.
    void took(size_t device, size_t tiles, double ms);
    // A device's share of the work by the known speeds, 0 to 1. 0: it takes no part.
    double share(size_t device) const;

 private:
    struct Measured {
        double tiles = 0, ms = 0;
        double speed() const { return ms > 0 ? tiles / ms : 0; }
    };
    void learn();
    void assign_in_advance(const std::vector<unsigned>& tiles, unsigned left_over);
    void give_each_one();
    double share_locked(size_t device) const;

    mutable std::mutex mutex_;
    std::vector<Measured> measured_;  // in this picture
    std::vector<double> shares_;      // of speed, from earlier pictures of the same devices; empty: not known
    std::vector<bool> takes_part_;
    std::vector<std::vector<unsigned>> reserved_;
    std::vector<unsigned> left_;  // assigned dynamically, the last one first
    bool dynamic_ = false;
};

// Whether devices that share a picture are faster than the fastest of them alone: by trial.
//
// A slow device beside a fast one brings little, and its launches, its thread and the wait for its last tile cost time. So
// where the gain is in doubt, pictures are traced both ways, and then in the faster way (tracers/rays/autotuner.hpp):
// three pictures each way at first, and two each when the choice is reviewed, after 16, 64, 256 ... pictures. The others have
// to save 3 % of the time.

// Used from one thread.
class TeamChoice {
 public:
    // Whether the next picture is for the fastest device alone.
    bool alone() const { return doubtful_ && tuner_.variant() == 0; }
    // The picture took `ms` a sample. greatest_share: of the work, that of the fastest device by the known speeds.
    void took(double ms, double greatest_share) {
        if (doubtful_)
            tuner_.took(ms);
        else
            doubtful_ = greatest_share > kMostOfTheWork || ms < kShort;
    }

 private:
    static constexpr double kMostOfTheWork = 0.8;  // then the others can save a fifth of the time at best
    static constexpr double kShort = 2;            // ms: so short that threads and launches count

    bool doubtful_ = false;
    Autotuner tuner_{2};
};

}  // namespace clarity
