#include "trial/trial.hpp"

#include <vector>

#include "base/error.hpp"
#include "base/files/cache_folder.hpp"
#include "base/files/library_files.hpp"
#include "base/log.hpp"
#include "base/machine.hpp"
#include "base/text.hpp"
#include "compile/compile.hpp"
#include "device/kernel_files.hpp"
#include "picture/film.hpp"
#include "plugin/trust.hpp"
#include "scene/surface_models.hpp"
#include "trial/trial_job.hpp"

namespace clarity {
namespace {

bool is_wanted(const DeviceInfo& info, const Settings& settings) {
    if (worker::in_worker() || settings.trial == "off") return false;
    return settings.trial == "on" || (info.cpu && compiles_in_worker());
}

// The plugins whose kernels are in programs for this scene and structure.
std::vector<const rt_plugin*> plugins_with_kernels(const Prepared& prepared) {
    std::vector<const rt_plugin*> plugins{prepared.accel->layout};
    for (const ShapeKind& kind : prepared.scene->shape_kinds) plugins.push_back(kind.plugin);
    for (const SurfaceModel& model : surface_models())
        if (prepared.settings.optics.lobes & lobe_of_surface(model.number)) plugins.push_back(model.plugin);
    return plugins;
}

// What has to be tried: "cl/tracers/iterative/iterative.cl, changed from line 12 on". Empty: these kernels are the program's
// own, and the driver is trusted.
struct Suspects {
    std::string text;
    SourceLocation first;  // of what was edited; without a message
};

Suspects suspects_of(const DeviceInfo& info, const std::string& source, const std::vector<const rt_plugin*>& plugins) {
    Suspects found;
    const auto add = [&](const std::string& text) { found.text += (found.text.empty() ? "" : ", ") + text; };
    for (const EditedKernel& edited : edited_kernels()) {
        if (source.find("\"" + edited.shown_name + "\"") == std::string::npos) continue;
        if (found.text.empty()) found.first = {edited.path, edited.line, 0, {}};
        add(edited.path + (edited.line ? ", changed from line " + std::to_string(edited.line) + " on" : ""));
    }
    for (const rt_plugin* plugin : plugins) {
        const std::string library = library_of(plugin->id);
        if (!library.empty() && trust_of(original_of(library)) != Trust::own) add("the kernels of " + original_of(library));
    }
    // It makes wrong code of some kernels: those of bvh4 pop more from their stack than they have pushed (Mesa 22.3).
    if (info.llvmpipe && found.text.empty())
        add("they are the program's own, so the driver " + info.platform + " may be at fault");
    return found;
}

// By their text and all else that their trial depends on.
KnownContents& passed_programs() {
    static auto& programs = *new KnownContents("tried_kernels");
    return programs;
}

// A program that may have to be tried.
struct Subject {
    const DeviceInfo& info;
    std::string what, source, options;      // as the compiler gets them
    std::string depends_on;                 // what else the trial depends on
    std::string look_closer;                // what to do when it has failed
    std::vector<const rt_plugin*> plugins;  // with kernels in it
};

void try_subject(const Subject& subject, const std::function<TrialJob()>& work, Progress& progress) {
    const Suspects suspects = suspects_of(subject.info, subject.source, subject.plugins);
    if (suspects.text.empty()) return;
    const std::string name = KnownContents::name_of(subject.options + '\n' + subject.info.name + '\n' + subject.info.driver +
                                                    '\n' + subject.depends_on + '\n' + subject.source);
    if (passed_programs().has(name)) return;
    if (progress.cancelled()) throw Cancelled();
    progress.stage("trying kernels in a worker");
    worker::Job job(kTrialJob, "the trial of kernels", {60, 0, physical_memory_bytes() / 4 * 3});
    std::string not_tried;
    try {
        job.run(work(), not_tried, progress);
    } catch (const Cancelled&) {
        throw;
    } catch (const Error& e) {
        const std::string why = std::string("kernels were tried in a worker first, and ") + e.what();
        SourceLocation place = suspects.first;
        place.message = why;
        throw Error(Exit::kernel_build_failed,
                    why + " (" + subject.what + "; " + suspects.text + ")" + subject.look_closer +
                        "; --trial off (in the window: Try kernels) runs kernels untried",
                    {}, place);
    }
    if (not_tried.empty())
        passed_programs().add(name, {});
    else
        log(LogLevel::debug, "kernels were not tried: " + printable_line(not_tried));
}

TrialJob job_for(const DeviceInfo& info, const Settings& settings, const char* kernels) {
    TrialJob job;
    job.kernels = kernels;
    job.device = info.id();
    job.device_name = info.name;
    job.settings = {settings};
    return job;
}

TrialJob job_of(const Prepared& prepared, const DeviceInfo& info, const KernelRow& row) {
    const AccelData& accel = *prepared.accel;
    TrialJob job = job_for(info, prepared.settings, row.tracer);
    std::vector<const rt_plugin*> plugins = plugins_with_kernels(prepared);
    plugins.push_back(accel.plugin);
    for (const rt_plugin* plugin : plugins) {
        const std::string library = library_of(plugin->id);
        if (!library.empty()) job.libraries[library] = original_of(library);
    }
    job.features = features_of(*prepared.scene, accel.scene, prepared.settings.optics);
    job.surfaces = surface_model_ids();
    job.shapes = sample_shapes(*prepared.scene);
    job.defines = accel.defines;
    job.settings.accel = accel.plugin->id;
    job.settings.accel_params = accel.params;
    return job;
}

constexpr const char* kKilled = "were killed from outside, maybe for want of memory, while {step}";

}  // namespace

const worker::JobKind kTrialJob = {"trial",
                                   "to try kernels, run `clarity check`",
                                   Exit::kernel_build_failed,
                                   true,
                                   LogLevel::debug,
                                   {"crashed ({how}) while {step}", "ended the process ({how}) while {step}",
                                    "did not come to an end within {how} of processor time while {step}", kKilled,
                                    "took more than {how} of memory while {step}", kKilled},
                                   nullptr};

std::shared_ptr<TraceProgram> tried_program(ProgramCache& programs, const Prepared& prepared, const KernelRow& row,
                                            Progress& progress, bool* fresh) {
    const KernelSource source = kernel_for(prepared, row);
    const std::shared_ptr<TraceProgram> program = programs.get(source, fresh, progress);
    const DeviceInfo& info = programs.device()->info();
    if (program->tried || !is_wanted(info, prepared.settings)) return program;
    // Until the file changes, or is loaded again: the window asks for the pixel under the mouse often.
    if (program->refused) throw *program->refused;
    // A worker cannot load a structure that is part of this program.
    const rt_plugin& layout = *prepared.accel->layout;
    try {
        if (!library_of(layout.id).empty())
            try_subject(
                {info, source.what, source.text, source.options, prepared.accel->plugin->id,
                 std::string(info.llvmpipe ? "; take another structure" : "") + "; `clarity check " + layout.id +
                     "` looks closer, with oclgrind if that is installed",
                 plugins_with_kernels(prepared)},
                [&] { return job_of(prepared, info, row); }, progress);
    } catch (const Cancelled&) {
        throw;
    } catch (const Error& e) {
        program->refused = e;
        throw;
    }
    program->tried = true;
    return program;
}

void try_film(const DeviceInfo& info, const Settings& settings, Progress& progress) {
    if (!is_wanted(info, settings)) return;
    const CompileRequest program = film_program();
    try_subject(
        {info, program.what, program.source, program.options, {}, {}, {}},
        [&] { return job_for(info, settings, kFilmKernels); }, progress);
}

}  // namespace clarity
