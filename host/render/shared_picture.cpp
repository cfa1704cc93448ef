#include "render/shared_picture.hpp"

#include <algorithm>
#include <chrono>
#include <numeric>

#include "base/elapsed.hpp"
#include "base/log.hpp"
#include "render/guarded.hpp"
#include "render/kernel_source.hpp"

namespace clarity {
namespace {

using Clock = std::chrono::steady_clock;

constexpr unsigned kMostStrips = 256;  // about so many: enough to balance devices, and few to keep account of

// A GPU is not full while the slowest rays of a launch end, and idles while the host sees to the next one: a tenth of half a
// sample of 2 ms. With two queues the other one's kernel runs meanwhile.
unsigned queues_for(const DeviceInfo& info) {
    return info.cpu ? 1 : 2;
}

unsigned divided_up(unsigned a, unsigned b) {
    return (a + b - 1) / b;
}

// Rows of pixels of a row of work-groups.
unsigned row_height(const Prepared& prepared, const Device& device) {
    const Layout layout = make_layout(prepared.settings, device.info().cpu);
    return layout.group_h * layout.packet_h;
}

KernelTime& time_of(std::vector<KernelTime>& times, const std::string& name) {
    for (KernelTime& time : times)
        if (time.name == name) return time;
    times.push_back({name, 0});
    return times.back();
}

void add_rays(FrameStats& sum, const FrameStats& more) {
    sum.primary += more.primary;
    sum.shadow += more.shadow;
    sum.secondary += more.secondary;
    sum.dropped += more.dropped;
    sum.overflowed += more.overflowed;
    sum.launches += more.launches;
}

}  // namespace

void add_stats(FrameStats& sum, const FrameStats& more) {
    add_rays(sum, more);
    sum.device_ms += more.device_ms;
    sum.wall_ms += more.wall_ms;
    sum.samples = std::max(sum.samples, more.samples);
    for (const KernelTime& time : more.kernels) time_of(sum.kernels, time.name).ms += time.ms;
}

void merge_times(std::vector<KernelTime>& all, const std::vector<KernelTime>& one) {
    for (const KernelTime& time : one) {
        double& ms = time_of(all, time.name).ms;
        ms = std::max(ms, time.ms);
    }
}

SharedPicture::SharedPicture(const Devices& devices, unsigned queues) {
    std::vector<Error> failures;
    for (const std::shared_ptr<Device>& device : devices) {
        try {
            std::vector<Member> own(queues > 0 ? queues : queues_for(device->info()));
            for (size_t i = 0; i < own.size(); ++i) {
                own[i].device = device;
                own[i].first_queue = i == 0;
                own[i].frames = std::make_unique<Frames>(
                    i == 0 ? device : guarded(*device, "making a queue", [&] { return device->with_own_queue(); }));
            }
            for (Member& member : own) members_.push_back(std::move(member));
        } catch (const Error& error) {
            if (error.code() == Exit::kernel_build_failed) throw;
            failures.push_back(error);
        }
    }
    if (members_.empty()) throw failures.front();
    for (const Error& error : failures)
        log(LogLevel::warning, std::string(error.what()) + "; the other devices go on without it");
    dealer_ = std::make_unique<StripDealer>(members_.size());
    threads_ = std::make_unique<DeviceThreads>(members_.size());
}

size_t SharedPicture::working() const {
    return size_t(std::count_if(members_.begin(), members_.end(), [](const Member& m) { return m.works(); }));
}

unsigned SharedPicture::samples() const {
    unsigned least = ~0u;
    for (const Member& member : members_)
        if (member.works()) least = std::min(least, member.samples);
    return least == ~0u ? 0 : least;
}

void SharedPicture::fail(const Device& device, const Error& error) {
    last_failure_ = error;
    bool known = true;
    for (Member& member : members_) {
        if (member.device.get() != &device) continue;
        known &= !member.frames;
        member.frames.reset();
        member.strips.clear();
        member.rows = {};
    }
    if (working() > 0 && !known)
        log(LogLevel::warning, "device " + device.info().id() + " takes no further part: " + error.what() +
                                   "; the other devices go on without it");
}

// work(i) on each device that takes part; one that fails is out. Throws Cancelled, and what is no device's failure.
void SharedPicture::on_all(const std::function<void(size_t)>& work) {
    const auto thrown = threads_->run([&](size_t i) {
        if (members_[i].works()) work(i);
    });
    bool cancelled = false;
    for (size_t i = 0; i < thrown.size(); ++i) {
        if (!thrown[i]) continue;
        try {
            std::rethrow_exception(thrown[i]);
        } catch (const Cancelled&) {
            cancelled = true;
        } catch (const Error& error) {
            if (error.code() != Exit::failed && error.code() != Exit::no_device) throw;
            fail(*members_[i].device, error);
        } catch (const cl::Error& error) {
            fail(*members_[i].device, Error(Exit::failed, members_[i].device->info().name + ": " + error.what() +
                                                              " failed with OpenCL error " + std::to_string(error.err())));
        }
    }
    if (cancelled) throw Cancelled();
    if (working() == 0) throw last_failure_;
}

void SharedPicture::read(const std::function<void(size_t, Frames&)>& work) {
    for (;;) {
        Progress nobody_cancels;
        recover(nobody_cancels);
        const size_t before = working();
        on_all([&](size_t i) {
            if (!members_[i].strips.empty()) work(i, *members_[i].frames);
        });
        if (working() == before) return;
    }
}

// A new picture's strips. They begin where every device's rows of work-groups do.
void SharedPicture::cut(bool one_sample) {
    unsigned unit = 1;
    bool alike = true;
    const DeviceInfo* first = nullptr;
    std::vector<bool> takes_part;
    for (Member& member : members_) {
        const auto* own = prepared_->of(member.device);
        // A second queue hides ends of launches behind the next sample's, so a picture of one sample has no use for it.
        member.prepared = own && (member.first_queue || !one_sample) ? *own : nullptr;
        member.strips.clear();
        member.rows = {};
        member.samples = 0;
        takes_part.push_back(member.works());
        if (!member.works()) continue;
        const DeviceInfo& info = member.device->info();
        if (!first) first = &info;
        alike &= info.compute_units == first->compute_units && info.driver == first->driver && info.parts == first->parts &&
                 (info.parts > 0 || info.name == first->name);
        unit = std::lcm(unit, row_height(*member.prepared, *member.device));
    }
    if (!first) throw last_failure_;
    const auto height = unsigned(settings_.height);
    const unsigned strip_height = unit * std::max(1u, height / unit / kMostStrips);
    strip_count_ = divided_up(height, strip_height);
    for (Member& member : members_) {
        if (!member.works()) continue;
        const unsigned row = row_height(*member.prepared, *member.device);
        member.rows_in_strip = strip_height / row;
        member.rows_in_picture = divided_up(height, row);
    }
    dealer_->begin(strip_count_, takes_part, alike);
}

// Whether what is in the films is of such a picture. A device that takes no part any more loses its strips.
bool SharedPicture::goes_on(const MultiPrepared& prepared, const Settings& settings) {
    if (settings.width != settings_.width || settings.height != settings_.height) return false;
    for (Member& member : members_) {
        if (!member.works()) continue;
        const auto* own = prepared.of(member.device);
        if (own && row_height(**own, *member.device) != row_height(*member.prepared, *member.device)) return false;
        member.prepared = own ? *own : nullptr;
        if (!own) member.strips.clear();
    }
    return true;
}

void SharedPicture::give(Member& member, const std::vector<unsigned>& strips) {
    member.rows.begin = member.rows.rows.size();
    for (const unsigned strip : strips) {
        member.strips.push_back(strip);
        const unsigned first = strip * member.rows_in_strip;
        for (unsigned row = first; row < std::min(first + member.rows_in_strip, member.rows_in_picture); ++row)
            member.rows.rows.push_back(row);
    }
}

// Returns how long it took, ms.
double SharedPicture::trace_rows(Member& member, unsigned sample, Progress& progress) {
    const auto begin = Clock::now();
    if (!member.rows.rows.empty())
        add_stats(member.stats,
                  member.frames->trace(*member.prepared, settings_, view_, sample, false, progress, &member.rows));
    return ms_since(begin);
}

void SharedPicture::trace_part(size_t index, unsigned sample, unsigned end, bool fresh, bool count_rays, Progress& progress) {
    Member& member = members_[index];
    const auto begin = Clock::now();
    for (unsigned s = sample; s < end; ++s) {
        if (fresh && s == sample) {
            for (auto strips = dealer_->next(index); !strips.empty(); strips = dealer_->next(index)) {
                give(member, strips);
                dealer_->took(index, strips.size(), trace_rows(member, s, progress));
            }
        } else {
            member.rows.begin = 0;
            dealer_->took(index, member.strips.size(), trace_rows(member, s, progress));
        }
        if (count_rays && !member.strips.empty()) {
            FrameStats counted;
            member.frames->count(counted);
            add_stats(member.stats, counted);
        }
        member.samples = s + 1;
        if (s + 1 == end) break;
        // Progress is told by one thread, the caller's.
        const bool go_on = index == 0 ? progress.report(float(s + 1 - sample) / float(end - sample)) : !progress.cancelled();
        if (!go_on) throw Cancelled();
    }
    member.wall_ms = ms_since(begin);
}

FrameStats SharedPicture::trace(const std::shared_ptr<const MultiPrepared>& prepared, const Settings& settings,
                                const View& view, unsigned sample, unsigned end, bool count_rays, Progress& progress) {
    const auto begin = Clock::now();
    const bool fresh = sample == 0 || !goes_on(*prepared, settings);
    prepared_ = prepared;
    settings_ = settings;
    view_ = view;
    if (fresh)
        cut(end - sample == 1);
    else
        recover(progress);
    for (Member& member : members_) {
        member.stats = {};
        member.wall_ms = 0;
    }
    on_all([&](size_t i) { trace_part(i, sample, end, fresh, count_rays, progress); });
    recover(progress);
    return gathered(ms_since(begin));
}

// Strips whose owner failed, shared out; all lists are empty if there are none.
std::vector<std::vector<unsigned>> SharedPicture::orphans() const {
    std::vector<bool> owned(strip_count_);
    for (const Member& member : members_)
        for (const unsigned strip : member.strips) owned[strip] = true;
    std::vector<std::vector<unsigned>> more(members_.size());
    std::vector<double> owed(members_.size(), 0.0);
    for (unsigned strip = 0; strip < strip_count_; ++strip) {
        if (owned[strip]) continue;
        for (size_t i = 0; i < members_.size(); ++i) owed[i] += members_[i].works() ? std::max(dealer_->share(i), 1e-6) : -1.0;
        const size_t to = size_t(std::max_element(owed.begin(), owed.end()) - owed.begin());
        owed[to] -= 1;
        more[to].push_back(strip);
    }
    return more;
}

// Traces what failed devices had once more, all samples of it.
void SharedPicture::recover(Progress& progress) {
    for (unsigned complete = samples(); complete > 0;) {
        const std::vector<std::vector<unsigned>> more = orphans();
        if (std::all_of(more.begin(), more.end(), [](const auto& strips) { return strips.empty(); })) return;
        on_all([&](size_t i) {
            if (more[i].empty()) return;
            give(members_[i], more[i]);
            for (unsigned sample = 0; sample < complete; ++sample) trace_rows(members_[i], sample, progress);
        });
    }
}

FrameStats SharedPicture::gathered(double wall_ms) const {
    FrameStats sum;
    for (const Member& member : members_) {
        if (!member.works()) continue;
        const FrameStats& one = member.stats;
        add_rays(sum, one);
        sum.device_ms = std::max(sum.device_ms, one.device_ms);
        merge_times(sum.kernels, one.kernels);
        const DeviceInfo& info = member.device->info();
        if (sum.devices.empty() || sum.devices.back().id != info.id()) sum.devices.push_back({info.id(), info.name});
        DeviceShare& share = sum.devices.back();
        share.share += double(member.rows.rows.size()) / member.rows_in_picture;
        share.device_ms = std::max(share.device_ms, one.device_ms);
        share.wall_ms = std::max(share.wall_ms, member.wall_ms);
        share.launches += one.launches;
    }
    sum.samples = samples();
    sum.wall_ms = wall_ms;
    return sum;
}

}  // namespace clarity
