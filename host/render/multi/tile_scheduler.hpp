// tile_scheduler.hpp -- who traces what of a picture that several devices share.
//
// A picture is cut into strips of rows, and each strip has one owner from the first sample to the last, so that a pixel's
// samples are added up by one device in their order. In the first sample every device has strips set aside, spread over the
// picture in proportion to the speeds that the last picture showed; the few that are left go to whoever is free. Nothing is
// left where devices are of one kind and their speeds known: a launch of a few strips lasts as long as its slowest ray.
#pragma once
#include <mutex>
#include <vector>

namespace clarity {

class TileScheduler {
 public:
    explicit TileScheduler(size_t device_count) : measured_(device_count) {}

    // A new picture for these devices. alike: they are of one kind, so that nothing need be known of their speeds. Not while
    // others call.
    void begin(unsigned tile_count, const std::vector<bool>& takes_part, bool alike);
    // Whether some are left to deal when each device has what is set aside for it.
    bool dynamic() const { return dynamic_; }
    // More strips for a device; none: nothing is left that it would finish before the others do.
    std::vector<unsigned> next(size_t device);
    // It took so long for so many strips of one sample.
    void took(size_t device, size_t tiles, double ms);
    // Of the work that devices are given, by what is known; 0: it takes no part.
    double share(size_t device) const;

 private:
    struct Measured {
        double tiles = 0, ms = 0;
        double speed() const { return ms > 0 ? tiles / ms : 0; }
    };
    void learn();
    void set_aside(unsigned tile_count, unsigned left_over);
    double share_locked(size_t device) const;

    mutable std::mutex mutex_;
    std::vector<Measured> measured_;  // in this picture
    std::vector<double> shares_;      // by the pictures before, of those that took part; empty: not known
    std::vector<bool> takes_part_;
    std::vector<std::vector<unsigned>> set_aside_;
    std::vector<unsigned> left_;  // for whoever is free, the last first
    bool dynamic_ = false;
};

}  // namespace clarity
