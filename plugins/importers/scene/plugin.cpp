// The importer plugin `scene`, for the text format of docs/scene_format.md.
#include <stdexcept>
#include <string>

#include "../common/mapped_file.hpp"
#include "emit.hpp"
#include "lexer.hpp"
#include "parser.hpp"
#include "rt_plugin.hpp"
#include "shapes.hpp"

namespace scene_format {
namespace {

// Reports the first error to the user, and writes the others to the log.
int32_t report(const Diagnostics& diagnostics, const char* path, const rt_host& host) {
    const std::vector<Diagnostic> errors = diagnostics.errors();
    for (size_t i = 1; i < errors.size(); ++i) host.log(host.ctx, RT_LOG_WARNING, located(path, errors[i]).c_str());
    std::string first = located(path, errors[0]);
    if (errors.size() > 1) {
        const bool stopped = diagnostics.full();
        first += " [and " + std::to_string(errors.size() - 1) + (stopped ? " or more" : "") + " further " +
                 (errors.size() == 2 && !stopped ? "error" : "errors") + ", in the log]";
    }
    return host.fail(host.ctx, first.c_str());
}

int32_t load_text(std::string_view text, const rt_host& host, const char* path, const rt_scene_sink& sink) {
    if (text.size() > kMaxFileBytes)
        throw std::runtime_error("the file is larger than " + std::to_string(kMaxFileBytes >> 20) +
                                 " MiB; give large meshes as PLY or OBJ and `load` them");
    Document document;
    document.kinds = kinds_of(sink);
    Diagnostics diagnostics;
    const auto proceed = [&](float fraction) { return host.progress(host.ctx, 0.5f * fraction) != 0; };
    if (!parse(text, document, diagnostics, proceed)) return RT_CANCELLED;
    if (diagnostics.failed()) return report(diagnostics, path, host);
    for (const Diagnostic& warning : diagnostics.warnings()) sink.warn(sink.ctx, located(path, warning).c_str());
    return emit(document, path, host, sink);
}

int32_t load(const rt_host* host, const char* path, const double*, const rt_scene_sink* sink) {
    try {
        const importers::MappedFile file(host, path);
        return load_text(file.bytes(), *host, path, *sink);
    } catch (const std::runtime_error& error) {
        throw rt::fail(host, std::string(path) + ": " + error.what());
    }
}

constexpr const char* kExtensions[] = {"scene", nullptr};
constexpr rt_importer kImporter = {sizeof(rt_importer), kExtensions, nullptr, rt::guarded<load>, RT_IMPORTER_TAKES_CONTENT, 0};

}  // namespace
}  // namespace scene_format

extern "C" RT_EXPORT const rt_plugin rt_plugin_v1 =
    rt::importer_plugin("scene", "Text scene", "1.0.0", nullptr, scene_format::kImporter);
