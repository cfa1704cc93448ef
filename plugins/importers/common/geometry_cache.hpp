// geometry_cache.hpp -- reads files that have the vertices of a mesh at several times: caches of Maya (.xml with .mc or .mcx)
// and point caches (.pc2). For importers.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "mapped_file.hpp"
#include "numbers.hpp"
#include "rt_plugin.hpp"

namespace importers {

// Why a cache cannot be used, without its name.
struct BrokenCache : std::runtime_error {
    using std::runtime_error::runtime_error;
};

struct CacheFrames {
    std::vector<double> times;     // seconds
    std::vector<float> positions;  // 3 for each vertex of each frame
    void add(double time, const std::vector<float>& at) {
        if (!times.empty() && time <= times.back()) throw BrokenCache("its times do not increase");
        if (!std::all_of(at.begin(), at.end(), [](float x) { return std::isfinite(x); }))
            throw BrokenCache("it has values that are no finite numbers");
        times.push_back(time);
        positions.insert(positions.end(), at.begin(), at.end());
    }
    // Passes them as the motion of a mesh. copy_of: the file's vertex of each vertex that stands behind the file's own.
    void pass(rt_u32 mesh, const std::vector<rt_u32>& copy_of, const rt_scene_sink& sink) const {
        const size_t numbers = positions.size() / times.size();
        std::vector<float> all;
        all.reserve((numbers + 3 * copy_of.size()) * times.size());
        for (auto frame = positions.begin(); frame != positions.end(); frame += numbers) {
            all.insert(all.end(), frame, frame + numbers);
            for (const size_t vertex : copy_of) all.insert(all.end(), frame + 3 * vertex, frame + 3 * vertex + 3);
        }
        rt_vertex_frames out{};
        out.struct_bytes = sizeof out;
        out.mesh = mesh;
        out.frame_count = times.size();
        out.times_s = times.data();
        out.positions = all.data();
        if (sink.vertex_frames(sink.ctx, &out) != RT_OK) throw rt::Stopped();
    }
};

// Maya's times have 6000 ticks a second (measured from maya_cache_sine_7500_binary_fpc: 250 a frame at 24 frames a second).
inline constexpr double kMayaTicks = 6000;

// A cache of Maya consists of chunks, big-endian: a name of four letters and a length. FOR4 (.mc) has 32-bit lengths and chunks
// padded to 4 bytes; FOR8 (.mcx) has 4 bytes between the name and a 64-bit length, and chunks padded to 8. Measured from
// maya_cache_sine_7500_binary_fpc; FOR4: Maya help, "Maya nCache and geometry cache formats".
class MayaCache {
 public:
    MayaCache(std::string_view bytes, std::string_view channel, size_t points, CacheFrames& out)
        : bytes_(bytes), wide_(bytes.substr(0, 4) == "FOR8"), channel_(channel), points_(points), out_(out) {
        if (!wide_ && bytes.substr(0, 4) != "FOR4")
            throw BrokenCache("byte 0: found no chunk FOR4 or FOR8; expected a cache of Maya");
    }
    // `time`: of the frame, in seconds, for files that do not say.
    void read(double time) {
        time_ = time;
        for (size_t at = 0; at < bytes_.size();) {
            const Chunk group = chunk(at, bytes_.size());
            if (group.data.substr(0, 4) == "MYCH") read_frame(group.data.data() - bytes_.data() + 4, group.end);
            at = group.next;
        }
    }

