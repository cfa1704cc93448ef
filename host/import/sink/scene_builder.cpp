#include "import/sink/scene_builder.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <tuple>
#include <utility>

#include "base/digest.hpp"
#include "base/error.hpp"
#include "base/files/frame_path.hpp"
#include "base/files/packed_file.hpp"
#include "base/files/read_file.hpp"
#include "base/text.hpp"
#include "import/sink/mesh_copy.hpp"
#include "import/sink/scene_sink.hpp"
#include "import/sink/texture.hpp"
#include "import/sink/world_origin.hpp"
#include "plugin/host_services.hpp"
#include "plugin/parameters.hpp"
#include "scene/bright_texture.hpp"
#include "scene/map_edit.hpp"
#include "scene/motion/pose.hpp"
#include "scene/singular_instances.hpp"
#include "scene/tangents.hpp"
#include "scene/usable.hpp"

namespace clarity::import {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMaxDepth = 16;
// Bounds the number of placed objects: a few files that each load another one twice could place more than any machine can hold.
constexpr uint64_t kMaxPlaced = 1u << 22;
constexpr size_t kMaxWarnings = 100;

std::string file_name(const std::string& path) {
    return fs::path(path).filename().string();
}

[[noreturn]] void fail(const std::string& path, const std::string& why, Failure failure = Failure::other) {
    throw Error(Exit::import_failed, path + ": " + why).as(failure);
}

std::string known_extensions(const PluginRegistry& plugins) {
    std::set<std::string> known;
    for (const rt_plugin* plugin : plugins.importers()) {
        for (const char* const* e = plugin->importer->extensions; *e; ++e) known.insert(*e);
    }
    std::string list;
    for (const std::string& extension : known) list += (list.empty() ? "" : ", ") + extension;
    return list;
}

// Reserves address space for the largest arrays, so that they seldom move while they grow: a move holds an array twice. Memory
// that is not written costs nothing. Files whose numbers are packed may need more.
void reserve_arrays(const std::string& path, Scene& scene) {
    const uint64_t size = stated_content_bytes(path);
    if (!scene.positions.empty()) return;
    rlimit space{};
    getrlimit(RLIMIT_AS, &space);
    // 1.5 times the file, but at most 256 MB and a sixteenth of what the process may have.
    const size_t numbers = static_cast<size_t>(std::min({size / 8 * 3, uint64_t(64) << 20, uint64_t(space.rlim_cur) / 64}));
    scene.positions.reserve(numbers);
    scene.triangles.reserve(numbers);
    scene.triangle_materials.reserve(numbers / 3);
}

// The message without the prefix "PATH: ". A plugin may have written it itself, to add line and column.
std::string without_path(const std::string& why, const std::string& path) {
    return why.compare(0, path.size() + 2, path + ": ") == 0 ? why.substr(path.size() + 2) : why;
}

}  // namespace

SceneBuilder::SceneBuilder(const PluginRegistry& plugins, ImporterParameters parameters, const FileAccess& access,
                           Progress& progress, ImportObserver* observer)
    : plugins_(plugins), parameters_(std::move(parameters)), access_(access), progress_(progress), observer_(observer) {
    scene_.materials.push_back({"default", default_material()});
}

void SceneBuilder::warn(const std::string& file, const std::string& text) {
    std::string warning = file + ": " + text;
    // Importers know a packed file by the name of what is in it.
    for (const std::string& name : {file, name_without_gz(file)})
        if (text.compare(0, name.size() + 1, name + ":") == 0) warning = file + text.substr(name.size());
    // Of what many parts of a file have wrong alike, as a sampler that several textures name, once is enough.
    if (std::find(scene_.warnings.begin(), scene_.warnings.end(), warning) != scene_.warnings.end()) return;
    if (scene_.warnings.size() < kMaxWarnings)
        scene_.warnings.push_back(std::move(warning));
    else
        ++warnings_left_out_;
}

void SceneBuilder::add_root(const std::string& path) {
    std::error_code error;
    const std::string file = first_frame(path);
    const fs::path canonical = fs::canonical(file, error);
    if (error) fail(path, "cannot be read: " + error.message());
    const FileContent& content = content_or_sequence(path, file, canonical.string());
    place(path, content, {}, world_);
    const bool hollow = std::all_of(content.instances.begin(), content.instances.end(),
                                    [&](const Instance& i) { return scene_.meshes[i.mesh].triangle_count == 0; });
    if (hollow && content.spheres.empty() && content.planes.empty() && content.polygons.empty() && content.shapes.empty()) {
        warn(path, "holds no surface that could be rendered");
    }
}

