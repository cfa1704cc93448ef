#include "stand/multi_device_film.hpp"

#include <algorithm>
#include <chrono>
#include <numeric>
#include <utility>

#include "base/elapsed.hpp"
#include "base/log.hpp"
#include "device/cl_errors.hpp"
#include "picture/frame_stats.hpp"

namespace clarity {
namespace {

using Clock = std::chrono::steady_clock;

constexpr unsigned kMaxTiles = 256;  // approximate limit: enough to balance devices, and few to keep account of

unsigned divided_up(unsigned a, unsigned b) {
    return (a + b - 1) / b;
}

}  // namespace

MultiDeviceFilm::MultiDeviceFilm(const Devices& devices, Ranks* ranks) : ranks_(ranks) {
    std::vector<Error> failures;
    for (const std::shared_ptr<Device>& device : devices) {
        try {
            Member member;
            member.device = device;
            member.frames = std::make_unique<FrameRenderer>(device);
            members_.push_back(std::move(member));
        } catch (const Error& error) {
            if (error.code() == Exit::kernel_build_failed) throw;
            failures.push_back(error);
        }
    }
    if (members_.empty()) throw failures.front();
    for (const Error& error : failures)
        log(LogLevel::warning, std::string(error.what()) + "; the other devices go on without it");
    scheduler_ = std::make_unique<TileScheduler>(members_.size());
    threads_ = std::make_unique<DeviceThreads>(members_.size());
}

size_t MultiDeviceFilm::working() const {
    return size_t(std::count_if(members_.begin(), members_.end(), [](const Member& m) { return m.works(); }));
}

bool MultiDeviceFilm::displayed(std::vector<std::vector<KernelTime>>& times) const {
    for (const Member& member : members_)
        if (!member.displayed && !member.tiles.empty()) return false;
    try {
        for (size_t i = 0; i < members_.size(); ++i)
            if (!members_[i].tiles.empty()) members_[i].frames->add_display_times(times[i]);
    } catch (const Error&) {  // a device is lost; read() will report it
        return false;
    }
    return true;
}

unsigned MultiDeviceFilm::samples() const {
    unsigned least = ~0u;
    for (const Member& member : members_)
        if (member.works()) least = std::min(least, member.samples);
    return least == ~0u ? 0 : least;
}

void MultiDeviceFilm::fail(Member& member, const Error& error) {
    last_failure_ = error;
    member.frames.reset();
    member.tiles.clear();
    member.rows = {};
    team_ = {};
    alone_.reset();
    if (working() > 0)
        log(LogLevel::warning, "device " + member.device->info().id() + " takes no further part: " + error.what() +
                                   "; the other devices go on without it");
}

// Calls work(i) in parallel for each device that takes part. A device that fails takes no further part. Throws Cancelled, and
// errors that are no failure of a device.
void MultiDeviceFilm::on_all(const std::function<void(size_t)>& work) {
    const auto on_one = [&](size_t i) {
        if (members_[i].works()) work(i);
    };
    const auto thrown = alone_ ? threads_->run(on_one, *alone_) : threads_->run(on_one);
    bool cancelled = false;
    for (size_t i = 0; i < thrown.size(); ++i) {
        if (!thrown[i]) continue;
        try {
            std::rethrow_exception(thrown[i]);
        } catch (const Cancelled&) {
            cancelled = true;
        } catch (const Error& error) {
            if (error.code() != Exit::failed && error.code() != Exit::no_device) throw;
            fail(members_[i], error);
        } catch (const cl::Error& error) {
            fail(members_[i], Error(Exit::failed, members_[i].device->info().name + ": " + error.what() +
                                                      " failed with OpenCL error " + std::to_string(error.err())));
        }
    }
    if (cancelled) throw Cancelled();
    if (working() == 0) throw last_failure_;
}

void MultiDeviceFilm::read(const std::function<void(size_t, FrameRenderer&)>& work) {
    for (;;) {
        Progress never_cancelled;
        recover(never_cancelled);
        const size_t before = working();
        on_all([&](size_t i) {
            if (!members_[i].tiles.empty()) work(i, *members_[i].frames);
        });
        if (working() == before) return;
    }
}

// Cuts a new picture into tiles of rows. Each tile begins at a work-group row of every device.
void MultiDeviceFilm::cut() {
    unsigned unit = 1;
    bool alike = true;
    const DeviceInfo* first = nullptr;
    std::vector<bool> takes_part;
    for (Member& member : members_) {
        const auto* own = prepared_->of(member.device);
        member.prepared = own ? *own : nullptr;
        member.tiles.clear();
        member.rows = {};
        member.samples = 0;
        takes_part.push_back(member.works());
        if (!member.works()) continue;
        const DeviceInfo& info = member.device->info();
        if (!first) first = &info;
        alike &= info.compute_units == first->compute_units && info.driver == first->driver && info.parts == first->parts &&
                 (info.parts > 0 || info.name == first->name);
        unit = std::lcm(unit, member.prepared->layout.row_height());
    }
    if (!first) throw last_failure_;
    const auto height = unsigned(settings_.height);
    if (ranks_)
        for (const double of_rank : ranks_->gather(unit)) unit = std::lcm(unit, unsigned(of_rank));
    tile_height_ = unit * std::max(1u, height / unit / kMaxTiles);
    tile_count_ = divided_up(height, tile_height_);
    for (Member& member : members_) {
        if (!member.works()) continue;
        const unsigned row = member.prepared->layout.row_height();
        member.rows_in_tile = tile_height_ / row;
        member.rows_in_picture = divided_up(height, row);
    }
    take_tiles();
    choose_alone();
    if (!alone_) scheduler_->begin(tiles_, takes_part, alike);  // else it keeps what it knows of the speeds
}

// The share of the fastest device in the work, by the speeds that are known.
double MultiDeviceFilm::greatest_share() const {
    double greatest = 0;
    for (size_t i = 0; i < members_.size(); ++i) greatest = std::max(greatest, scheduler_->share(i));
    return greatest;
}

// Ranks have to agree on tiles, and samples of motion blur are lost with their device.
bool MultiDeviceFilm::may_be_alone() const {
    return working() > 1 && !ranks_ && !start_.sums && !blurs(settings_);
}

// Decides whether the fastest device traces the picture that begins alone.
void MultiDeviceFilm::choose_alone() {
    alone_.reset();
    if (!team_.alone() || !may_be_alone()) return;
    for (size_t i = 0; i < members_.size(); ++i)
        if (members_[i].works() && scheduler_->share(i) == greatest_share()) alone_ = i;
}

void MultiDeviceFilm::take_tiles() {
    tiles_.clear();
    if (ranks_ && rank_speeds_.empty()) rank_speeds_.assign(ranks_->count(), 0);
    const std::vector<unsigned> rank_of =
        ranks_ ? deal_tiles(tile_count_, rank_speeds_) : std::vector<unsigned>(tile_count_, 0);
    for (unsigned tile = 0; tile < tile_count_; ++tile)
        if (!ranks_ || rank_of[tile] == ranks_->rank()) tiles_.push_back(tile);
}

std::vector<PixelRows> MultiDeviceFilm::rows() const {
    std::vector<PixelRows> rows;
    for (const unsigned tile : tiles_) {
        const unsigned first = tile * tile_height_, end = std::min(first + tile_height_, unsigned(settings_.height));
        if (!rows.empty() && rows.back().first + rows.back().count == first)
            rows.back().count += end - first;
        else
            rows.push_back({first, end - first});
    }
    return rows;
}

// After the first samples of a picture: measures how fast each rank is, by its devices' clocks, because the host may have
// compiled kernels meanwhile. Returns whether tiles should be dealt anew, because the samples to come take so much less time
// then that the first ones may be traced again. All ranks come to the same answer.
bool MultiDeviceFilm::deal_by_speed(unsigned end, double device_ms) {
    constexpr double kGain = 1.03;
    const std::vector<unsigned> rank_of = deal_tiles(tile_count_, rank_speeds_);
    const std::vector<double> speeds = ranks_->gather(double(tiles_.size()) * end / std::max(device_ms, 1e-3));
    double slowest_ms = 0, sum = 0;
    for (unsigned r = 0; r < speeds.size(); ++r) {
        const auto tiles = double(std::count(rank_of.begin(), rank_of.end(), r));
        if (tiles > 0) slowest_ms = std::max(slowest_ms, tiles / speeds[r]);
        sum += speeds[r];
    }
    const double best_ms = tile_count_ / sum;
    rank_speeds_ = speeds;
    return (settings_.spp - double(end)) * (slowest_ms - kGain * best_ms) > end * best_ms;
}

// Whether the films hold samples of such a picture. A device that no longer takes part loses its tiles.
bool MultiDeviceFilm::goes_on(const MultiPrepared& prepared, const Settings& settings) {
    if (settings.width != settings_.width || settings.height != settings_.height) return false;
    for (Member& member : members_) {
        if (!member.works()) continue;
        const auto* own = prepared.of(member.device);
        if (own && (*own)->layout.row_height() != member.prepared->layout.row_height()) return false;
        member.prepared = own ? *own : nullptr;
        if (!own) member.tiles.clear();
    }
    return true;
}

void MultiDeviceFilm::give(Member& member, const std::vector<unsigned>& tiles) {
    member.rows.begin = member.rows.rows.size();
    for (const unsigned tile : tiles) {
        member.tiles.push_back(tile);
        const unsigned first = tile * member.rows_in_tile;
        for (unsigned row = first; row < std::min(first + member.rows_in_tile, member.rows_in_picture); ++row)
            member.rows.rows.push_back(row);
    }
}

void MultiDeviceFilm::resume(std::shared_ptr<const FloatImage> sums, unsigned samples) {
    start_ = {std::move(sums), samples, true};
}

// Fills the rows that were just given to a member with the samples that the picture began with.
void MultiDeviceFilm::put_start(Member& member) {
    if (start_.sums && member.rows.begin < member.rows.rows.size())
        member.frames->write_sums(*member.prepared, settings_, *start_.sums, &member.rows);
}

// Traces the rows that were given to a member. Returns the time, ms by the host's clock.
double MultiDeviceFilm::trace_rows(Member& member, const Samples& samples, bool count_rays, Progress& progress,
                                   uint8_t* display) {
    const auto begin = Clock::now();
    member.rows.display = display;
    if (!member.rows.rows.empty())
        add_stats(member.stats,
                  member.frames->trace(*member.prepared, settings_, view_, samples, count_rays, progress, &member.rows));
    return ms_since(begin);
}

// Runs on the member's thread.
void MultiDeviceFilm::trace_part(size_t index, const Batch& batch, bool count_rays, Progress& progress) {
    const unsigned sample = batch.sample, end = batch.end;
    Member& member = members_[index];
    const auto woken = Clock::now();
    const auto complete = [&](unsigned done) {
        member.samples = done;
        // Only the caller's thread, which is device 0's, reports progress.
        return done == end || (index == alone_.value_or(0) ? progress.report(float(done - sample) / float(end - sample))
                                                           : !progress.cancelled());
    };
    unsigned first = sample;
    auto since = batch.begin;  // start time shared by all devices: a device that starts late gets fewer tiles
    if (batch.fresh && alone_) {
        give(member, tiles_);
    } else if (batch.fresh && scheduler_->dynamic()) {
        for (auto tiles = scheduler_->next(index); !tiles.empty(); tiles = scheduler_->next(index)) {
            give(member, tiles);
            put_start(member);
            scheduler_->took(index, tiles.size(), trace_rows(member, sample, false, progress));
        }
        if (count_rays && !member.tiles.empty()) {
            FrameStats counted;
            member.frames->count(counted);
            add_stats(member.stats, counted);
        }
        if (!complete(++first)) throw Cancelled();
        since = Clock::now();
    } else if (batch.fresh) {
        give(member, scheduler_->next(index));
        put_start(member);
    }
    member.rows.begin = 0;
    if (first < end) {
        trace_rows(member, {first, end - first, complete}, count_rays, progress, batch.display);
        member.displayed = batch.display != nullptr;
        if (!alone_) scheduler_->took(index, member.tiles.size() * (end - first), ms_since(since));
    }
    member.samples = end;
    member.wall_ms = ms_since(woken);
}

FrameStats MultiDeviceFilm::trace(const std::shared_ptr<const MultiPrepared>& prepared, const Settings& settings,
                                  const View& view, unsigned sample, unsigned end, bool count_rays, Progress& progress,
                                  uint8_t* display) {
    const auto begin = Clock::now();
    for (Member& member : members_) member.displayed = false;
    if (sample == 0) start_ = {};
    const bool fresh = sample == 0 || std::exchange(start_.is_new, false) || !goes_on(*prepared, settings);
    if (settings.width != settings_.width || settings.height != settings_.height) team_ = {};
    prepared_ = prepared;
    settings_ = settings;
    view_ = view;
    if (fresh && sample > start_.samples && blurs(settings)) throw SamplesLost();
    if (fresh)
        cut();
    else
        recover(progress);
    for (Member& member : members_) {
        member.stats = {};
        member.wall_ms = 0;
    }
    for (size_t i = 0; alone_ && i < members_.size(); ++i)
        if (i != *alone_) members_[i].samples = end;  // of no tiles
    on_all([&](size_t i) { trace_part(i, {begin, sample, end, fresh, display}, count_rays, progress); });
    recover(progress);
    if (ranks_ && fresh && sample == 0 && deal_by_speed(end, gathered(0).device_ms)) {
        cut();
        for (Member& member : members_) {
            member.stats = {};
            member.displayed = false;
        }
        on_all([&](size_t i) { trace_part(i, {begin, sample, end, fresh, display}, count_rays, progress); });
        recover(progress);
    }
    const double ms = ms_since(begin);
    if (fresh && may_be_alone()) team_.took(ms / (end - sample), greatest_share());
    return gathered(ms);
}

// Distributes the tiles of devices that failed. All lists are empty if there are none.
std::vector<std::vector<unsigned>> MultiDeviceFilm::orphans() const {
    std::vector<bool> owned(tile_count_);
    for (const Member& member : members_)
        for (const unsigned tile : member.tiles) owned[tile] = true;
    std::vector<std::vector<unsigned>> more(members_.size());
    std::vector<double> owed(members_.size(), 0.0);
    for (const unsigned tile : tiles_) {
        if (owned[tile]) continue;
        for (size_t i = 0; i < members_.size(); ++i)
            owed[i] += members_[i].works() ? std::max(scheduler_->share(i), 1e-6) : -1.0;
        const size_t to = size_t(std::max_element(owed.begin(), owed.end()) - owed.begin());
        owed[to] -= 1;
        more[to].push_back(tile);
    }
    return more;
}

// Traces the tiles of failed devices again, with all samples that are complete elsewhere.
void MultiDeviceFilm::recover(Progress& progress) {
    for (unsigned complete = samples(); complete > start_.samples;) {
        const std::vector<std::vector<unsigned>> more = orphans();
        if (std::all_of(more.begin(), more.end(), [](const auto& tiles) { return tiles.empty(); })) return;
        if (blurs(settings_)) throw SamplesLost();
        on_all([&](size_t i) {
            if (more[i].empty()) return;
            members_[i].displayed = false;
            give(members_[i], more[i]);
            put_start(members_[i]);
            trace_rows(members_[i], {start_.samples, complete - start_.samples}, false, progress);
        });
    }
}

FrameStats MultiDeviceFilm::gathered(double wall_ms) const {
    FrameStats sum;
    for (const Member& member : members_) {
        if (!member.works()) continue;
        const FrameStats& one = member.stats;
        add_rays(sum, one);
        sum.device_ms = std::max(sum.device_ms, one.device_ms);
        merge_times(sum.kernels, one.kernels);
        const DeviceInfo& info = member.device->info();
        sum.devices.push_back({info.id(), info.name});
        DeviceShare& share = sum.devices.back();
        share.share = double(member.rows.rows.size()) / member.rows_in_picture;
        share.device_ms = one.device_ms;
        share.wall_ms = member.wall_ms;
        share.launches = one.launches;
    }
    sum.samples = samples();
    sum.wall_ms = wall_ms;
    return sum;
}

}  // namespace clarity
