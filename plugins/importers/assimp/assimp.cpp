// assimp.cpp -- the importer plugin for COLLADA, 3DS and other formats that the Open Asset Import Library reads.
//
// The scene is imported as the file stores it: in its own pose, units and axes, with whole polygons. A mesh is imported once,
// no matter how many nodes show it.
#include <assimp/DefaultIOSystem.h>
#include <assimp/MemoryIOWrapper.h>
#include <assimp/config.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/DefaultLogger.hpp>
#include <assimp/Importer.hpp>
#include <assimp/LogStream.hpp>
#include <assimp/ProgressHandler.hpp>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "../common/mapped_file.hpp"
#include "../common/numbers.hpp"
#include "../common/views.hpp"
#include "content_checks.hpp"
#include "materials.hpp"
#include "meshes.hpp"
#include "rt_plugin.h"
#include "rt_plugin.hpp"

namespace assimp_import {
namespace {

// What assimp reports as an error although it is none, by words of the message.
constexpr const char* kNone[] = {
    "setting default material",         // a mesh without a material
    "Unexpected effect input mapping",  // any texture in COLLADA: assimp 5.4 takes the word of input_semantic for a number
};

// Collects errors that assimp only logs: parts of a file that it gave up on while it read the rest.

// Collects while it exists; create it around one ReadFile(). assimp has one logger per process, so imports in one process must
// not run at the same time.
class Complaints {
 public:
    Complaints() {
        Assimp::Logger* logger = Assimp::DefaultLogger::create("", Assimp::Logger::NORMAL, 0);
        logger->attachStream(new Stream(*this), Assimp::Logger::Err);  // the logger deletes it
    }
    ~Complaints() { Assimp::DefaultLogger::kill(); }
    Complaints(const Complaints&) = delete;
    Complaints& operator=(const Complaints&) = delete;

    // The errors without repetitions, at most eight.
    const std::vector<std::string>& errors() const { return errors_; }

 private:
    class Stream : public Assimp::LogStream {
     public:
        explicit Stream(Complaints& owner) : owner_(owner) {}
        void write(const char* message) override { owner_.add(message); }

     private:
        Complaints& owner_;
    };

    void add(std::string line) {
        while (!line.empty() && (line.back() == '\n' || line.back() == '\r')) line.pop_back();
        if (const size_t at = line.find("T0: "); at != line.npos) line.erase(0, at + 4);
        for (const char* none : kNone)
            if (line.find(none) != line.npos) return;
        for (const std::string& known : errors_) {
            if (known == line) return;
        }
        if (errors_.size() < 8) errors_.push_back(line);
    }

    std::vector<std::string> errors_;
};

// Converts lights and cameras. The node with the same name gives each its place.

using Vec = std::array<double, 3>;

// The n-th light (or camera) of a name belongs to the n-th node of that name.
class NodesOfNames {
 public:
    explicit NodesOfNames(const NodeTree& tree) : tree_(tree) {}
    Transform next(const aiString& name) {
        const std::string key(name.data, name.length);
        const PlacedNode* node = tree_.find(key, seen_[key]++);
        return node && is_finite(node->world) ? node->world : kIdentity;
    }

 private:
    const NodeTree& tree_;
    std::map<std::string, size_t> seen_;
};

// Scales the vector to unit length. Returns false, and changes nothing, if its length is 0 or not finite.
bool normalize(Vec& v) {
    const double length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    if (!(length > 1e-30) || !std::isfinite(length)) return false;
    for (double& x : v) x /= length;
    return true;
}

void store(const Vec& v, float out[3]) {
    for (int k = 0; k < 3; ++k) out[k] = static_cast<float>(v[k]);
}

bool all_finite(const float v[3]) {
    return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]);
}

std::string quoted(const aiString& name) {
    return "'" + std::string(name.data, name.length) + "'";
}