void SceneBuilder::set_info(const std::string& path, const rt_scene_info& info) {
    if (open_.size() != 1) return;
    const auto take_color = [](const float* from, std::array<float, 3>& to, bool& known) {
        if (!from || known || !are_usable(from, 3)) return;
        std::copy(from, from + 3, to.begin());
        known = true;
    };
    take_color(info.background, scene_.background, knows_background_);
    take_color(info.ambient, scene_.ambient, knows_ambient_);
    if (knows_axes_) return;
    knows_axes_ = true;
    scene_.up_axis = info.up_axis;
    if (info.up_axis > 2) {
        warn(path, "its importer says up axis " + std::to_string(info.up_axis) + " of 0, 1 and 2 (X, Y, Z): Y is taken");
        scene_.up_axis = 1;
    }
    scene_.unit_scale = std::isfinite(info.unit_scale) && info.unit_scale > 0 ? info.unit_scale : 0;
}

// A file is being imported, until the end of a scope.
struct SceneBuilder::Opened {
    Opened(SceneBuilder& in, const std::string& canonical, bool stores) : builder(in), outer_stores(in.stores_) {
        in.open_.push_back(canonical);
        in.stores_ = stores;
    }
    Opened(const Opened&) = delete;
    Opened& operator=(const Opened&) = delete;
    ~Opened() {
        builder.open_.pop_back();
        builder.stores_ = outer_stores;
    }
    SceneBuilder& builder;
    const bool outer_stores;
};

// Returns the content of a file and runs its importer on first use. The sink's `load` calls this recursively.
const FileContent& SceneBuilder::content_of(const std::string& path, const std::string& canonical) {
    const auto known = files_.find(canonical);
    if (known != files_.end()) return *known->second;
    const rt_plugin* plugin = plugins_.importer_for(path);
    if (!plugin) {
        const std::string list = known_extensions(plugins_);
        fail(path,
             list.empty() ? "no importers are loaded; `clarity plugins` lists the libraries seen and why they were refused"
                          : "no importer reads this kind of file; the known ones are " + list,
             Failure::no_importer);
    }
    const std::string stage = "importing " + file_name(path);
    progress_.stage(stage);
    if (observer_) observer_->running(path, plugin->id);
    as_stored_.resize(scene_.meshes.size(), stores_);
    const Opened opened(*this, canonical, !parameters_.deforms(plugin->id));
    auto content = std::make_unique<FileContent>();
    content->first_material = static_cast<rt_u32>(scene_.materials.size());
    reserve_arrays(path, scene_);
    std::string unpacked;
    const bool packed = is_packed(path);
    const std::string name = packed ? name_without_gz(path) : path;
    HostServices services(path, progress_, name);
    if (packed) {
        if (!(plugin->importer->flags & RT_IMPORTER_TAKES_CONTENT))
            fail(path, "is packed with gzip, and the importer " + std::string(plugin->id) +
                           " takes no packed files; unpack it first (gunzip -k)");
        const auto report = [&](float fraction) {
            if (!progress_.report(fraction)) throw Cancelled();
        };
        progress_.stage("unpacking " + file_name(path));
        if (const Problem why = unpack_file(path, report, unpacked)) fail(path, why.text());
        progress_.stage(stage);
        services.set_content(unpacked);
    }
    SceneSink sink(*this, services, path, *content);
    try {
        const auto chosen = parameters_.values.find(plugin->id);
        const ParameterValues parameters = chosen != parameters_.values.end() ? chosen->second : default_parameters(*plugin);
        services.check(static_cast<int>(Exit::import_failed),
                       [&] { return plugin->importer->load(services.host(), name.c_str(), parameters.data(), sink.sink()); });
    } catch (const Cancelled&) {
        throw;
    } catch (const Error& e) {
        if (sink.cancelled()) throw Cancelled();
        const std::string why = without_path(without_path(e.what(), path), path);
        // "main.scene:3:9: ..." contains the file's name already.
        if (why.compare(0, path.size() + 1, path + ":") == 0) throw Error(Exit::import_failed, why).as(e.failure());
        fail(path, why, e.failure());
    }
    if (const Problem why = sink.finish()) fail(path, why.text());
    as_stored_.resize(scene_.meshes.size(), stores_);
    if (open_.size() > 1) progress_.stage("importing " + file_name(open_[open_.size() - 2]));
    return *(files_[canonical] = std::move(content));
}

