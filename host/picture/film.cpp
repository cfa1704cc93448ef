#include "picture/film.hpp"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <utility>

#include "base/elapsed.hpp"
#include "device/cl_errors.hpp"
#include "device/kernel_files.hpp"
#include "device/launch_limit.hpp"
#include "device/set_arguments.hpp"
#include "picture/false_colors.hpp"

namespace clarity {
namespace {

constexpr size_t kSumBytes = 4 * sizeof(uint64_t);  // four sums of two uints each, low half first
constexpr unsigned kSummersPerUnit = 2048;          // work-items that run on a GPU's compute unit at the same time

// The number that film.cl uses.
cl_uint number_of_tone(const std::string& tone) {
    const std::vector<std::string> names = tone_names();
    return static_cast<cl_uint>(std::find(names.begin(), names.end(), tone) - names.begin());
}

// Upper bound of the vectors of pixels in a row of work-groups. A row that is no whole number of vectors may begin inside one.
size_t quads_touched(size_t row_pixels) {
    constexpr size_t each = FilmKernels::kPixelsAtOnce;
    return row_pixels % each == 0 ? row_pixels / each : (row_pixels + 2 * (each - 1)) / each;
}

}  // namespace

ByteImage show_values(const std::function<FloatImage()>& read, const std::string& aov, const Settings& settings,
                      std::vector<KernelTime>* times, FalseColorScale* scale) {
    using Clock = std::chrono::steady_clock;
    const auto begin = Clock::now();
    const FloatImage values = read();
    const auto done = Clock::now();
    const FalseColorScale found = scale_of(values, aov, static_cast<float>(settings.scale_max));
    ByteImage image = false_colors(values, aov, found);
    if (times) {
        times->push_back({"read-back", std::chrono::duration<double, std::milli>(done - begin).count()});
        times->push_back({"false colours", ms_since(done)});
    }
    if (scale) *scale = found;
    return image;
}

CompileRequest film_program() {
    return {"#line 1 \"cl/film.cl\"\n" + kernel_text("film.cl"), "-cl-std=CL1.2", "film"};
}

FilmKernels::FilmKernels(std::shared_ptr<Device> device) : device_(device), memory_(device) {
    Progress never_cancelled;
    const BuildResult built = compile_program(*device_, film_program(), never_cancelled);
    wrap_cl_errors(*device_, "preparing the film", [&] {
        program_ = built.program;
        map_tones_ = cl::Kernel(program_, "map_tones");
        map_tones_of_rows_ = cl::Kernel(program_, "map_tones_of_rows");
        sum_counters_ = cl::Kernel(program_, "sum_counters");
        sum_wide_counters_ = cl::Kernel(program_, "sum_wide_counters");
        add_layers_ = cl::Kernel(program_, "add_layers");
    });
}

// An asynchronous read of the sums may still be writing to our memory: wait for it.
FilmKernels::~FilmKernels() {
    if (sums_read_()) clWaitForEvents(1, &sums_read_());
}

cl::Event FilmKernels::begin_sum(const cl::Buffer& counters, unsigned count, CounterWidth width) {
    Queue& queue = device_->queue();
    const cl::Buffer& out = sums_.fit(device_->context(), kSumBytes);
    if (!read_sums_) read_sums_ = memory_.lend(kSumBytes);
    queue.enqueueFillBuffer(out, cl_uint(0), 0, kSumBytes);
    cl::Kernel& kernel = width == CounterWidth::bits64 ? sum_wide_counters_ : sum_counters_;
    set_arguments(kernel, counters, count, out);
    summed_ = run(kernel, std::min(count, device_->info().compute_units * kSummersPerUnit));
    queue.enqueueReadBuffer(out, CL_FALSE, 0, kSumBytes, read_sums_.get(), nullptr, &sums_read_);
    return sums_read_;
}

std::array<uint64_t, 4> FilmKernels::end_sum(KernelTime& time) {
    wait_for(*device_, sums_read_, "the kernel sum_counters");
    time = {"counters", event_ms(summed_)};
    cl_uint halves[8];
    std::memcpy(halves, read_sums_.get(), sizeof halves);
    const auto sum = [&](int i) { return uint64_t(halves[2 * i + 1]) << 32 | halves[2 * i]; };
    return {sum(0), sum(1), sum(2), sum(3)};
}

void FilmKernels::set_map(cl::Kernel& kernel, const cl::Buffer& film, const cl::Buffer& display, size_t pixels,
                          const Settings& settings) {
    set_arguments(kernel, film, display, static_cast<cl_uint>(room(pixels) / kPixelsAtOnce),
                  static_cast<float>(settings.exposure), number_of_tone(settings.tone));
}

cl::Event FilmKernels::map_tones(const cl::Buffer& film, const cl::Buffer& display, size_t pixels, const Settings& settings) {
    set_map(map_tones_, film, display, pixels, settings);
    return run(map_tones_, room(pixels) / kPixelsAtOnce);
}

cl::Event FilmKernels::run(const cl::Kernel& kernel, size_t items) {
    cl::Event done;
    device_->queue().enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange((items + 63) / 64 * 64), cl::NDRange(64), nullptr,
                                          &done);
    return done;
}

const cl::Buffer& FilmKernels::table_of(const std::vector<rt_u32>& rows) {
    const size_t bytes = rows.size() * sizeof(rt_u32);
    const cl::Buffer before = rows_.get();
    const cl::Buffer& table = rows_.fit(device_->context(), bytes);
    if (rows_written_ != rows || table() != before()) {
        rows_written_ = rows;
        device_->queue().enqueueWriteBuffer(table, CL_TRUE, 0, bytes, rows_written_.data());
    }
    return table;
}

cl::Event FilmKernels::add_layers(const cl::Buffer& film, const cl::Buffer& layers, unsigned count, bool adds,
                                  const GroupRows& rows) {
    const size_t items = rows.row_pixels() * rows.rows.size();
    set_arguments(add_layers_, film, layers, static_cast<cl_uint>(size_t(rows.width) * rows.height),
                  static_cast<cl_uint>(count), static_cast<cl_uint>(adds), table_of(rows.rows),
                  static_cast<cl_uint>(rows.row_pixels()), static_cast<cl_uint>(items));
    return run(add_layers_, items);
}

cl::Event FilmKernels::begin_rows(const cl::Buffer& film, const GroupRows& rows, const Settings& settings, uint8_t* rgba) {
    const size_t pixels = size_t(rows.width) * rows.height;
    const cl::Buffer& display = display_.fit(device_->context(), room(pixels) * 4);
    set_map(map_tones_of_rows_, film, display, pixels, settings);
    const size_t row_quads = quads_touched(rows.row_pixels()), items = row_quads * rows.rows.size();
    map_tones_of_rows_.setArg(5, table_of(rows.rows));
    map_tones_of_rows_.setArg(6, static_cast<cl_uint>(rows.row_pixels()));
    map_tones_of_rows_.setArg(7, static_cast<cl_uint>(row_quads));
    map_tones_of_rows_.setArg(8, static_cast<cl_uint>(items));
    rows_mapped_ = run(map_tones_of_rows_, items);
    rows_read_.clear();
    read_bands(device_->queue(), display, rows.bands(), size_t(rows.width) * 4, rgba, &rows_read_);
    return rows_read_.back();
}

void FilmKernels::end_rows(std::vector<KernelTime>& times) {
    wait_for(*device_, rows_read_.back(), "the kernel map_tones_of_rows");
    times.push_back({"tone map", event_ms(rows_mapped_)});
    times.push_back({"read-back", span_ms(rows_read_.front(), rows_read_.back())});
}

}  // namespace clarity