void add_lights(const aiScene& scene, const NodeTree& tree, const rt_host& host, const rt_scene_sink& sink) {
    NodesOfNames placement(tree);
    importers::Lights lights;
    for (unsigned i = 0; i < scene.mNumLights; ++i) {
        const aiLight& light = *scene.mLights[i];
        const Transform world = placement.next(light.mName);
        if (light.mType == aiLightSource_AMBIENT) continue;
        rt_light_desc desc{};
        desc.struct_bytes = sizeof desc;
        if (light.mType == aiLightSource_DIRECTIONAL) {
            Vec direction = transform_vector(world, light.mDirection);
            if (!normalize(direction)) direction = {0, -1, 0};
            desc.kind = RT_LIGHT_DIRECTIONAL;
            store(direction, desc.direction);
        } else {
            const bool is_spot = light.mType == aiLightSource_SPOT;
            if (light.mType != aiLightSource_POINT && !is_spot)
                sink.warn(sink.ctx, ("the area light " + quoted(light.mName) + " became a point light").c_str());
            desc.kind = is_spot ? RT_LIGHT_SPOT : RT_LIGHT_POINT;
            Vec direction = transform_vector(world, light.mDirection);
            if (!normalize(direction)) direction = {0, -1, 0};
            store(direction, desc.direction);
            store(transform_point(world, light.mPosition), desc.position);
        }
        // Light that falls by 1 / (constant + linear d + quadratic d^2); a white surface that faces it is as bright as the
        // colour says where that is 1 (COLLADA 1.5, "point"). The square alone is an intensity of pi / quadratic.
        const double constant = light.mAttenuationConstant, linear = light.mAttenuationLinear,
                     quadratic = light.mAttenuationQuadratic;
        const bool is_far = desc.kind == RT_LIGHT_DIRECTIONAL, fades = !is_far && constant == 0 && linear == 0 && quadratic > 0;
        if (!is_far && !fades && (linear != 0 || quadratic != 0))
            sink.warn(sink.ctx, ("the light " + quoted(light.mName) +
                                 " has an attenuation other than by the square of the distance; "
                                 "here it lights all distances alike")
                                    .c_str());
        const double factor = fades ? importers::kPi / quadratic : constant > 0 && !is_far ? 1 / constant : 1;
        const aiColor3D& c = light.mColorDiffuse;
        const importers::Cone cone = {light.mAngleOuterCone, light.mAngleInnerCone};  // whole angles
        if (all_finite(desc.position))
            lights.add(desc, light.mName.C_Str(), {c.r, c.g, c.b}, factor,
                       fades ? importers::Unit::physical : importers::Unit::relative, cone);
    }
    lights.pass(&host, sink);
}

void add_cameras(const aiScene& scene, const NodeTree& tree, const rt_scene_sink& sink) {
    NodesOfNames placement(tree);
    for (unsigned i = 0; i < scene.mNumCameras; ++i) {
        const aiCamera& camera = *scene.mCameras[i];
        const Transform world = placement.next(camera.mName);
        Vec forward = transform_vector(world, camera.mLookAt), up = transform_vector(world, camera.mUp);
        if (!normalize(forward)) forward = {0, 0, -1};
        if (!normalize(up)) up = {0, 1, 0};
        rt_camera out{};
        out.struct_bytes = sizeof out;
        out.name = camera.mName.C_Str();
        const Vec eye = transform_point(world, camera.mPosition);
        store(eye, out.eye);
        store({eye[0] + forward[0], eye[1] + forward[1], eye[2] + forward[2]}, out.target);
        store(up, out.up);
        if (!all_finite(out.eye) || !all_finite(out.target)) continue;
        // mHorizontalFOV is the whole angle, whatever the comment in its header says.
        const double aspect = camera.mAspect > 0 && std::isfinite(camera.mAspect) ? camera.mAspect : 4.0 / 3;
        const double fov_y = 2 * std::atan(std::tan(0.5 * camera.mHorizontalFOV) / aspect);
        out.fov_y_rad = importers::angle_of_view(fov_y, quoted(camera.mName), sink);
        rt::id(sink.camera(sink.ctx, &out));
    }
}

// The share of assimp in the progress. assimp reports 0..0.5 while it reads the file, and up to 1 in its post-processing, which
// is hardly used here.
constexpr float kReadShare = 0.8f;

class HostProgress : public Assimp::ProgressHandler {
 public:
    explicit HostProgress(const rt_host& host) : host_(host) {}
    bool Update(float fraction) override {
        const float share = fraction < 0 ? 0 : std::min(fraction, 1.0f) * kReadShare;
        cancelled_ = cancelled_ || !host_.progress(host_.ctx, share);
        return !cancelled_;
    }
    bool cancelled() const { return cancelled_; }

 private:
    const rt_host& host_;
    bool cancelled_ = false;
};

