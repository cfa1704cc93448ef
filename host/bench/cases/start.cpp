#include "bench/cases/start.hpp"

#include <memory>

#include "base/error.hpp"
#include "base/files/library_files.hpp"
#include "bench/cases/entry.hpp"
#include "bench/cases/ranks.hpp"
#include "bench/output/row.hpp"
#include "bench/run/failure.hpp"
#include "bench/run/rank_run.hpp"

namespace clarity::bench {
namespace {

bool is_cold(const Variant& variant) {
    constexpr std::string_view kCold = "cold";
    const std::string& label = variant.label;
    return label.size() >= kCold.size() && label.compare(label.size() - kCold.size(), kCold.size(), kCold) == 0;
}

}  // namespace

std::vector<BenchRecord> measure_start(const BenchScene& scene, const PluginRegistry& plugins, const BenchRequest& request,
                                       const BenchCase& c, const BenchOptions& options, Progress& progress) {
    std::vector<BenchRecord> rows;
    std::unique_ptr<TemporaryFolder> kept;
    const TemporaryFolder output("clarity-start");
    for (const DeviceInfo& device : options.devices)
        for (const Variant& variant : c.variants) {
            if (is_cold(variant) || !kept) kept = std::make_unique<TemporaryFolder>("clarity-cold");
            BenchRecord row = make_row(c);
            row.scene = scene.name;
            row.variant = variant.label;
            describe(row, device);
            try {
                std::vector<std::string> words = {"env"};
                for (const char* name : {"XDG_CACHE_HOME", "POCL_CACHE_DIR", "CUDA_CACHE_PATH"})
                    words.push_back(std::string(name) + "=" + kept->path() + "/" + name);
                for (const std::string& word :
                     {program_file().string(), std::string("render"), std::string("--device"), device.id()})
                    words.push_back(word);
                for (const std::string& word : render_words(scene, plugins, request, variant, options.import))
                    words.push_back(word);
                const RankRun run = run_render(words, output.path(), "install coreutils", progress);
                describe(row, run.stats);
                row.time_ms = summarize({run.stats.at("compile_ms").get<double>()});
                row.wall_ms = summarize({run.whole_ms});
            } catch (const Cancelled&) {
                throw;
            } catch (const std::exception& error) {
                row.status = RowStatus::failed;
                row.why = failure_text(error);
            }
            rows.push_back(std::move(row));
        }
    return rows;
}

}  // namespace clarity::bench
