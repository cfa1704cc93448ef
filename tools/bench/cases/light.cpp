#include "tools/bench/cases/light.hpp"

#include <algorithm>
#include <regex>

#include "device/program.hpp"
#include "launch/prepared.hpp"
#include "tools/compare/picture_errors.hpp"

namespace clarity::bench {
namespace {

constexpr unsigned kTimedSamples = 16;      // of a repetition at most
constexpr unsigned kReferenceSamples = 16;  // as many times the samples: its own variance then adds 3 % to an RMSE

FloatImage reference_of(CaseState& state, const Settings& settings, const Fixture::Held& held, const std::string& file) {
    if (!file.empty()) return read_reference(file, settings);
    Settings other = settings;
    set_setting(other, "seed", find_setting("seed")->get(settings) == "1" ? "2" : "1");
    other.sampler = "sobol";
    other.strategy = "mis";
    held.frames->trace(held.prepared, other, state.fixture.view(), 0, false, state.progress,
                       kReferenceSamples * unsigned(settings.spp));
    return held.frames->read_values();
}

void trace_errors(CaseState& state, LightRun& light, const Settings& settings, const Fixture::Held& held) {
    unsigned done = 0;
    double ms = 0;
    std::vector<std::pair<unsigned, double>> rmse;
    for (unsigned next = 1; done < unsigned(settings.spp); next *= 4) {
        const unsigned samples = std::min(next, unsigned(settings.spp));
        ms += held.frames->trace(held.prepared, settings, state.fixture.view(), done, false, state.progress, samples - done)
                  .wall_ms;
        done = samples;
        const PictureErrors errors = picture_errors(held.frames->read_values(), *state.light_reference);
        light.points.push_back({done, ms, errors.rmse, errors.trimmed_rmse, errors.relmse});
        rmse.emplace_back(done, errors.rmse);
    }
    if (rmse.size() > 1) light.slope = error_slope(rmse);
}

// Compiles the program once more, with a kernel that tells the size of a path, and with the compiler's own words where it has
// them.
void describe_program(CaseState& state, LightRun& light, const Fixture::Held& held, size_t device) {
    const std::shared_ptr<Device>& opened = state.fixture.opened(device);
    const bool nvidia = opened->info().nvidia && !opened->info().pocl;
    const CompiledOnce built = compile_once_more(
        *held.prepared, "\nkernel void rt_state_bytes(global uint *bytes) { *bytes = sizeof(rt_path) / RT_LANES; }\n",
        nvidia ? " -cl-nv-verbose" : "");
    cl::Buffer bytes(opened->context(), CL_MEM_WRITE_ONLY, sizeof light.state_bytes);
    cl::Kernel kernel(built.program, "rt_state_bytes");
    kernel.setArg(0, bytes);
    opened->queue().enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(1));
    opened->queue().enqueueReadBuffer(bytes, CL_TRUE, 0, sizeof light.state_bytes, &light.state_bytes);
    // A driver says nothing of a text that it has compiled before, as for an earlier row.
    RegisterUse& use = state.register_uses[built.text];
    if (const RegisterUse told = register_use(built.log, built.entry); told.registers >= 0) use = told;
    light.registers = use.registers;
    light.spilled_bytes = use.spilled_bytes;
}

}  // namespace

void add_light(CaseState& state, Entry& entry, const Settings& settings, const Fixture::Held& held, const std::string& file) {
    if (!state.light_reference) state.light_reference = reference_of(state, settings, held, file);
    const unsigned timed = std::min(unsigned(settings.spp), kTimedSamples);
    entry.row.light.sampler = settings.sampler;
    entry.row.light.strategy = settings.strategy;
    entry.row.light.reference =
        file.empty() ? std::to_string(kReferenceSamples * settings.spp) + " samples of another seed" : file;
    entry.once = [=, &state] {
        const FrameStats stats =
            held.frames->trace(held.prepared, settings, state.fixture.view(), 0, false, state.progress, timed);
        return Sample{stats.device_ms, stats.wall_ms};
    };
    entry.finish = [=, &state](BenchRecord& row) {
        const double pixels = double(settings.width) * settings.height;
        if (row.wall_ms.median > 0) row.light.msamples_per_s = pixels * timed / row.wall_ms.median / 1000;
        trace_errors(state, row.light, settings, held);
        set_ray_counts(row, held.frames->trace(held.prepared, settings, state.fixture.view(), 0, true, state.progress, timed));
        for (size_t i = 0; i < state.fixture.device_count(); ++i)
            if (state.fixture.device(i).id() == row.device_id) describe_program(state, row.light, held, i);
    };
}

RegisterUse register_use(const std::string& log, const std::string& entry) {
    // ptxas info    : Function properties for trace_path
    //     0 bytes stack frame, 8 bytes spill stores, 12 bytes spill loads
    // ptxas info    : Used 128 registers, ...
    const size_t at = log.find("Function properties for " + entry + "\n");
    if (at == std::string::npos) return {};
    std::smatch stores, registers;
    std::string rest = log.substr(at);
    rest = rest.substr(0, rest.find("Function properties for", 1));
    RegisterUse use;
    if (std::regex_search(rest, stores, std::regex("([0-9]{1,8}) bytes spill stores")))
        use.spilled_bytes = std::stoi(stores[1]);
    if (std::regex_search(rest, registers, std::regex("Used ([0-9]{1,8}) registers"))) use.registers = std::stoi(registers[1]);
    return use;
}

}  // namespace clarity::bench