std::string lower_extension(const std::string& path) {
    const size_t dot = path.find_last_of("./");
    std::string extension = dot == path.npos || path[dot] == '/' ? "" : path.substr(dot + 1);
    for (char& c : extension) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    return extension;
}

// The file itself from its bytes, and the files beside it, such as materials, from the disk.
class FilesAround : public Assimp::DefaultIOSystem {
 public:
    FilesAround(std::string path, std::string_view bytes) : path_(std::move(path)), bytes_(bytes) {}
    bool Exists(const char* file) const override { return path_ == file || DefaultIOSystem::Exists(file); }
    Assimp::IOStream* Open(const char* file, const char* mode) override {
        if (path_ != file) return DefaultIOSystem::Open(file, mode);
        return new Assimp::MemoryIOStream(reinterpret_cast<const uint8_t*>(bytes_.data()), bytes_.size());
    }

 private:
    const std::string path_;
    const std::string_view bytes_;
};

// The axes and the unit that the file declares.
struct Units {
    rt_u32 up_axis = 1;
    double unit_scale = 0;
};

Units units_of(aiScene& scene, const std::string& extension, std::string_view head) {
    Units units;
    if (extension == "dae" && scene.mRootNode) {
        // assimp scales the root node to metres. Undo that, and report the unit instead.
        const std::string_view text = head.substr(0, 16384);
        if (text.find("Z_UP") != text.npos) units.up_axis = 2;
        if (text.find("X_UP") != text.npos) units.up_axis = 0;
        aiMatrix4x4& root = scene.mRootNode->mTransformation;
        const float scale = root.a1;
        if (scale > 0 && root.b2 == scale && root.c3 == scale) {
            units.unit_scale = scale;
            root = aiMatrix4x4();
        }
    }
    return units;
}

void warn(const rt_scene_sink& sink, const std::string& text) {
    sink.warn(sink.ctx, text.c_str());
}

// Adds one instance for each node with polygons.
void add_instances(const NodeTree& tree, MeshTable& meshes, const rt_host* host, const rt_scene_sink& sink) {
    size_t done = 0, strayed = 0;
    for (const PlacedNode& placed : tree.nodes()) {
        rt::progress(host, kReadShare + (1 - kReadShare) * float(++done) / float(tree.nodes().size()));
        if (placed.node->mNumMeshes == 0) continue;
        if (!is_finite(placed.world)) {
            ++strayed;
            continue;
        }
        const rt_u32 mesh = meshes.id(*placed.node);
        if (mesh == RT_NONE) continue;
        rt_instance_desc out{};
        out.struct_bytes = sizeof out;
        out.name = placed.node->mName.C_Str();
        out.mesh = mesh;
        out.material = RT_NONE;
        std::transform(placed.world.begin(), placed.world.end(), out.world_from_object,
                       [](double x) { return static_cast<float>(x); });
        rt::id(sink.instance(sink.ctx, &out));
    }
    if (strayed) warn(sink, "nodes left out because their transforms are not finite: " + std::to_string(strayed));
}

// Vertices are as the file stores them, and nodes as at rest.
void report_motion(const aiScene& scene, const rt_scene_sink& sink) {
    const auto meshes_with = [&](const auto& has) {
        return std::count_if(scene.mMeshes, scene.mMeshes + scene.mNumMeshes, has);
    };
    std::string parts;
    const auto add = [&](size_t count, const char* what) {
        if (count > 0) parts += (parts.empty() ? "" : ", ") + std::string(what) + ": " + std::to_string(count);
    };
    add(static_cast<size_t>(meshes_with([](const aiMesh* mesh) { return mesh->mNumBones > 0; })), "meshes with skins");
    add(static_cast<size_t>(meshes_with([](const aiMesh* mesh) { return mesh->mNumAnimMeshes > 0; })), "meshes with morphs");
    add(scene.mNumAnimations, "animations");
    if (!parts.empty()) warn(sink, "what moves the scene is left out (" + parts + "); vertices are shown as they are stored");
}