// `file` is the path itself, or the first file that a path like walk_####.obj stands for. All its files are one clip then.
const FileContent& SceneBuilder::content_or_sequence(const std::string& path, const std::string& file,
                                                     const std::string& canonical) {
    if (file == path) return content_of(file, canonical);
    constexpr double kFps = 24;
    const std::string pattern = (fs::path(canonical).parent_path() / fs::path(path).filename()).string();
    const auto known = files_.find(pattern);
    if (known != files_.end()) return *known->second;
    FileSequence sequence;
    sequence.pattern = pattern;
    sequence.fps = kFps;
    sequence.first_mesh = static_cast<rt_u32>(scene_.meshes.size());
    sequence.first_number = static_cast<rt_u32>(scene_.motion.sequence_numbers.size());
    // Under the pattern's name: the same file placed by its own name is another mesh, which rests.
    content_of(file, pattern);
    FileContent& content = *files_[pattern];
    // All files of a sequence have one origin, 0, whatever their importer subtracted (SequenceReader).
    for (Instance& instance : content.instances) {
        if (!content.has_mesh_origins) break;
        add_origin(scene_, instance, instance.rounded_off);
        for (size_t k = 0; k < 3; ++k) instance.world_from_object[4 * k + 3] = 0, instance.rounded_off[k] = 0;
    }
    for (const int number : frame_numbers(pattern)) scene_.motion.sequence_numbers.push_back(static_cast<rt_u32>(number));
    sequence.mesh_count = static_cast<rt_u32>(scene_.meshes.size()) - sequence.first_mesh;
    sequence.number_count = static_cast<rt_u32>(scene_.motion.sequence_numbers.size()) - sequence.first_number;
    Clip clip;
    clip.name = file_name(pattern);
    clip.layer_count = 1;
    clip.first_layer = static_cast<rt_u32>(content.layers.size());
    clip.begin_s = scene_.motion.sequence_numbers[sequence.first_number] / kFps;
    clip.end_s = scene_.motion.sequence_numbers.back() / kFps;
    clip.fps = kFps;
    content.layers.push_back({RT_LAYER_REPLACES, 0, 1});
    content.clips.push_back(std::move(clip));
    content.rig_count = std::max<rt_u32>(content.rig_count, 1);
    content.deforms = true;
    scene_.motion.sequences.push_back(std::move(sequence));
    return content;
}

Problem SceneBuilder::include(const std::string& from, const std::string& path, const Placement& placement, FileContent& into) {
    const std::string what = "cannot load '" + path + "': ";
    // A path like walk_####.obj stands for the files beside the one that names it.
    const fs::path pattern = fs::path(from).parent_path() / path;
    const std::string frame = first_frame(pattern.string());
    const bool is_sequence = !frame.empty() && frame != pattern.string();
    const FileAccess::Found found = access_.find(from, is_sequence ? fs::absolute(frame).string() : path);
    if (found.path.empty()) return what + found.why;
    if (std::find(open_.begin(), open_.end(), found.path) != open_.end()) {
        std::string cycle;
        for (auto it = std::find(open_.begin(), open_.end(), found.path); it != open_.end(); ++it)
            cycle += file_name(*it) + " -> ";
        return what + "files load each other in a circle: " + cycle + file_name(found.path);
    }
    if (open_.size() >= kMaxDepth) return what + "files load each other more than " + std::to_string(kMaxDepth) + " deep";
    // Show the path as the author wrote it: the file's own relative paths start there. If a search path was needed, show the
    // path that was found.
    const fs::path beside = is_sequence ? fs::path(frame) : pattern;
    std::error_code error;
    const std::string shown = fs::equivalent(beside, found.path, error) ? beside.string() : found.path;
    try {
        check_model_file(shown);
        const FileContent& content =
            is_sequence ? content_or_sequence(pattern.string(), frame, found.path) : content_of(shown, found.path);
        placed_ += content.instances.size() + content.spheres.size() + content.planes.size() + content.polygons.size();
        for (const Shape& shape : content.shapes) placed_ += shape.part_count;
        if (placed_ > kMaxPlaced)
            return what + "more than " + std::to_string(kMaxPlaced) + " objects of loaded files are placed";
        place(shown, content, placement, into);
    } catch (const Cancelled&) {
        throw;
    } catch (const Error& e) {
        return {what + without_path(e.what(), shown), e.failure()};
    }
    return {};
}

