#include "stand/tile_scheduler.hpp"

#include <algorithm>
#include <utility>

namespace clarity {
namespace {

constexpr double kNewest = 0.5;  // weight of the last picture in the known shares of speed

}  // namespace

void TileScheduler::begin(const std::vector<unsigned>& tiles, const std::vector<bool>& takes_part, bool alike) {
    learn();
    if (takes_part != takes_part_) shares_.clear();
    takes_part_ = takes_part;
    measured_.assign(measured_.size(), {});
    reserved_.assign(measured_.size(), {});
    left_.clear();
    const auto tile_count = static_cast<unsigned>(tiles.size());
    const auto taking = static_cast<unsigned>(std::count(takes_part.begin(), takes_part.end(), true));
    // Each tile that is assigned dynamically costs one launch. Tiles assigned in advance cost nothing, but the slowest device
    // then decides when the picture is done.
    const bool known = !shares_.empty();
    unsigned few = known ? taking : std::max(taking, alike ? tile_count / 16 : tile_count);
    if (taking < 2 || (known && alike)) few = 0;
    assign_in_advance(tiles, std::min(tile_count, few));
    if (few == 0) give_each_one();
    dynamic_ = !left_.empty();
}

// Updates the shares from the speeds that the last picture showed.
void TileScheduler::learn() {
    double sum = 0;
    for (size_t i = 0; i < takes_part_.size(); ++i) {
        if (takes_part_[i] && measured_[i].speed() <= 0) return;  // there were too few tiles for all, or one failed
        sum += takes_part_[i] ? measured_[i].speed() : 0;
    }
    if (sum <= 0) return;
    const bool first = shares_.empty();
    shares_.resize(measured_.size());
    for (size_t i = 0; i < shares_.size(); ++i) {
        const double now = takes_part_[i] ? measured_[i].speed() / sum : 0;
        shares_[i] = first ? now : (1 - kNewest) * shares_[i] + kNewest * now;
    }
}

// Assigns tiles in advance. Each tile goes to the device that is furthest behind its share, so that every device gets tiles
// from all parts of the picture.
void TileScheduler::assign_in_advance(const std::vector<unsigned>& tiles, unsigned left_over) {
    const size_t unassigned = measured_.size();
    std::vector<double> share(unassigned + 1), owed(unassigned + 1, 0.0);
    share[unassigned] = tiles.empty() ? 0 : double(left_over) / double(tiles.size());
    for (size_t i = 0; i < unassigned; ++i) share[i] = share_locked(i) * (1 - share[unassigned]);
    for (const unsigned tile : tiles) {
        for (size_t i = 0; i <= unassigned; ++i) owed[i] += share[i];
        const size_t to = size_t(std::max_element(owed.begin(), owed.end()) - owed.begin());
        owed[to] -= 1;
        (to == unassigned ? left_ : reserved_[to]).push_back(tile);
    }
    std::reverse(left_.begin(), left_.end());
}

// Gives each device that has no tile one of the device with the most. A device that was busy with other work for a while would
// otherwise stay without tiles in small pictures, because without a tile it shows no speed.
void TileScheduler::give_each_one() {
    for (size_t i = 0; i < reserved_.size(); ++i) {
        if (!takes_part_[i] || !reserved_[i].empty()) continue;
        const auto most = std::max_element(reserved_.begin(), reserved_.end(),
                                           [](const auto& a, const auto& b) { return a.size() < b.size(); });
        if (most->size() < 2) return;
        reserved_[i].push_back(most->back());
        most->pop_back();
    }
}

double TileScheduler::share_locked(size_t device) const {
    if (!takes_part_[device]) return 0;
    double sum = 0;
    size_t taking = 0, known = 0;
    for (size_t i = 0; i < measured_.size(); ++i) {
        if (!takes_part_[i]) continue;
        ++taking;
        known += measured_[i].speed() > 0;
        sum += measured_[i].speed();
    }
    if (known == taking) return measured_[device].speed() / sum;
    return shares_.empty() ? 1.0 / double(taking) : shares_[device];
}

double TileScheduler::share(size_t device) const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return share_locked(device);
}

std::vector<unsigned> TileScheduler::next(size_t device) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!reserved_[device].empty()) return std::exchange(reserved_[device], {});
    if (left_.empty() || !takes_part_[device]) return {};
    size_t count = 1;
    if (const double speed = measured_[device].speed(); speed > 0) {
        double fastest = 0;
        for (size_t i = 0; i < measured_.size(); ++i)
            if (takes_part_[i]) fastest = std::max(fastest, measured_[i].speed());
        // Give a slow device no tile if the fastest could finish all the rest earlier.
        if (1 / speed > double(left_.size() + 1) / fastest) return {};
        // Large pieces first, so that launches are few. Small pieces at the end, because the devices must end together.
        count = std::max<size_t>(1, size_t(0.5 * share_locked(device) * double(left_.size())));
    }
    std::vector<unsigned> tiles;
    for (; count > 0; --count) {
        tiles.push_back(left_.back());
        left_.pop_back();
    }
    return tiles;
}

void TileScheduler::took(size_t device, size_t tiles, double ms) {
    if (tiles == 0 || !(ms > 0)) return;
    const std::lock_guard<std::mutex> lock(mutex_);
    measured_[device].tiles += double(tiles);
    measured_[device].ms += ms;
}

}  // namespace clarity