// Warns about everything that was left out. Throws if nothing is left.
void report(const aiScene& scene, const NodeTree& tree, const MeshTable& meshes, const std::vector<std::string>& errors,
            const rt_host* host, const rt_scene_sink& sink) {
    for (const std::string& error : errors) warn(sink, "assimp could not read a part of the file: " + error);
    if (meshes.broken_faces()) {
        warn(sink,
             "faces left out because of vertices that are missing or not finite: " + std::to_string(meshes.broken_faces()));
    }
    if (meshes.colored() > 0)
        warn(sink, "colours of vertices are not read; they are left out, in " + std::to_string(meshes.colored()) + " meshes");
    if (meshes.faces() > 0) {
        if (meshes.points_and_lines()) warn(sink, "points and lines skipped: " + std::to_string(meshes.points_and_lines()));
        report_motion(scene, sink);
        return;
    }
    // A file that lost its polygons during the import is damaged. A file that never had any (NURBS, curves, cameras) is not.
    if (!errors.empty()) throw rt::fail(host, "contains no usable polygons: " + errors.front());
    if (tree.nodes().size() <= 1 && scene.mNumMeshes == 0) {
        throw rt::fail(host, "contains no nodes: they form a cycle, hang from nothing, or were never written");
    }
    if (meshes.broken_faces() || (scene.mNumMeshes > 0 && meshes.points_and_lines() == 0)) {
        throw rt::fail(host, "contains no usable polygons: all of them name vertices that are missing or not finite");
    }
    warn(sink, "contains no polygons (points, lines, NURBS and the like were skipped)");
}

int32_t load(const rt_host* host, const char* path, const double*, const rt_scene_sink* sink) {
    const importers::MappedFile file(host, path);
    if (file.bytes().empty()) throw rt::fail(host, "the file is empty");
    const std::string extension = lower_extension(path);
    constexpr size_t kMostChecked = size_t(256) << 20;  // larger files are not looked through
    const std::string bytes(file.bytes().size() < kMostChecked ? file.bytes() : std::string_view());
    const std::string damage = bytes.empty() ? bytes : damage_in(bytes, extension);
    if (!damage.empty()) throw rt::fail(host, damage);

    Assimp::Importer importer;
    HostProgress* progress = new HostProgress(*host);  // the importer deletes it
    importer.SetProgressHandler(progress);
    if (RT_HAS(host, rt_host, content_bytes) && host->content)
        importer.SetIOHandler(new FilesAround(path, file.bytes()));  // likewise
    importer.SetPropertyInteger(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, 1);
    const Complaints complaints;
    importer.ReadFile(path, 0);
    if (progress->cancelled()) return RT_CANCELLED;
    std::string why = importer.GetErrorString();
    const std::unique_ptr<aiScene> scene(importer.GetOrphanedScene());
    if (!scene || !scene->mRootNode) {
        throw rt::fail(host, explain_refusal(bytes, extension, why));
    }

    const Units units = units_of(*scene, extension, file.bytes());
    const NodeTree tree(*scene);
    MaterialTable materials(*scene, path, extension == "dae" ? collada_pictures(bytes) : ColladaPictures(), *sink);
    MeshTable meshes(*scene, materials, *sink);
    add_instances(tree, meshes, host, *sink);
    report(*scene, tree, meshes, complaints.errors(), host, *sink);
    add_lights(*scene, tree, *host, *sink);
    add_cameras(*scene, tree, *sink);
    rt_scene_info info{};
    info.struct_bytes = sizeof info;
    info.up_axis = units.up_axis;
    info.unit_scale = units.unit_scale;
    sink->info(sink->ctx, &info);
    return RT_OK;
}

int32_t probe(const uint8_t* head, uint64_t bytes) {
    const std::string_view text(reinterpret_cast<const char*>(head), bytes);
    return text.substr(0, 1024).find("<COLLADA") != text.npos ? 90 : 0;
}

// The formats that users expect. assimp reads more; many of those are rare, unsafe or not meshes.
constexpr const char* extensions[] = {"dae",     "3ds", "blend", "ac",  "ase", "b3d", "bvh",     "dxf",  "hmp", "ifc",  "irr",
                                      "irrmesh", "lwo", "lws",   "lxo", "md2", "md3", "md5mesh", "ms3d", "nff", "q3o",  "smd",
                                      "ter",     "x",   "x3d",   "xgl", "zgl", "3mf", "amf",     "cob",  "scn", nullptr};
constexpr rt_importer importer = {sizeof(rt_importer), extensions, probe, rt::guarded<load>, RT_IMPORTER_TAKES_CONTENT, 0};

}  // namespace
}  // namespace assimp_import

extern "C" RT_EXPORT const rt_plugin rt_plugin_v1 = rt::importer_plugin(
    "assimp", "COLLADA, 3DS and more (Open Asset Import Library)", "1.0.0", nullptr, assimp_import::importer);