rt_u32 SceneBuilder::shape_kind(const std::string& id) {
    std::vector<ShapeKind>& kinds = scene_.shape_kinds;
    for (size_t i = 0; i < kinds.size(); ++i)
        if (kinds[i].id == id) return static_cast<rt_u32>(i);
    kinds.push_back({id, nullptr});
    return static_cast<rt_u32>(kinds.size() - 1);
}

namespace {

// Adds the smaller pictures of one that was just decoded.
Problem completed(Problem why, const rt_texture_desc& d, std::vector<uint32_t>& texels, rt_texture& picture) {
    if (why) return why;
    const bool is_height = d.space == RT_SPACE_HEIGHT, is_opacity = d.space == RT_SPACE_ALPHA || d.space == RT_SPACE_CLEARNESS;
    if (is_bright(picture) && (is_height || is_opacity)) make_bytes(texels, picture);
    if (!is_bright(picture)) picture.flags = d.space == RT_SPACE_SRGB ? 0 : RT_TEXTURE_LINEAR;
    if (is_height) make_normals(texels.data() + picture.first, picture);
    if (is_opacity) make_opacities(texels.data() + picture.first, picture, d.space);
    add_smaller_pictures(texels, picture);
    return {};
}

}  // namespace

rt_u32 SceneBuilder::texture_of(rt_texture picture, const rt_texture_desc& shown) {
    if (picture.width == 0) return RT_NONE;
    picture.wrap = shown.wrap_u + RT_WRAP_ALONG_V * shown.wrap_v;
    if (shown.filter == RT_FILTER_NEAREST) picture.flags |= RT_TEXTURE_NEAREST;
    const auto [known, is_new] =
        textures_.insert({{picture.first, picture.wrap, picture.flags}, static_cast<rt_u32>(scene_.textures.size())});
    if (is_new) scene_.textures.push_back(picture);
    return known->second;
}

rt_u32 SceneBuilder::texture_of_bytes(const std::string& from, const rt_texture_desc& d) {
    Digest digest;
    digest.add_value(d.width), digest.add_value(d.height);
    digest.add_bytes(d.bytes, d.byte_count);
    const auto [known, is_new] = pictures_of_bytes_.insert({{digest.hex(), d.space}, rt_texture{}});
    rt_texture& picture = known->second;
    if (!is_new) return texture_of(picture, d);
    std::vector<uint32_t>& texels = scene_.texels.own();
    if (observer_) observer_->decoding(d.height == 0 ? memory_of_texture(d.bytes, d.byte_count) : 6 * d.byte_count);
    std::string lost;
    const Problem why = completed(d.height == 0 ? decode_texture(d.bytes, d.byte_count, texels, picture, lost)
                                                : copy_texture(d.bytes, d.byte_count, d.width, d.height, texels, picture),
                                  d, texels, picture);
    if (why) warn(from, "an embedded texture is left out: " + why.text());
    if (!why && !lost.empty()) warn(from, "an embedded texture: " + lost);
    return texture_of(picture, d);
}

rt_u32 SceneBuilder::texture_of_file(const std::string& from, const rt_texture_desc& d) {
    const std::string path = d.path;
    const FileAccess::Found found = access_.find_texture(from, path);
    const auto missing = [&](const std::string& why) {
        warn(from, "texture '" + path + "': " + why + "; the material stays without it");
        return RT_NONE;
    };
    if (found.path.empty()) return missing(found.why);
    const auto [known, is_new] = pictures_of_files_.insert({{found.path, d.space}, rt_texture{}});
    rt_texture& picture = known->second;
    if (!is_new) return texture_of(picture, d);
    std::string bytes;
    std::vector<uint32_t>& texels = scene_.texels.own();
    // A stage of its own: a small file may name many large pictures, each of which takes seconds.
    progress_.stage("reading " + file_name(found.path));
    Problem why = try_read_file(found.path, kMaxPictureFileBytes, bytes);
    if (!why) {
        const auto* const begin = reinterpret_cast<const uint8_t*>(bytes.data());
        if (observer_) observer_->decoding(memory_of_texture(begin, bytes.size()));
        std::string lost;
        why = completed(decode_texture(begin, bytes.size(), texels, picture, lost), d, texels, picture);
        if (!why && !lost.empty()) warn(from, "texture '" + path + "': " + lost);
    }
    progress_.stage("importing " + file_name(from));
    return why ? missing(why.text()) : texture_of(picture, d);
}