 private:
    struct Chunk {
        std::string_view name, data;
        size_t end, next;
    };
    Chunk chunk(size_t at, size_t end) const {
        const size_t head = wide_ ? 16 : 8, pad = wide_ ? 8 : 4;
        const auto fail = [&] {
            throw BrokenCache("byte " + std::to_string(at) + ": a chunk reaches beyond its file or block");
        };
        if (end - at < head) fail();
        const uint64_t size =
            wide_ ? load<uint64_t>(bytes_.data() + at + 8, true) : load<uint32_t>(bytes_.data() + at + 4, true);
        if (size > end - at - head) fail();
        const size_t data_end = at + head + size, next = at + head + (size + pad - 1) / pad * pad;
        const bool is_group = bytes_.substr(at, 3) == "FOR";
        return {bytes_.substr(at, 4), bytes_.substr(at + head, size), data_end, is_group ? data_end : std::min(next, end)};
    }
    // TIME, then for each channel its name (CHNM), the count of its vectors (SIZE) and the vectors as floats (FVCA) or doubles
    // (DVCA).
    void read_frame(size_t at, size_t end) {
        std::string_view name;
        while (at < end) {
            const Chunk c = chunk(at, end);
            at = c.next;
            if (c.name == "TIME" && c.data.size() >= 4) time_ = load<uint32_t>(c.data.data(), true) / kMayaTicks;
            if (c.name == "CHNM") name = c.data.substr(0, c.data.find('\0'));
            const bool is_float = c.name == "FVCA";
            if ((!is_float && c.name != "DVCA") || name != channel_) continue;
            const size_t element = is_float ? 4 : 8;
            if (c.data.size() != 3 * points_ * element) {
                throw BrokenCache("byte " + std::to_string(c.data.data() - bytes_.data()) + ": a frame has " +
                                  std::to_string(c.data.size() / element / 3) + " vertices; the mesh has " +
                                  std::to_string(points_));
            }
            std::vector<float> positions(3 * points_);
            for (size_t i = 0; i < positions.size(); ++i) {
                const char* from = c.data.data() + i * element;
                positions[i] = is_float ? load<float>(from, true) : static_cast<float>(load<double>(from, true));
            }
            out_.add(time_, positions);
        }
    }
    const std::string_view bytes_;
    const bool wide_;
    const std::string_view channel_;
    const size_t points_;
    CacheFrames& out_;
    double time_ = 0;
};

// The text of an XML attribute behind `from`, up to the end of its element; empty: there is none.
inline std::string_view attribute(std::string_view xml, size_t from, const std::string& name) {
    const std::string_view element = xml.substr(from, xml.find('>', from) - from);
    const size_t at = element.find(" " + name + "=\"");
    if (at == element.npos) return {};
    const std::string_view rest = element.substr(at + name.size() + 3);
    return rest.substr(0, rest.find('"'));
}

// Reads one file of a cache. Throws BrokenCache with the file's name.
inline void read_maya_file(const std::string& path, std::string_view channel, size_t points, double time, CacheFrames& out) {
    try {
        const MappedFile file(path);
        MayaCache(file.bytes(), channel, points, out).read(time);
    } catch (const std::runtime_error& why) {
        throw BrokenCache("its file " + path.substr(path.find_last_of('/') + 1) + ": " + why.what());
    }
}

// The description names the form (OneFile, OneFilePerFrame), the format (mc, mcx), the range and the step of time.
inline void read_maya(const std::string& path, std::string_view xml, std::string_view channel, size_t points,
                      CacheFrames& out) {
    const auto element = [&](const char* name) {
        const size_t at = xml.find(name);
        if (at == xml.npos) throw BrokenCache(std::string("its description has no element ") + name);
        return at;
    };
    const size_t type = element("<cacheType");
    const std::string stem = path.substr(0, path.find_last_of('.')), suffix = "." + std::string(attribute(xml, type, "Format"));
    if (suffix != ".mc" && suffix != ".mcx") throw BrokenCache("its format is '" + suffix.substr(1) + "'; expected mc or mcx");
    if (attribute(xml, type, "Type") == "OneFile") return read_maya_file(stem + suffix, channel, points, 0, out);
    const std::string range(attribute(xml, element("<time "), "Range"));
    const long step =
        std::strtol(std::string(attribute(xml, element("<cacheTimePerFrame"), "TimePerFrame")).c_str(), nullptr, 10);
    char* rest = nullptr;
    const long begin = std::strtol(range.c_str(), &rest, 10), end = *rest == '-' ? std::strtol(rest + 1, nullptr, 10) : begin;
    if (step <= 0 || end < begin || (end - begin) / step > 1000000)
        throw BrokenCache("its range of time '" + range + "' makes no sense");
    for (long time = begin; time <= end; time += step) {
        const std::string file = stem + "Frame" + std::to_string(time / step) + suffix;
        read_maya_file(file, channel, points, static_cast<double>(time) / kMayaTicks, out);
    }
}

// A point cache of 3ds Max, little-endian: "POINTCACHE2", 0, version, vertices, first frame, frames from sample to sample,
// samples (32 bits each), then the vertices of each sample as floats. Source: the format's usual description, "PC2 point
// cache".
inline void read_points(std::string_view bytes, double fps, size_t points, CacheFrames& out) {
    constexpr size_t head = 32;
    if (bytes.size() < head) throw BrokenCache("byte 0: it ends within its head");
    const uint32_t vertices = load<uint32_t>(bytes.data() + 16, false), samples = load<uint32_t>(bytes.data() + 28, false);
    const float first = load<float>(bytes.data() + 20, false), step = load<float>(bytes.data() + 24, false);
    if (vertices != points)
        throw BrokenCache("byte 16: it has " + std::to_string(vertices) + " vertices; the mesh has " + std::to_string(points));
    if (samples > (bytes.size() - head) / (12 * std::max<size_t>(points, 1)))
        throw BrokenCache("byte 28: it has fewer than its " + std::to_string(samples) + " samples");
    if (!(std::isfinite(first) && step > 0 && step < 1e6))
        throw BrokenCache("byte 20: its first frame or its step makes no sense");
    std::vector<float> positions(3 * points);
    for (uint32_t s = 0; s < samples; ++s) {
        std::memcpy(positions.data(), bytes.data() + head + s * points * 12, points * 12);
        out.add((double(first) + double(s) * double(step)) / fps, positions);
    }
}

// Reads the cache at `path` for a mesh of `points` vertices. channel: its name in caches of Maya. fps: frames a second, for
// point caches. Throws std::runtime_error with the reason.
inline CacheFrames read_geometry_cache(const std::string& path, std::string_view channel, size_t points, double fps) {
    CacheFrames frames;
    const MappedFile file(path);
    if (file.bytes().substr(0, 11) == "POINTCACHE2") {
        read_points(file.bytes(), fps, points, frames);
    } else {
        read_maya(path, file.bytes(), channel, points, frames);
    }
    return frames;
}

}  // namespace importers