void SceneBuilder::add_picture(const std::string& path, rt_u32 space) {
    rt_texture_desc desc{};
    desc.path = path.c_str();
    desc.space = space;
    const rt_u32 known = texture_of_file("", desc);
    if (known == RT_NONE) return;
    // Also where a file names the picture: textures of files keep their numbers and names, whatever pictures a user gives.
    scene_.texture_names.resize(scene_.textures.size());
    if (scene_.texture_names[known].empty()) {
        scene_.texture_names[known] = picture_name(path);
    } else {
        scene_.textures.push_back(rt_texture(scene_.textures[known]));
        scene_.texture_names.push_back(picture_name(path));
    }
}

// Channels of cameras and lights name them by `source` until here, because files that load each other mix their order.
void SceneBuilder::take_motion() {
    Motion& motion = scene_.motion;
    motion.nodes = std::move(world_.nodes);
    motion.clips = std::move(world_.clips);
    motion.layers = std::move(world_.layers);
    motion.skins = std::move(world_.skins);
    motion.bones = std::move(world_.bones);
    const auto find = [&](const auto& list, rt_u32 source) {
        const auto at = std::find_if(list.begin(), list.end(), [&](const auto& item) { return item.source == source; });
        return at == list.end() ? RT_NONE : static_cast<rt_u32>(at - list.begin());
    };
    for (Channel& channel : world_.channels) {
        if (channel.moves == RT_MOVES_FOV) channel.target = find(scene_.cameras, channel.target);
        if (channel.moves == RT_MOVES_COLOR) channel.target = find(scene_.lights, channel.target);
        if (channel.target != RT_NONE) motion.channels.push_back(channel);
    }
    const auto key = [](const Channel& c) { return std::make_tuple(c.clip, c.layer, c.moves, c.target, c.component); };
    std::stable_sort(motion.channels.begin(), motion.channels.end(),
                     [&](const Channel& a, const Channel& b) { return key(a) < key(b); });
}

Scene SceneBuilder::take() {
    subtract_origin();
    scene_.instances = std::move(world_.instances);
    scene_.spheres = std::move(world_.spheres);
    scene_.planes = std::move(world_.planes);
    scene_.shapes = std::move(world_.shapes);
    scene_.lights = std::move(world_.lights);
    scene_.cameras = std::move(world_.cameras);
    scene_.edits = std::move(world_.edits);
    for (const auto& [path, content] : files_) scene_.sources.push_back(path);
    for (const auto& [file, picture] : pictures_of_files_)  // two spaces of one file follow each other
        if (scene_.sources.empty() || scene_.sources.back() != file.first) scene_.sources.push_back(file.first);
    take_motion();
    as_stored_.resize(scene_.meshes.size());
    if (const size_t count = deform_at_rest(scene_, as_stored_); count > 0)
        scene_.warnings.push_back(
            std::to_string(count) +
            " meshes are shown as they are stored: their skins or morphs lead to numbers that are too large");
    if (!scene_.tangents.empty()) scene_.tangents.resize(scene_.triangles.size(), 0);
    bake_singular_instances(scene_);
    make_tangents(scene_);
    for (const FileContent::PolygonCorners& polygon : world_.polygons) {
        const rt_u32 corner_count = static_cast<rt_u32>(polygon.corners.size() / 3);
        scene_.polygons.push_back({static_cast<rt_u32>(scene_.polygon_corners.size() / 3), corner_count, polygon.material});
        scene_.polygon_corners.insert(scene_.polygon_corners.end(), polygon.corners.begin(), polygon.corners.end());
    }
    if (triangulator_.given_up() > 0) {
        scene_.warnings.push_back(plural(triangulator_.given_up(), "face with very many corners crosses itself",
                                         "faces with very many corners cross themselves") +
                                  "; parts of " + (triangulator_.given_up() == 1 ? "it" : "them") + " are cut as fans");
    }
    if (warnings_left_out_ > 0) scene_.warnings.push_back("and " + plural(warnings_left_out_, "warning") + " more");
    return std::move(scene_);
}

}  // namespace clarity::import
